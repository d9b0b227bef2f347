#pragma once

#include <cstdint>
#include <optional>

#include "graph/conv/conv_shape.h"
#include "graph/conv/conv_tuning.h"
#include "graph/tensor.h"
#include "runtime/recorder.h"

namespace vkopple {

/// The kernels that compute a weight gradient.
enum class WeightGradientKernel {
  kAuto,    ///< as Caps::kernels and the storage of x and dy say, by itself the fastest that the device can run
  kSimple,  ///< every shape, every device: pixels over a workgroup's invocations, summed in shared memory
  kShared,  ///< every shape, GPUs: a product of matrices through shared memory
  kCooperative,  ///< every shape, GPUs that can: subgroups multiply matrices of float16, adding in float32
  kRegister,     ///< kernels up to 3x3 on CPU devices: sums in registers, operands handed round a subgroup
};

/// Whether the device can run a kernel on this shape.
bool can_weight_gradient(const ConvShape& shape, const Caps& caps, WeightGradientKernel kernel);

/// Bytes that record_weight_gradient() needs, however x and dy are stored.
uint64_t weight_gradient_scratch(const ConvShape& shape, const Caps& caps,
                                 WeightGradientKernel kernel = WeightGradientKernel::kAuto);

/// What can be tuned, where the kernel that runs has tiles to choose.
std::optional<ConvTuning> weight_gradient_tuning(const ConvShape& shape, const Caps& caps,
                                                 ConvStorage storage = {});

/// dw[co][ci][ky][kx] (+)= Σ n,yo,xo dy[n,co,yo,xo] · x[n, ci, yo·stride + ky·dilation − padding, …], x zero
/// outside. x and dy NC4HW4 with zeros in their padding lanes, dw row-major (co, ci, kernel, kernel).
/// accumulate: 1 adds to dw, 0 overwrites it without reading. Sums run in a fixed order. A transposed
/// convolution's gradient is the same with its large dy as `x` and its small x as `dy`. Throws Error for a
/// kernel that can't.
void record_weight_gradient(Recorder& recorder, const ConvShape& shape, Slice x, Slice dy, Slice dw,
                            uint32_t accumulate, Slice scratch,
                            WeightGradientKernel kernel = WeightGradientKernel::kAuto);

/// Bytes that record_bias_gradient() needs; dy is NC4HW4 (n, co, h, w).
uint64_t bias_gradient_scratch(const TensorSpec& dy, const Caps& caps);

/// db[co] (+)= Σ n,y,x dy[n,co,y,x].
void record_bias_gradient(Recorder& recorder, const TensorSpec& dy_spec, Slice dy, Slice db,
                          uint32_t accumulate, Slice scratch);

}  // namespace vkopple
