#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/error.h"
#include "train/formats/example.h"
#include "train/formats/scene_reader.h"

namespace vkopple {

// What the formats have in common whose scenes are examples in TFRecord files.

/// A feature that a format reads.
struct UsualFeature {
  std::string ours;   ///< for --map
  std::string usual;  ///< what files call it where the user does not say otherwise
  std::string holds;  ///< for `--help`
  bool needed = true;
};

/// Their `fields` for SceneFormat.
std::vector<NamedHelp> field_help(const std::vector<UsualFeature>& features);

/// What a data set's files call the features. "-" is a name for what they don't have.
class FeatureNames {
 public:
  FeatureNames(const std::vector<UsualFeature>& features, const FormatOptions& options);

  /// Throws UsageError, which lists the features that there are, where the example lacks one that was not given
  /// up.
  void check(const Example& first) const;

  bool has(const std::string& ours) const { return features_.contains(ours); }
  /// Throws Error where it was given up.
  const std::string& operator[](const std::string& ours) const;

 private:
  std::map<std::string, UsualFeature>
      features_;  ///< by ours, under the names of the files, without those given up
};

/// Scenes of the examples of TFRecord files, one each.
class ExampleScenes : public SceneReader {
 public:
  /// Fills in all but `key` and `source`.
  using Convert = std::function<SceneData(const Example& example, const FeatureNames& names)>;

  /// `path`: a file or a folder of them. The first example must have the features.
  ExampleScenes(const std::filesystem::path& path, FeatureNames names, Convert convert);

  std::optional<SceneData> next() override;

 private:
  TfRecordReader records_;
  FeatureNames names_;
  Convert convert_;
  bool checked_ = false;
};

/// Whether the first example of `path` has all of these features. Throws nothing.
bool first_example_has(const std::filesystem::path& path, const std::vector<std::string>& features);

/// The bytes of a feature's string, for decoders.
inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// "a.tfrecord: record 3: frames[1]", for messages.
std::string place_of(const Example& example, const std::string& feature, std::size_t index);

/// A frame for each PNG or JPEG of a feature. Error where there are too many of them for a scene, or too many
/// pixels.
std::vector<SceneFrame> decode_frames(const Example& example, const std::string& feature);

/// A picture that must be as large as the first frame's. Throws Error.
template <class Picture>
Picture fitting(Picture picture, const std::vector<SceneFrame>& frames, const std::string& where) {
  const RgbImage& first = frames.at(0).image;
  if (picture.height == first.height && picture.width == first.width) return picture;
  throw Error(where + ": it is not as large as the first frame");
}

/// What `make` returns; its Error is told with the place.
template <class Make>
auto made_at(const std::string& where, Make&& make) {
  try {
    return make();
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
}

}  // namespace vkopple
