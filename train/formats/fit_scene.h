#pragma once

#include <optional>

#include "train/formats/scene.h"

namespace vkopple {

/// What a scene shall look like.
struct SceneFit {
  std::optional<int> height, width;  ///< pixels; as they are, where not given
  std::optional<double> fov;         ///< vertical, radians; no wider than the scene's
  double scale = 1;                  ///< of all lengths
};

/// The scene with pictures cropped about their middle, so that they show `fov` and have the ratio of height and
/// width asked for, then resized; pixels stay square. Colours are mixed by area, labels and depth with gaps
/// taken from the nearest pixel. Throws Error where the pictures show too little.
SceneData fitted(SceneData scene, const SceneFit& fit);

}  // namespace vkopple
