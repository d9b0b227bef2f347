#include "train/data/load_scenes.h"

#include <fmt/format.h>

#include <vector>

#include "runtime/error.h"
#include "train/formats/fit_scene.h"
#include "train/formats/scene_reader.h"
#include "train/formats/shard_scene.h"
#include "train/quote.h"

namespace vkopple {
namespace {

/// Pictures that have the model's ratio are made smaller; ShardSource tells what is wrong with others.
SceneData shrunk(SceneData scene, const Lens& lens) {
  const RgbImage& image = scene.frames.at(0).image;
  const bool same_ratio = std::int64_t{image.height} * lens.width == std::int64_t{image.width} * lens.height;
  if (!same_ratio || image.height <= lens.height) return scene;
  return fitted(std::move(scene), {.height = lens.height, .width = lens.width});
}

std::uint64_t bytes_of(const Sample& sample) {
  std::uint64_t bytes = 0;
  for (const auto& [extension, part] : sample.parts) bytes += part.size();
  return bytes;
}

}  // namespace

std::unique_ptr<SampleStore> load_scenes(const std::filesystem::path& path, const Lens& lens,
                                         const LoadLimits& limits) {
  const std::string name = quote(path.string(), 4096);
  const std::string advice = "convert it to shards by vkopple convert, and use these";
  try {
    const std::string format = detect_format(path).name;
    if (format == "shards") return std::make_unique<ShardStore>(path);
    const auto reader = open_scenes(path, format);
    std::vector<Sample> samples;
    std::uint64_t bytes = 0;
    while (samples.size() < limits.scenes) {
      std::optional<SceneData> scene = reader->next();
      if (!scene) break;
      Sample sample = shard_sample(shrunk(std::move(*scene), lens));
      sample.shard = path;
      bytes += bytes_of(sample);
      if (bytes > limits.bytes)
        throw Error(fmt::format("{}: more than {} MiB, too much to be taken into memory; {}", name,
                                limits.bytes >> 20, advice));
      samples.push_back(std::move(sample));
    }
    return std::make_unique<MemoryStore>(std::move(samples));
  } catch (const UsageError& problem) {  // an option is needed, which only convert has
    throw Error(fmt::format("{}; with that option, {}", problem.what(), advice));
  }
}

}  // namespace vkopple
