#include "train/trained_networks.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/warn.h"

namespace vkopple {

bool has_learned(const LoadedModel& model, Network network) {
  const auto stages = model.config.stages();
  const auto end = stages.begin() + static_cast<std::ptrdiff_t>(model.position.stage) + 1;
  return std::any_of(stages.begin(), end, [&](const TrainingStage& stage) { return stage.learns(network); });
}

void warn_if_untrained(const LoadedModel& model, const std::vector<Network>& needed) {
  std::string names;
  for (const Network network : needed) {
    if (has_learned(model, network)) continue;
    names += (names.empty() ? "" : ", ") + std::string(kNetworkNames[static_cast<size_t>(network)]);
  }
  if (!names.empty())
    warn(fmt::format("networks that have not learned yet at step {}, so that what they say is noise: {}",
                     model.position.step, names));
}

}  // namespace vkopple
