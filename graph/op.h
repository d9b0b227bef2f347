#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graph/tensor.h"
#include "runtime/buffer.h"
#include "runtime/recorder.h"

namespace vkopple {

/// A tensor on the device, as an op sees it. Empty where absent.
struct Operand {
  TensorSpec spec;
  Slice slice;
  explicit operator bool() const { return static_cast<bool>(slice); }
  const Shape& shape() const { return spec.shape; }
};

/// What an op needs beside its inputs and outputs. Bit i of a mask speaks of input or output i.
struct Needs {
  std::vector<TensorSpec> saved;  ///< written by forward for backward
  uint64_t forward_scratch = 0;   ///< bytes
  uint64_t backward_scratch = 0;  ///< bytes
  uint32_t inputs_for_backward =
      ~0U;  ///< inputs whose values backward reads; the others' memory is freed earlier
  uint32_t outputs_for_backward = ~0U;  ///< likewise for outputs
  double forward_flop = 0;  ///< of convolutions and products, a multiply and an add counting one each
  double backward_flop = 0;
};

/// Whether a mask of Needs speaks of input or output i; those beyond its bits count as set.
inline bool in_mask(uint32_t mask, size_t i) { return i >= 32 || (mask >> i & 1) != 0; }

struct Forward {
  std::span<const Operand> x;
  std::span<const Operand> y;
  std::span<const Operand> saved;  ///< empty slices in inference: nothing is kept, and nothing need be written
  Slice scratch;                   ///< Needs::forward_scratch bytes, of unknown content
};

struct Backward {
  std::span<const Operand> x;  ///< valid where inputs_for_backward says so
  std::span<const Operand> y;  ///< valid where outputs_for_backward says so
  std::span<const Operand> saved;
  std::span<const Operand> dy;  ///< the gradient of every output (zeros where nothing used that output)
  std::span<const Operand> dx;  ///< where to write the gradient of each input; empty where not wanted
  std::span<const uint8_t>
      accumulate;  ///< 1: add to what dx[i] holds; 0: overwrite it, never reading it (it may hold NaN)
  Slice scratch;   ///< Needs::backward_scratch bytes, of unknown content
  bool wants(size_t i) const { return static_cast<bool>(dx[i]); }
  uint32_t accumulates(size_t i) const { return accumulate[i]; }
  /// Bit i: what wants(i) or accumulates(i) says, of the first 32 inputs.
  uint32_t wants_mask() const;
  uint32_t accumulates_mask() const;
};

/// One operation: shapes, and the recording of its forward and backward kernels. Immutable once made, so that
/// one op serves many nodes. It allocates nothing, submits nothing and places no barrier: the recorder orders
/// what overlaps. Parameters are inputs like any other. Padding lanes of NC4HW4 outputs and gradients must be
/// written as zeros.
class Op {
 public:
  Op() = default;
  virtual ~Op() = default;
  Op(const Op&) = delete;
  Op& operator=(const Op&) = delete;

  /// As the file's stem: "leaky_relu".
  virtual std::string_view name() const = 0;
  /// The outputs; needs no device. Throws Error that starts with [name] for inputs that don't fit.
  virtual std::vector<TensorSpec> infer(std::span<const TensorSpec> x) const = 0;
  virtual Needs needs(std::span<const TensorSpec> x, const Caps& caps) const = 0;
  /// Whether input i can receive a gradient.
  virtual bool differentiable(size_t input) const {
    (void)input;
    return true;
  }
  /// Whether forward writes to input i (running averages, optimiser state); it stays bound as an input.
  virtual bool mutates(size_t input) const {
    (void)input;
    return false;
  }
  /// The input whose bytes output 0 may take over, or -1: forward reads an element of it, if at all, before it
  /// writes the same element of the output, and nothing later.
  virtual int in_place() const { return -1; }
  /// Likewise: the input whose gradient may take over the bytes of output 0's gradient where it is not added
  /// to.
  virtual int gradient_in_place() const { return -1; }
  /// Whether record_again makes the (one) output again from inputs and saved tensors for less than it costs to
  /// keep it.
  virtual bool recomputes() const { return false; }

  virtual void record_forward(Recorder& recorder, const Forward& io) const = 0;
  /// Writes the output's bytes once more during backward; has no other effect, and no scratch.
  virtual void record_again(Recorder& recorder, const Forward& io) const { record_forward(recorder, io); }
  /// Called only where some input's gradient is wanted.
  virtual void record_backward(Recorder& recorder, const Backward& io) const = 0;

 protected:
  /// Throws Error "[name] message" unless `condition`.
  void require(bool condition, const std::string& message) const;
};

/// The outputs of an op as they lie in memory. An op's infer() tells shapes, layouts and types; how floats are
/// stored is nothing that it or needs() sees (saved tensors and scratch are float32): NC4HW4 outputs are stored
/// as `activations` says, all others as float32.
std::vector<TensorSpec> infer_stored(const Op& op, std::span<const TensorSpec> x, Storage activations);

/// Bytes of a, rounded up so that what follows is aligned for binding.
inline uint64_t aligned(uint64_t bytes) { return (bytes + 255) / 256 * 256; }

}  // namespace vkopple
