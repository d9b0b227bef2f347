#include "train/formats/scene.h"

#include "tests/fuzz/fuzz.h"
#include "train/formats/shard_scene.h"
#include "train/image_io.h"

namespace vkopple::fuzz {

/// The JSON of a scene of three small frames.
void scene(Input input) {
  static const std::vector<std::byte> kImage = encode_png(RgbImage(2, 3));
  static const std::vector<std::byte> kLayers = encode_exr({Plane<float>(2, 3), Plane<std::uint32_t>(2, 3)});
  Sample sample{.key = "a", .parts = {{"json", {input.begin(), input.end()}}}, .shard = "a.tar"};
  for (const char frame : {'0', '1', '2'}) {
    sample.parts[std::string(1, frame) + ".png"] = kImage;
    sample.parts[std::string(1, frame) + ".exr"] = kLayers;
  }
  const ShardScene read(sample);
  tolerate([&] { read.fov(); });
  tolerate([&] { read.camera(1); });
  tolerate([&] { read.locations_in_camera(2); });
  tolerate([&] { read.yaws_in_camera(2); });
  const SceneData whole = read.whole();
  check_scene(whole);
  shard_sample(whole);
}

}  // namespace vkopple::fuzz
