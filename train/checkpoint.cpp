#include "train/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string>

#include "graph/ops/loss_scale.h"
#include "runtime/error.h"
#include "train/config_difference.h"
#include "train/quote.h"
#include "train/run_folder.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using Metadata = std::map<std::string, std::string>;

constexpr const char* kVersion = "1";

std::string shown(const std::filesystem::path& path) { return one_line(path.string()); }

std::string metadata_text(const Metadata& metadata, const std::filesystem::path& path, const std::string& key) {
  const auto found = metadata.find(key);
  if (found == metadata.end())
    throw Error(fmt::format("{}: is no checkpoint of vkopple: its metadata lack {}", shown(path), key));
  return found->second;
}

uint64_t metadata_number(const Metadata& metadata, const std::filesystem::path& path, const std::string& key) {
  const std::string text = metadata_text(metadata, path, key);
  uint64_t number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size())
    throw Error(
        fmt::format("{}: {} in its metadata must be a whole number, not {}", shown(path), key, quote(text)));
  return number;
}

CheckpointHeader header_of(const SafetensorsFile& file) {
  return parse_checkpoint_header(file.metadata(), file.path());
}

/// Every tensor that is wanted is there, nothing else is but what is `allowed`, and all have their shapes.
void check_tensors(const SafetensorsFile& file, const std::map<std::string, StoredShape>& wanted,
                   const std::set<std::string>& allowed) {
  for (const auto& [name, shape] : wanted) {
    if (!file.contains(name))
      throw Error(fmt::format("{}: lacks the tensor {}; it is no complete checkpoint of its configuration",
                              shown(file.path()), name));
    if (file.shape(name) != shape)
      throw Error(fmt::format("{}: {} has the shape {}, its configuration asks for {}", shown(file.path()),
                              name, to_string(file.shape(name)), to_string(shape)));
  }
  for (const std::string& name : file.names())
    if (!wanted.contains(name) && !allowed.contains(name))
      throw Error(fmt::format("{}: holds a tensor {} that its configuration does not have", shown(file.path()),
                              quote(name)));
}

void add_shapes(std::map<std::string, StoredShape>& shapes, const std::vector<LayoutEntry>& entries) {
  for (const LayoutEntry& entry : entries) shapes[entry.name] = entry.stored_shape();
}

/// Variances and means of squares: the square root of a negative one would not be finite. A scale and counts.
bool is_never_negative(const std::string& name) {
  return name == kLossScaleState || name.ends_with(".running_var") ||
         (name.starts_with("adam/") && name.find("/v/") != std::string::npos);
}

/// Of a file whose tensors were checked.
void read_entries(const SafetensorsFile& file, ModelStore& store, const std::vector<LayoutEntry>& entries) {
  for (const LayoutEntry& entry : entries) {
    const std::vector<float> values = file.read_floats(entry.name);
    require_usable(entry.name, values, file.path());
    store.write(entry, values);
  }
}

void read_counters(const SafetensorsFile& file, ModelStore& store) {
  for (auto& [name, count] : store.batch_counters()) {
    count = file.read_ints(name).at(0);
    if (count < 0) throw Error(fmt::format("{}: {} is negative", shown(file.path()), name));
  }
}

std::map<std::string, StoredShape> weight_shapes(const ModelLayout& layout) {
  std::map<std::string, StoredShape> shapes;
  add_shapes(shapes, layout.weights());
  for (const std::string& name : layout.batch_counters()) shapes[name] = {};
  return shapes;
}

}  // namespace

CheckpointHeader parse_checkpoint_header(const Metadata& metadata, const std::filesystem::path& path) {
  const std::string format = metadata_text(metadata, path, "format");
  const std::string version = metadata_text(metadata, path, "format_version");
  if (format != kCheckpointFormat || version != kVersion)
    throw Error(fmt::format("{}: is {} version {}; this program reads {} version {}", shown(path),
                            quote(format), quote(version), kCheckpointFormat, kVersion));
  const auto number = [&](const char* key) { return metadata_number(metadata, path, key); };
  CheckpointHeader header;
  header.config = Config::parse(metadata_text(metadata, path, "config"), path.string() + ": config");
  header.position = {.step = number("step"),
                     .stage = number("stage"),
                     .stage_step = number("stage_step"),
                     .seed = number("seed"),
                     .data = metadata_text(metadata, path, "data")};
  if (header.position.stage >= header.config.stages().size())
    throw Error(fmt::format("{}: is in stage {} of a configuration of {}", shown(path), header.position.stage,
                            header.config.stages().size()));
  return header;
}

Metadata checkpoint_metadata(const CheckpointHeader& header) {
  const TrainingPosition& position = header.position;
  return {{"format", kCheckpointFormat},
          {"format_version", kVersion},
          {"config", header.config.to_json()},
          {"step", std::to_string(position.step)},
          {"stage", std::to_string(position.stage)},
          {"stage_step", std::to_string(position.stage_step)},
          {"seed", std::to_string(position.seed)},
          {"data", position.data}};
}

void require_usable(const std::string& name, std::span<const float> values, const std::filesystem::path& path) {
  require_finite(name, values, path);
  if (is_never_negative(name) && std::any_of(values.begin(), values.end(), [](float v) { return v < 0; }))
    throw Error(fmt::format("{}: {} holds a negative number", shown(path), name));
}

void save_checkpoint(const std::filesystem::path& path, const ModelStore& store, const Config& config,
                     const TrainingPosition& position) {
  std::map<std::string, StoredTensor> tensors;
  for (const auto* entries : {&store.layout().weights(), &store.layout().optimiser()}) {
    for (const LayoutEntry& entry : *entries) {
      const std::vector<float> values = store.read(entry);
      require_usable(entry.name, values, path);
      tensors.emplace(entry.name, StoredTensor::of(entry.stored_shape(), std::span(values)));
    }
  }
  for (const auto& [name, count] : store.batch_counters())
    tensors.emplace(name, StoredTensor::of({}, std::span(&count, 1)));
  write_safetensors(path, checkpoint_metadata({config, position}), tensors);
}

CheckpointHeader read_checkpoint_header(const std::filesystem::path& path) {
  return header_of(SafetensorsFile(path));
}

TrainingPosition load_checkpoint(const std::filesystem::path& path, ModelStore& store, const Config& config) {
  const SafetensorsFile file(path);
  const CheckpointHeader header = header_of(file);
  if (const auto difference = first_difference(header.config, config))
    throw Error(fmt::format("{}: was trained with another configuration: {} is {} there and {} here",
                            shown(path), difference->key, difference->first, difference->second));
  auto shapes = weight_shapes(store.layout());
  add_shapes(shapes, store.layout().optimiser());
  check_tensors(file, shapes, {});
  read_entries(file, store, store.layout().weights());
  read_entries(file, store, store.layout().optimiser());
  read_counters(file, store);
  return header.position;
}

RoomsConfig LoadedModel::rooms() const { return config.stages().at(position.stage).rooms; }

LoadedModel load_model(const Device& device, const std::filesystem::path& path) {
  const SafetensorsFile file(named_checkpoint(path));
  const CheckpointHeader header = header_of(file);
  ModelLayout layout(header.config.model, header.config.training.precision);
  std::set<std::string> allowed;
  for (const LayoutEntry& entry : layout.optimiser()) allowed.insert(entry.name);
  check_tensors(file, weight_shapes(layout), allowed);
  LoadedModel model{header.config, header.position, std::make_unique<ModelStore>(device, std::move(layout))};
  read_entries(file, *model.store, model.store->layout().weights());
  read_counters(file, *model.store);
  ModelConfig& in_use = model.config.model;
  in_use.slots = header.config.stages()[header.position.stage].model_in(in_use).slots;
  return model;
}

void load_weights(const std::filesystem::path& path, ModelStore& store) {
  const SafetensorsFile file(named_checkpoint(path));
  const CheckpointHeader header = header_of(file);
  const ModelLayout layout(header.config.model, header.config.training.precision);
  const auto wanted = weight_shapes(store.layout());
  const auto there = weight_shapes(layout);
  const auto shape_in = [](const std::map<std::string, StoredShape>& shapes, const std::string& name) {
    const auto found = shapes.find(name);
    return found == shapes.end() ? "is absent" : "has the shape " + to_string(found->second);
  };
  for (const auto* shapes : {&wanted, &there})
    for (const auto& [name, shape] : *shapes)
      if (shape_in(there, name) != shape_in(wanted, name))
        throw Error(fmt::format("{}: is no model of this configuration's sizes: its {} {}, here it {}",
                                shown(file.path()), name, shape_in(there, name), shape_in(wanted, name)));
  std::set<std::string> allowed;
  for (const LayoutEntry& entry : layout.optimiser()) allowed.insert(entry.name);
  check_tensors(file, wanted, allowed);
  read_entries(file, store, store.layout().weights());
  read_counters(file, store);
}

}  // namespace vkopple
