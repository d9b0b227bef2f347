#pragma once

#include "train/formats/scene.h"

namespace vkopple::test {

/// A sound scene of 6 x 4 pixels with two objects, all of which is known; frames and scenes of different
/// numbers differ. Colours are those of 8 bits, depth is a multiple of 1/16.
SceneData small_scene(int number, int frames);

/// Colours from 0 to 255, as a PNG holds them.
std::vector<int> bytes_of(const RgbImage& image);

/// Expects that nothing but `source` differs.
void expect_same(const SceneData& found, const SceneData& expected);

}  // namespace vkopple::test
