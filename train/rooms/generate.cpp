#include "train/rooms/generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "runtime/transfer.h"
#include "train/image_io.h"
#include "train/rooms/scene_json.h"
#include "train/shards.h"

namespace vkopple {
namespace {

constexpr uint64_t kScenesAtOnce = 8;

std::vector<std::byte> to_bytes(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// The part of an array that belongs to one of equal views.
template <class T>
std::vector<T> view_of(const std::vector<T>& all, std::size_t view, std::size_t size) {
  const auto begin = all.begin() + static_cast<std::ptrdiff_t>(view * size);
  return {begin, begin + static_cast<std::ptrdiff_t>(size)};
}

/// Pixels of any number of views, on the host.
class Drawn {
 public:
  Drawn(RoomRenderer& renderer, const std::vector<View>& views) : lens_(renderer.lens()) {
    const auto group_size = static_cast<std::size_t>(renderer.views());
    for (std::size_t first = 0; first < views.size(); first += group_size) {
      std::vector<View> group(
          views.begin() + static_cast<std::ptrdiff_t>(first),
          views.begin() + static_cast<std::ptrdiff_t>(std::min(first + group_size, views.size())));
      group.resize(group_size, group.back());
      renderer.render(group);
      append(images_, download_values<float>(renderer.device(), renderer.image()));
      append(depths_, download_values<float>(renderer.device(), renderer.depth()));
      append(labels_, download_values<uint32_t>(renderer.device(), renderer.label()));
    }
  }

  RgbImage image(std::size_t view) const {
    RgbImage image(lens_.height, lens_.width);
    image.pixels = view_of(images_, view, 3 * area());
    return image;
  }
  DepthAndIds layers(std::size_t view) const {
    DepthAndIds layers{{lens_.height, lens_.width}, {lens_.height, lens_.width}};
    layers.depth.pixels = view_of(depths_, view, area());
    layers.ids.pixels = view_of(labels_, view, area());
    return layers;
  }

 private:
  template <class T>
  static void append(std::vector<T>& to, const std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
  }
  std::size_t area() const { return lens_.pixels(); }

  Lens lens_;
  std::vector<float> images_, depths_;
  std::vector<uint32_t> labels_;
};

/// `first_view`: where the scene's frames begin.
Sample make_sample(uint64_t index, const Scene& scene, const Lens& lens, const Drawn& drawn,
                   std::size_t first_view) {
  Sample sample;
  sample.key = fmt::format("{:06}", index);
  std::vector<std::vector<uint64_t>> pixels;
  for (std::size_t frame = 0; frame < scene.cameras.size(); ++frame) {
    const DepthAndIds layers = drawn.layers(first_view + frame);
    sample.parts[fmt::format("{}.png", frame)] = encode_png(drawn.image(first_view + frame));
    sample.parts[fmt::format("{}.exr", frame)] = encode_exr(layers);
    std::vector<uint64_t> counts(scene.objects.size());
    for (const uint32_t id : layers.ids.pixels) {
      if (id > 0) ++counts.at(id - 1);
    }
    pixels.push_back(counts);
  }
  sample.parts["json"] = to_bytes(scene_json(scene, lens, pixels).dump(1) + "\n");
  return sample;
}

}  // namespace

void generate_rooms(const Device& device, const GenerateOptions& options,
                    const std::function<void(uint64_t)>& progress) {
  ShardWriter writer(options.folder, "rooms", options.scenes_per_shard);
  const auto frames = static_cast<uint64_t>(options.rooms.frames);
  const uint64_t views_at_once =
      std::clamp<uint64_t>(options.pixels_at_once / options.lens.pixels(), 1, kScenesAtOnce * frames);
  const uint64_t scenes_at_once = std::max<uint64_t>(views_at_once / frames, 1);
  RoomRenderer renderer(device, options.lens, options.rooms,
                        static_cast<int>(std::min(views_at_once, scenes_at_once * frames)));
  for (uint64_t first = 0; first < options.scenes; first += scenes_at_once) {
    std::vector<Scene> scenes;
    for (uint64_t i = first; i < std::min(first + scenes_at_once, options.scenes); ++i) {
      scenes.push_back(sample_scene(options.rooms, options.lens.half_view(), options.seed, i));
    }
    std::vector<View> views;
    for (const Scene& scene : scenes) {
      for (int frame = 0; frame < options.rooms.frames; ++frame) views.push_back({&scene, frame});
    }
    const Drawn drawn(renderer, views);
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      writer.add(make_sample(first + i, scenes[i], options.lens, drawn, i * static_cast<std::size_t>(frames)));
      if (progress) progress(first + i + 1);
    }
  }
  writer.finish();
}

}  // namespace vkopple
