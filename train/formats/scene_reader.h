#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "train/formats/format_options.h"
#include "train/formats/scene.h"

namespace vkopple {

/// Scenes of a data set, one after the other.
class SceneReader {
 public:
  virtual ~SceneReader() = default;
  /// Nothing after the last one. Nothing in the files is trusted: Error names file and place.
  virtual std::optional<SceneData> next() = 0;
  /// How many scenes there are in all, where that is known without reading them.
  virtual std::optional<std::uint64_t> count() const { return std::nullopt; }
};

/// Takes scenes, of which check_scene found nothing wrong, into a new data set.
class SceneWriter {
 public:
  virtual ~SceneWriter() = default;
  virtual void add(const SceneData& scene) = 0;
  /// As the last call; without it the data set is incomplete.
  virtual void finish() = 0;
};

/// A format of data sets. Every train/formats/readers/NAME_format.cpp defines `SceneFormat NAME_format();`,
/// which the build finds (cmake/formats.cmake).
struct SceneFormat {
  std::string name;                       ///< for --format
  std::string about;                      ///< one line
  std::vector<NamedHelp> settings;        ///< that `open` knows
  std::vector<NamedHelp> write_settings;  ///< that `create` knows
  std::vector<NamedHelp> fields;          ///< that `--map` can rename
  /// Whether a path holds this format, by a quick look that throws nothing. At most one format may say so.
  bool (*recognises)(const std::filesystem::path& path) = nullptr;
  std::unique_ptr<SceneReader> (*open)(const std::filesystem::path& path,
                                       const FormatOptions& options) = nullptr;
  /// Null where the format is only read. `path` may not hold a data set already.
  std::unique_ptr<SceneWriter> (*create)(const std::filesystem::path& path,
                                         const FormatOptions& options) = nullptr;
};

/// All, by name.
std::vector<SceneFormat> scene_formats();

/// The format of that name. Throws UsageError, which lists those there are.
SceneFormat scene_format(const std::string& name);

/// The format that recognises `path`. Throws Error where nothing is there, UsageError where none or several
/// formats do.
SceneFormat detect_format(const std::filesystem::path& path);

/// Opens `path` in the format `name`, or where that is empty in the one that recognises it. Throws UsageError
/// for an option that the format doesn't know. Scenes that come out were checked by check_scene, and have keys
/// that differ.
std::unique_ptr<SceneReader> open_scenes(const std::filesystem::path& path, const std::string& name = "",
                                         const FormatOptions& options = {});

/// A new data set at `path`. Throws UsageError for an option that the format doesn't know in writing, or where
/// it is only read.
std::unique_ptr<SceneWriter> create_scenes(const std::filesystem::path& path, const std::string& name,
                                           const FormatOptions& options = {});

}  // namespace vkopple
