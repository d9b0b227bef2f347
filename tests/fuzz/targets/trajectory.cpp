#include "train/formats/trajectory.h"

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/input_file.h"
#include "train/formats/camera_axes.h"

namespace vkopple::fuzz {

void trajectory(Input input) {
  const InputFile file(input);
  const auto poses = read_trajectory(file.path());
  for (const TimedPose& pose : poses) {
    nearest_pose(poses, pose.time + 0.01);
    tolerate([&] { own_pose(pose.position, pose.wxyz, CameraAxes::kOptical, WorldAxes::kZUp); });
  }
}

}  // namespace vkopple::fuzz
