#include "graph/matmul/linear_product.h"

#include <algorithm>

#include "graph/matmul/linear_shared.h"

namespace vkopple {
namespace {

/// Outputs of an invocation of the forward kernel. On lavapipe the reads of x are worth sharing; a GPU rather
/// wants more invocations.
constexpr uint32_t kOutputsOnCpu = 4;
constexpr uint32_t kOutputsOnGpu = 1;

uint32_t divide_up(uint32_t a, uint32_t b) { return (a + b - 1) / b; }

/// Kernels take an operand as vectors or as single elements; the other binding stays empty.
Slice where(bool condition, const Slice& slice) { return condition ? slice : Slice{}; }

}  // namespace

LinearProduct::LinearProduct(Recorder& recorder, int64_t rows, int64_t inputs, int64_t outputs,
                             int64_t x_offset, int64_t y_offset)
    : recorder_(&recorder), push_{static_cast<uint32_t>(rows),     static_cast<uint32_t>(inputs),
                                  static_cast<uint32_t>(outputs),  static_cast<uint32_t>(x_offset),
                                  static_cast<uint32_t>(y_offset), 0} {}

LinearPush LinearProduct::push(uint32_t accumulate) const {
  LinearPush push = push_;
  push.accumulate = accumulate;
  return push;
}

bool LinearProduct::shared() const {
  const Caps& caps = recorder_->caps();
  return caps.kernels == KernelFamily::kShared || (caps.kernels == KernelFamily::kAuto && !caps.cpu());
}

void LinearProduct::dispatch(std::string_view shader, const std::vector<uint32_t>& more_constants,
                             std::initializer_list<Slice> bindings, uint32_t accumulate, uint32_t columns,
                             uint32_t rows) const {
  const Caps& caps = recorder_->caps();
  const uint32_t local = caps.cpu() ? std::clamp(caps.subgroup_size, 4U, 64U) : 64;
  std::vector<uint32_t> constants{local, push_.vector_inputs() ? 1U : 0U, push_.vector_outputs() ? 1U : 0U};
  constants.insert(constants.end(), more_constants.begin(), more_constants.end());
  recorder_->dispatch(shader, constants, bindings, push(accumulate), {divide_up(columns, local), rows, 1});
}

void LinearProduct::forward(const Slice& x, const Slice& w, const Slice& b, const Slice& y) const {
  if (shared())
    return record_linear_shared(*recorder_, LinearPart::kForward, push(0),
                                {.a = x, .b = w, .bias = b, .out = y});
  const uint32_t outputs = recorder_->caps().cpu() ? kOutputsOnCpu : kOutputsOnGpu;
  const bool vectors = push_.vector_inputs();
  dispatch("linear_forward", {outputs, b ? 1U : 0U},
           {where(vectors, x), where(!vectors, x), where(vectors, w), where(!vectors, w), b, y}, 0,
           divide_up(push_.outputs, outputs), divide_up(push_.rows, 4));
}

void LinearProduct::dx(const Slice& dy, const Slice& w, const Slice& dx, uint32_t accumulate) const {
  if (shared())
    return record_linear_shared(*recorder_, LinearPart::kDx, push(accumulate),
                                {.a = dy, .b = w, .bias = {}, .out = dx});
  const bool inputs = push_.vector_inputs();
  const bool outputs = push_.vector_outputs();
  dispatch("linear_dx", {},
           {where(outputs, dy), where(!outputs, dy), where(inputs, w), where(!inputs, w), dx, dx}, accumulate,
           divide_up(push_.inputs, 4), divide_up(push_.rows, 4));
}

void LinearProduct::dw(const Slice& dy, const Slice& x, const Slice& dw, uint32_t accumulate) const {
  if (shared())
    return record_linear_shared(*recorder_, LinearPart::kDw, push(accumulate),
                                {.a = dy, .b = x, .bias = {}, .out = dw});
  const bool inputs = push_.vector_inputs();
  const bool outputs = push_.vector_outputs();
  dispatch("linear_dw", {},
           {where(outputs, dy), where(!outputs, dy), where(inputs, x), where(!inputs, x), dw, dw}, accumulate,
           divide_up(push_.inputs, 4), divide_up(push_.outputs, 4));
}

void LinearProduct::db(const Slice& dy, const Slice& db, uint32_t accumulate) const {
  dispatch("linear_db", {}, {dy, db}, accumulate, push_.outputs, 1);
}

}  // namespace vkopple
