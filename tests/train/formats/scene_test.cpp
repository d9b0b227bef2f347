#include "train/formats/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/support/expect_error.h"
#include "tests/support/small_scene.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::small_scene;

void refuse(const std::function<void(SceneData&)>& spoil, const std::string& part) {
  SceneData scene = small_scene(1, 3);
  scene.source = "films.tfrecord: record 3";
  spoil(scene);
  expect_error([&] { check_scene(scene); }, {"films.tfrecord: record 3: ", part});
}

TEST(CheckScene, LetsSoundOnesPass) {
  check_scene(small_scene(1, 1));
  check_scene(small_scene(1, static_cast<int>(kMostSceneFrames)));
  SceneData little = small_scene(1, 2);
  little.shapes.clear();
  for (SceneFrame& frame : little.frames) frame = {.image = frame.image};
  check_scene(little);
  SceneData labels = small_scene(1, 1);
  labels.frames[0].objects.reset();
  labels.frames[0].ids.pixels[0] = 11;  // objects whose places are unknown
  check_scene(labels);
}

TEST(CheckScene, NamesWhatIsWrong) {
  const float nan = std::nanf("");
  refuse([](SceneData& s) { s.key = ""; }, "key");
  refuse([](SceneData& s) { s.key = "../a"; }, "'../a'");
  refuse([](SceneData& s) { s.key = "a.b"; }, "'a.b'");
  refuse([](SceneData& s) { s.fov = 0; }, "angle of view");
  refuse([](SceneData& s) { s.fov = 3.2; }, "angle of view");
  refuse([&](SceneData& s) { s.fov = nan; }, "angle of view");
  refuse([](SceneData& s) { s.scale = 0; }, "scale");
  refuse([&](SceneData& s) { s.scale = nan; }, "scale");
  refuse([](SceneData& s) { s.frames.clear(); }, "no frames");
  refuse([](SceneData& s) { s.frames.resize(kMostSceneFrames + 1, s.frames[0]); }, "121 frames");
  refuse([](SceneData& s) { s.frames[0].image = {}; }, "frame 0: the image has no pixels");
  refuse([](SceneData& s) { s.frames[1].image = RgbImage(6, 4); }, "frame 1: its size of 4 x 6");
  refuse([](SceneData& s) { s.frames[2].image.pixels.pop_back(); }, "frame 2");
  refuse([](SceneData& s) { s.frames[1].depth = Plane<float>(2, 2); }, "depth and image");
  refuse([](SceneData& s) { s.frames[1].ids = Plane<std::uint32_t>(2, 2); }, "labels and image");
  refuse([](SceneData& s) { s.frames[1].image.pixels[5] = 1.5F; }, "colour");
  refuse([&](SceneData& s) { s.frames[1].image.pixels[5] = nan; }, "colour");
  refuse([](SceneData& s) { s.frames[1].depth.pixels[5] = -1; }, "depth");
  refuse([&](SceneData& s) { s.frames[1].depth.pixels[5] = nan; }, "depth");
  refuse([](SceneData& s) { (*s.frames[1].camera)[3] = 1e9; }, "camera");
  refuse([&](SceneData& s) { (*s.frames[1].camera)[0] = static_cast<double>(nan); }, "camera");
  refuse([](SceneData& s) { s.frames[1].ids.pixels[5] = 3; }, "label 3");
  refuse([](SceneData& s) { (*s.frames[1].objects)[1].location[2] = 1e7; }, "object");
  refuse([](SceneData& s) { s.frames[1].objects->resize(1001); }, "1001 objects");
}

}  // namespace
}  // namespace vkopple
