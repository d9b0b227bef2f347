#include "models/network_options.h"

#include "runtime/error.h"

namespace vkopple {

NetworkOptions network_options(const ModelConfig& config, const std::string& group, bool training, Value random,
                               uint64_t max_tensor_bytes) {
  NetworkOptions options{
      .group = group, .training = training, .random = random, .max_tensor_bytes = max_tensor_bytes};
  if (group == "depth") {
    options.prefix = "depth_model.depth_net.";
    options.dropout = config.dropout[0];
  } else if (group == "object") {
    options.prefix = "segmentation_model.seg_net.seg_net.";
    options.dropout = config.dropout[1];
    options.initial = ConvInitial::kKaimingNormal;
  } else if (group == "imagination") {
    options.prefix = "imagination_model.imag_net.imag_net.";
    options.dropout = config.dropout[2];
  } else if (group == "motion") {
    options.prefix = "warping_model.";
    options.initial = ConvInitial::kFramework;
  } else {
    throw Error("there is no network " + group);
  }
  return options;
}

}  // namespace vkopple
