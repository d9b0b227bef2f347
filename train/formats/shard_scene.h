#pragma once

#include <array>
#include <optional>
#include <vector>

#include "train/formats/scene.h"
#include "train/json_io.h"
#include "train/shards.h"

namespace vkopple {

/// A sample of a data set of shards (docs/data.md) as the scene it holds, read part by part. Nothing in it is
/// trusted: Error names shard and member.
class ShardScene {
 public:
  /// `sample` must outlive this, and have the parts that are asked for.
  explicit ShardScene(const Sample& sample);
  ShardScene(const ShardScene&) = delete;
  ShardScene& operator=(const ShardScene&) = delete;

  double fov() const { return view_["fov"].number(); }
  RgbImage image(int frame) const;
  bool has_layers(int frame) const;
  /// A plane has no pixels where the file doesn't hold it.
  DepthAndIds layers(int frame) const;
  std::optional<CameraPose> camera(int frame) const;
  bool has_objects(int frame) const { return frame_view(frame).contains("objects"); }
  /// Of each object, in the camera's frame.
  std::vector<std::array<double, 3>> locations_in_camera(int frame) const;
  /// Of each object, less the camera's; nothing where either is unknown.
  std::vector<std::optional<double>> yaws_in_camera(int frame) const;

  /// Of a sample with all its parts.
  SceneData whole() const;

  const Sample& sample() const { return sample_; }

 private:
  JsonView frame_view(int frame) const;
  std::vector<PlacedObject> objects(int frame) const;

  const Sample& sample_;
  Json json_;
  JsonView view_;
};

/// The parts of a scene that is sound (check_scene). Frames of which nothing but the image is known have no
/// EXR.
Sample shard_sample(const SceneData& scene);

}  // namespace vkopple
