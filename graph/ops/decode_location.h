#pragma once

#include "graph/graph.h"

namespace vkopple {

/// What turns raw numbers into places (docs/model.md §2.2). The angle is in radians, lengths in scene units.
struct LocationRange {
  float fov;
  float max_depth;
  float max_height;
};

/// raw (B, K, R), R ≥ 3 → location (B, K, 3) in the camera's frame, from the first three of the R numbers.
class DecodeLocation : public Op {
 public:
  explicit DecodeLocation(const LocationRange& range) : range_(range) {}
  std::string_view name() const override { return "decode_location"; }
  const LocationRange& range() const { return range_; }
  std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const override;
  Needs needs(std::span<const TensorSpec> x, const Caps& caps) const override;
  void record_forward(Recorder& recorder, const Forward& io) const override;
  void record_backward(Recorder& recorder, const Backward& io) const override;

 private:
  LocationRange range_;
};

Value decode_location(Value raw, float fov, float max_depth, float max_height);

}  // namespace vkopple
