#pragma once

#include "runtime/recorder.h"

namespace vkopple {

/// Records y = x wᵀ + b and its gradients: x (rows, inputs), w (outputs, inputs), y (rows, outputs), all
/// row-major; x and y begin `x_offset` and `y_offset` elements into the slices given for them and their
/// gradients. Sums have a fixed order. Meant for few rows (batches of vectors).
class LinearProduct {
 public:
  LinearProduct(Recorder& recorder, int64_t rows, int64_t inputs, int64_t outputs, int64_t x_offset = 0,
                int64_t y_offset = 0);

  /// b may be empty.
  void forward(const Slice& x, const Slice& w, const Slice& b, const Slice& y) const;
  void dx(const Slice& dy, const Slice& w, const Slice& dx, uint32_t accumulate) const;
  void dw(const Slice& dy, const Slice& x, const Slice& dw, uint32_t accumulate) const;
  void db(const Slice& dy, const Slice& db, uint32_t accumulate) const;

 private:
  struct LinearPush {
    uint32_t rows;
    uint32_t inputs;
    uint32_t outputs;
    uint32_t x_offset;
    uint32_t y_offset;
    uint32_t accumulate;
  };
  LinearPush push(uint32_t accumulate) const;
  bool vector_inputs() const { return push_.inputs % 4 == 0 && push_.x_offset % 4 == 0; }
  bool vector_outputs() const { return push_.outputs % 4 == 0 && push_.y_offset % 4 == 0; }
  void dispatch(std::string_view shader, const std::vector<uint32_t>& more_constants,
                std::initializer_list<Slice> bindings, uint32_t accumulate, uint32_t columns,
                uint32_t rows) const;

  Recorder* recorder_;
  LinearPush push_;
};

}  // namespace vkopple
