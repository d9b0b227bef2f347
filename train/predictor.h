#pragma once

#include <array>
#include <memory>

#include "graph/executor.h"
#include "graph/graph.h"
#include "models/camera.h"
#include "models/opple.h"
#include "train/image.h"

namespace vkopple {

/// What the model expects to see next, with its parts (docs/model.md §5).
struct PredictedFrame {
  RgbImage warped;      ///< pixels of frame 2, moved
  RgbImage imagined;    ///< by the imagination network
  RgbImage predicted;   ///< both, blended
  Plane<float> weight;  ///< of the warped image, from 0 to 0.99
  Plane<float> depth;   ///< blended likewise; Euclidean distance, scene units
};

/// Predicts third frames from the two before and the camera's poses, with the weights in `groups`.
class Predictor {
 public:
  Predictor(const Device& device, const ModelConfig& config, std::shared_ptr<GroupStore> groups);

  /// Frames have the model's size. Throws Error on another, and where what comes out is no number.
  PredictedFrame predict(const RgbImage& frame1, const RgbImage& frame2,
                         const std::array<CameraPose, 3>& poses);

 private:
  std::vector<float> kept(const std::string& name);
  RgbImage image(const std::string& name);
  Plane<float> plane(const std::string& name);

  Graph graph_;
  Opple model_;
  std::unique_ptr<Executor> executor_;
};

/// Mean over pixels and colours of the squared difference. Throws Error where sizes differ.
double mean_squared_error(const RgbImage& a, const RgbImage& b);

}  // namespace vkopple
