#include "models/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

#include "models/config_override.h"
#include "models/presets.h"
#include "models/quote_json.h"
#include "models/strict_json.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::uintmax_t kLargestFile = 1 << 20;

std::string read_small_file(const std::string& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure) throw Error(fmt::format("{}: cannot be read as a configuration: {}", path, failure.message()));
  if (size > kLargestFile)
    throw Error(fmt::format("{}: {} bytes are too many for a configuration; check the path", path, size));
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file) throw Error(fmt::format("{}: cannot be read; check the path and its permissions", path));
  return text;
}

/// Members of `above` take the place of those of `base`; objects are joined member by member.
nlohmann::json overlaid(nlohmann::json base, const nlohmann::json& above) {
  if (!base.is_object() || !above.is_object()) return above;
  for (const auto& [key, value] : above.items())
    base[key] = base.contains(key) ? overlaid(base[key], value) : value;
  return base;
}

/// Replaces "base": "PRESET" by what that preset says and the configuration does not. Presets without a base
/// end the chain, so presets must not be each other's.
void fill_in_base(nlohmann::json& value, std::string_view origin) {
  if (!value.is_object() || !value.contains("base")) return;
  const nlohmann::json name = value["base"];
  const auto preset = name.is_string() ? find_preset(name.get<std::string>()) : std::nullopt;
  if (!preset)
    JsonObject(value, std::string(origin), "")
        .refuse("base", fmt::format("is {}; give a preset, one of {}", quote_json(name),
                                    fmt::join(preset_names(), ", ")));
  nlohmann::json base = parse_strict_json(*preset, fmt::format("preset {}", name.get<std::string>()));
  fill_in_base(base, origin);
  value.erase("base");
  value = overlaid(std::move(base), value);
}

}  // namespace

Config Config::parse(std::string_view text, std::string_view origin, std::span<const std::string> overrides) {
  nlohmann::json value = parse_strict_json(text, origin);
  fill_in_base(value, origin);
  for (const std::string& assignment : overrides) override_value(value, assignment);
  JsonObject root(value, fmt::format("{}{}", origin, overrides.empty() ? "" : " with --set"), "");
  Config c;
  c.model = read_model_config(root.object("model"));
  c.rooms = read_rooms_config(root.object("rooms"), RoomsConfig{});
  c.training = read_training_config(root.object("training"), c.model, c.rooms);
  root.finish();
  return c;
}

Config Config::load(const std::string& path_or_preset, std::span<const std::string> overrides) {
  if (const auto preset = find_preset(path_or_preset))
    return parse(*preset, fmt::format("preset {}", path_or_preset), overrides);
  if (!std::filesystem::exists(path_or_preset)) {
    throw UsageError(fmt::format("{}: no such file, nor a preset; the presets are {}", path_or_preset,
                                 fmt::join(preset_names(), ", ")));
  }
  return parse(read_small_file(path_or_preset), path_or_preset, overrides);
}

std::string Config::to_json() const {
  const nlohmann::ordered_json value{{"model", write_model_config(model)},
                                     {"training", write_training_config(training, rooms)},
                                     {"rooms", write_rooms_config(rooms)}};
  return value.dump(2);
}

std::vector<TrainingStage> Config::stages() const {
  if (!training.stages.empty()) return training.stages;
  TrainingStage all;
  all.networks = networks_of(model);
  all.learning_rate = training.learning_rate;
  all.batch = training.batch;
  all.accumulate = training.accumulate;
  all.rooms = rooms;
  return {all};
}

}  // namespace vkopple
