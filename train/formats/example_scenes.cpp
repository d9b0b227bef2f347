#include "train/formats/example_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "train/image_io.h"
#include "train/quote.h"

namespace vkopple {
namespace {

constexpr const char* kNone = "-";

/// "movi_e-train_tfrecord-00003-of-01024-000012". Of long names the end is kept, where files of a set differ.
std::string key_of(const TfRecord& record) {
  constexpr std::size_t kLongest = 64;
  std::string name = record.file.filename().string();
  name.erase(0, name.size() - std::min(name.size(), kLongest));
  std::replace_if(
      name.begin(), name.end(),
      [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '_'; }, '_');
  return fmt::format("{}-{:06}", name, record.index);
}

}  // namespace

std::vector<NamedHelp> field_help(const std::vector<UsualFeature>& features) {
  std::vector<NamedHelp> all;
  for (const UsualFeature& f : features)
    all.push_back(
        {f.ours, fmt::format("{}; usually {}{}", f.holds, f.usual, f.needed ? "" : ", may be absent: -")});
  return all;
}

FeatureNames::FeatureNames(const std::vector<UsualFeature>& features, const FormatOptions& options) {
  for (UsualFeature feature : features) {
    feature.usual = options.field(feature.ours, feature.usual);
    if (feature.usual != kNone)
      features_.emplace(feature.ours, feature);
    else if (feature.needed)
      throw UsageError(fmt::format("--map {}=-: this format can't do without it", feature.ours));
  }
}

void FeatureNames::check(const Example& first) const {
  for (const auto& [ours, feature] : features_) {
    if (first.contains(feature.usual)) continue;
    throw UsageError(fmt::format("{}: no feature {} for {}; give its name by --map {}=NAME{}. There are {}",
                                 first.where(), quote(feature.usual), ours, ours,
                                 feature.needed ? "" : " (- where there is none)", first.listed()));
  }
}

const std::string& FeatureNames::operator[](const std::string& ours) const {
  const auto found = features_.find(ours);
  if (found == features_.end()) throw Error(fmt::format("the feature {} was given up", ours));
  return found->second.usual;
}

ExampleScenes::ExampleScenes(const std::filesystem::path& path, FeatureNames names, Convert convert)
    : records_(find_tfrecords(path)), names_(std::move(names)), convert_(std::move(convert)) {}

std::optional<SceneData> ExampleScenes::next() {
  const std::optional<TfRecord> record = records_.next();
  if (!record) return std::nullopt;
  const Example example(*record);
  if (!checked_) names_.check(example);
  checked_ = true;
  SceneData scene = convert_(example, names_);
  scene.key = key_of(*record);
  scene.source = record->where();
  return scene;
}

std::string place_of(const Example& example, const std::string& feature, std::size_t index) {
  return fmt::format("{}[{}]", example.where(feature), index);
}

std::vector<SceneFrame> decode_frames(const Example& example, const std::string& feature) {
  const auto pictures = example.bytes(feature);
  if (pictures.size() > kMostSceneFrames)
    throw Error(fmt::format("{}: {} frames are more than {}", example.where(feature), pictures.size(),
                            kMostSceneFrames));
  std::vector<SceneFrame> frames;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string where = place_of(example, feature, i);
    SceneFrame frame{.image = decode_rgb(as_bytes(pictures[i]), where)};
    check_film_size(pictures.size(), frame, where);
    if (i > 0) frame.image = fitting(std::move(frame.image), frames, where);
    frames.push_back(std::move(frame));
  }
  return frames;
}

bool first_example_has(const std::filesystem::path& path, const std::vector<std::string>& features) {
  try {
    const std::optional<TfRecord> record = TfRecordReader(find_tfrecords(path)).next();
    if (!record) return false;
    const Example example(*record);
    return std::all_of(features.begin(), features.end(),
                       [&](const auto& name) { return example.contains(name); });
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace vkopple
