#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/model_config.h"
#include "models/rooms_config.h"
#include "models/training_config.h"

namespace vkopple {

/// Configuration of a run: {"model": {...}, "training": {...}, "rooms": {...}}. What is left out has the
/// published model's value, or with "base": "PRESET" that preset's: objects join member by member, all else
/// takes the place of what the preset has. Unknown keys, wrong types and impossible values are refused with the
/// key's full name and the allowed range.
struct Config {
  ModelConfig model;
  TrainingConfig training;
  RoomsConfig rooms;

  bool operator==(const Config&) const = default;

  /// `origin` opens every message. `overrides` take the place of what the text has (config_override.h). Throws
  /// Error, and UsageError for an override that is none.
  static Config parse(std::string_view json, std::string_view origin,
                      std::span<const std::string> overrides = {});
  /// A preset's name, or else a file's path. Throws UsageError where it is neither, Error for what is wrong in
  /// the file.
  static Config load(const std::string& path_or_preset, std::span<const std::string> overrides = {});
  /// Complete and exact: parse(to_json()) gives the same configuration, bit for bit.
  std::string to_json() const;

  /// The stages of training in order; without a list, one that trains everything to the end.
  std::vector<TrainingStage> stages() const;
};

}  // namespace vkopple
