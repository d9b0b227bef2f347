#include "models/camera_motion.h"

#include <algorithm>
#include <vector>

#include "models/pose_resampling.h"

namespace vkopple {
namespace {

using Floats = std::vector<float>;

template <size_t N>
void append(Floats& to, const std::array<double, N>& values) {
  for (double v : values) to.push_back(static_cast<float>(v));
}

/// The three rows and columns of a map's rotation.
void append_turn(Floats& to, const Matrix4& m) {
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 3; ++column) to.push_back(static_cast<float>(m[4 * row + column]));
}

/// One row of `still`: nothing but the camera moves, and the direction of no rotation is (1, 0).
std::array<double, kPixelMotionNumbers> still_row(const std::array<double, 3>& ego) {
  std::array<double, kPixelMotionNumbers> row{};
  std::copy(ego.begin(), ego.end(), row.begin());
  row[kPixelMotionNumbers - 2] = 1;
  return row;
}

}  // namespace

CameraMotion::CameraMotion(Graph& graph, const ModelConfig& config, int64_t batch, bool background_only)
    : batch_(batch) {
  if (background_only || !config.relaxed) m23 = graph.input("m23", row_major({batch, 4, 4}));
  if (background_only) return;
  if (!config.relaxed) m12 = graph.input("m12", row_major({batch, 4, 4}));
  if (config.orientation == Orientation::kEuler) {
    ego23 = graph.input("ego23", row_major({batch, 6}));
    turn12 = graph.input("turn12", row_major({batch, 1, 3, 3}));
    turn23 = graph.input("turn23", row_major({batch, 1, 3, 3}));
    return;
  }
  ego23 = graph.input("ego23", row_major({batch, 3}));
  index12 = graph.input("index12", unsigned_ints({batch}));
  index23 = graph.input("index23", unsigned_ints({batch}));
  resampling = graph.input("resampling", row_major({kResamplingAngles, config.bins}));
  if (!config.relaxed) return;
  slots_ego12 = graph.input("slots_ego12", row_major({batch, config.slots, 3}));
  slots_ego23 = graph.input("slots_ego23", row_major({batch, config.slots, 3}));
  still = graph.input("still", row_major({batch, 1, kPixelMotionNumbers}));
}

void CameraMotion::feed(Executor& executor, std::span<const CameraPose> poses) const {
  Floats maps12, maps23, turns12, turns23, ego, egos12, egos23, stills;
  std::vector<uint32_t> indices12, indices23;
  const int64_t slots = slots_ego12 ? slots_ego12.shape()[1] : 0;
  const auto b = static_cast<size_t>(batch_);
  for (size_t i = 0; i < b; ++i) {
    const CameraPose &p1 = poses[i], &p2 = poses[b + i], &p3 = poses[2 * b + i];
    const Matrix4 map12 = relative(p1, p2);
    const Matrix4 map23 = relative(p2, p3);
    append(maps12, map12);
    append(maps23, map23);
    append_turn(turns12, map12);
    append_turn(turns23, map23);
    const auto planar12 = ego_motion(p1, p2);
    const auto planar23 = ego_motion(p2, p3);
    if (turn12)
      append(ego, spatial_ego_motion(p2, p3));
    else
      append(ego, planar23);
    indices12.push_back(resampling_index(-planar12[2]));
    indices23.push_back(resampling_index(-planar23[2]));
    for (int64_t k = 0; k < slots; ++k) {
      append(egos12, planar12);
      append(egos23, planar23);
    }
    append(stills, still_row(planar23));
  }
  const auto write = [&](const Value& value, const Floats& values) {
    if (value) executor.write(value, values);
  };
  write(m12, maps12);
  write(m23, maps23);
  write(ego23, ego);
  write(turn12, turns12);
  write(turn23, turns23);
  write(slots_ego12, egos12);
  write(slots_ego23, egos23);
  write(still, stills);
  if (index12) executor.write_words(index12, indices12);
  if (index23) executor.write_words(index23, indices23);
}

void CameraMotion::feed_constants(Executor& executor) const {
  if (resampling) executor.write(resampling, resampling_rows(resampling.shape()[1]));
}

}  // namespace vkopple
