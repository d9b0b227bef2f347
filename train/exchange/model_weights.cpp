#include "train/exchange/model_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>

#include "runtime/error.h"
#include "train/exchange/colour_order.h"
#include "train/exchange/open_tensor_file.h"
#include "train/exchange/torch_file.h"
#include "train/model_layout.h"
#include "train/quote.h"
#include "train/safetensors.h"
#include "train/stage_plan.h"
#include "train/tensor_checksums.h"

namespace vkopple {
namespace {

using Metadata = std::map<std::string, std::string>;

/// In place of a checkpoint's format, so that no program takes such weights for one.
constexpr const char* kFormatKey = "format";
constexpr const char* kBgrFormat = "vkopple weights in BGR";
constexpr std::string_view kParallelPrefix = "module.";

std::string shown(const TensorFile& file) { return one_line(file.path().string(), 4096); }

/// Of a whole model: where its weights come from and in which order its colours are.
struct Source {
  CheckpointHeader header;
  bool bgr = false;
};

/// Whether the file's metadata are ours; other writers may have a "format" too.
bool says_its_model(const TensorFile& file) {
  const auto format = file.metadata().find(kFormatKey);
  return format != file.metadata().end() &&
         (format->second == kCheckpointFormat || format->second == kBgrFormat);
}

Source source_of_own(const TensorFile& file, const ImportOptions& options) {
  Metadata metadata = file.metadata();
  const bool bgr = metadata[kFormatKey] == kBgrFormat;
  if (options.config)
    throw UsageError(fmt::format("{}: says its configuration itself; leave --config out", shown(file)));
  if (options.bgr && !bgr)
    throw UsageError(
        fmt::format("{}: says that its colours are red, green, blue; leave --bgr out", shown(file)));
  if (bgr) metadata[kFormatKey] = kCheckpointFormat;
  return {parse_checkpoint_header(metadata, file.path()), bgr};
}

Source source_of_foreign(const TensorFile& file, const ImportOptions& options) {
  if (!options.config) {
    throw UsageError(
        fmt::format("{}: does not say its configuration; name the preset or the file that it was trained "
                    "with by --config",
                    shown(file)));
  }
  // At the beginning of the last stage: its networks count as trained, and training goes on with it.
  const StagePlan plan(*options.config, std::nullopt);
  const TrainingPosition position{
      .step = plan.stages().back().begin, .stage = plan.stages().size() - 1, .data = "imported"};
  return {{*options.config, position}, options.bgr};
}

/// The file's name of every tensor, by the model's.
std::map<std::string, std::string> names_of(const TensorFile& file, const ImportOptions& options) {
  std::vector<std::string> names = file.names();
  std::erase_if(names, [&](const std::string& name) {
    return std::any_of(options.left_out.begin(), options.left_out.end(),
                       [&](const std::string& prefix) { return name.starts_with(prefix); });
  });
  const bool parallel = std::all_of(names.begin(), names.end(),
                                    [](const std::string& name) { return name.starts_with(kParallelPrefix); });
  std::map<std::string, std::string> by_model_name;
  for (const std::string& name : names)
    by_model_name[parallel ? name.substr(kParallelPrefix.size()) : name] = name;
  return by_model_name;
}

/// Reads what the layout has, and refuses what it has not.
class WeightsReader {
 public:
  WeightsReader(const TensorFile& file, const ModelLayout& layout, std::map<std::string, std::string> names)
      : file_(file), layout_(layout), names_(std::move(names)) {}

  std::map<std::string, StoredTensor> read() {
    // A checkpoint's other half, which is not taken along.
    for (const LayoutEntry& entry : layout_.optimiser()) names_.erase(entry.name);
    for (const LayoutEntry& entry : layout_.weights()) read_weight(entry);
    for (const std::string& name : layout_.batch_counters()) read_counter(name);
    if (!names_.empty()) {
      throw Error(
          fmt::format("{}: holds a tensor {} that the model of its configuration does not have; leave it out "
                      "by --without, if it is none of the model's",
                      shown(file_), quote(names_.begin()->second)));
    }
    return std::move(tensors_);
  }

 private:
  /// The tensor of the model's name; nothing where the file has none. It is done with then.
  std::optional<StoredTensor> take(const std::string& name, const StoredShape& shape) {
    const auto found = names_.find(name);
    if (found == names_.end()) return std::nullopt;
    const std::string in_file = found->second;
    names_.erase(found);
    const StoredShape& given = file_.shape(in_file);
    if (given != shape) {
      throw Error(
          fmt::format("{}: {} has the shape {}, its configuration asks for {}; was it trained with another?",
                      shown(file_), quote(in_file), to_string(given), to_string(shape)));
    }
    return file_.read(in_file);
  }

  void read_weight(const LayoutEntry& entry) {
    const auto stored = take(entry.name, entry.stored_shape());
    if (!stored)
      throw Error(fmt::format("{}: lacks the tensor {}; is it a whole model?", shown(file_), entry.name));
    const std::vector<float> values = to_floats(*stored);
    require_usable(entry.name, values, file_.path());
    tensors_.emplace(entry.name, StoredTensor::of(entry.stored_shape(), std::span(values)));
  }

  void read_counter(const std::string& name) {
    const auto stored = take(name, {});
    const std::int64_t count = stored ? to_ints(*stored, name, shown(file_)).at(0) : 0;
    if (count < 0) throw Error(fmt::format("{}: {} is negative", shown(file_), name));
    tensors_.emplace(name, StoredTensor::of({}, std::span(&count, 1)));
  }

  const TensorFile& file_;
  const ModelLayout& layout_;
  std::map<std::string, std::string> names_;
  std::map<std::string, StoredTensor> tensors_;
};

ModelLayout layout_of(const Config& config) { return ModelLayout(config.model, config.training.precision); }

}  // namespace

ModelWeights import_weights(const TensorFile& file, const ImportOptions& options) {
  const Source source = says_its_model(file) ? source_of_own(file, options) : source_of_foreign(file, options);
  const ModelLayout layout = layout_of(source.header.config);
  ModelWeights weights{source.header, WeightsReader(file, layout, names_of(file, options)).read()};
  if (source.bgr) swap_red_and_blue(weights.tensors);
  return weights;
}

ModelWeights read_model_weights(const std::filesystem::path& checkpoint) {
  const auto file = open_tensor_file(checkpoint);
  const CheckpointHeader header = parse_checkpoint_header(file->metadata(), checkpoint);
  const ModelLayout layout = layout_of(header.config);
  return {header, WeightsReader(*file, layout, names_of(*file, {})).read()};
}

void write_model_checkpoint(const std::filesystem::path& path, const ModelWeights& weights) {
  std::map<std::string, StoredTensor> tensors = weights.tensors;
  const ModelLayout layout = layout_of(weights.header.config);
  for (const LayoutEntry& entry : layout.optimiser()) {
    const auto values = initial_values(entry.initial, entry.shape.elements(), 0, entry.name);
    tensors.emplace(entry.name, StoredTensor::of(entry.stored_shape(), std::span(values)));
  }
  write_safetensors(path, with_checksums(checkpoint_metadata(weights.header), tensors), tensors);
}

void export_weights(const std::filesystem::path& path, const ModelWeights& weights, bool bgr) {
  Metadata metadata = checkpoint_metadata(weights.header);
  std::map<std::string, StoredTensor> tensors = weights.tensors;
  if (bgr) {
    metadata[kFormatKey] = kBgrFormat;
    swap_red_and_blue(tensors);
  }
  if (has_torch_ending(path))
    write_torch(path, metadata, tensors);
  else
    write_safetensors(path, metadata, tensors);
}

}  // namespace vkopple
