#pragma once

#include "graph/matmul/linear_push.h"
#include "runtime/recorder.h"

namespace vkopple {

/// Records y = x wᵀ + b and its gradients: x (rows, inputs), w (outputs, inputs), y (rows, outputs), all
/// row-major; x and y begin `x_offset` and `y_offset` elements into the slices given for them and their
/// gradients. Sums have a fixed order, the same in both families of kernels: those of GPUs (linear_shared.h)
/// and those that run anywhere, which CPU devices take. Meant for few rows (batches of vectors), so that sums
/// over rows are not cut into strips.
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
  LinearPush push(uint32_t accumulate) const;
  bool shared() const;
  void dispatch(std::string_view shader, const std::vector<uint32_t>& more_constants,
                std::initializer_list<Slice> bindings, uint32_t accumulate, uint32_t columns,
                uint32_t rows) const;

  Recorder* recorder_;
  LinearPush push_;
};

}  // namespace vkopple
