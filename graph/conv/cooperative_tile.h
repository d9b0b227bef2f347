#pragma once

#include <cstdint>
#include <vector>

#include "graph/conv/conv_shape.h"
#include "runtime/caps.h"

namespace vkopple {

/// The two kernels of cooperative matrices.
enum class CooperativeUse {
  kProduct,  ///< conv_cooperative.comp: rows are pixels, columns output channels, input channels are summed
  kWeightGradient,  ///< weight_gradient_cooperative.comp: output channels, taps × input channels, pixels
};

/// How a workgroup cuts a product of matrices into tiles of rows × columns: matrices of a subgroup, and
/// subgroups. Powers of 2.
struct CooperativeTile {
  MatrixShape matrix;
  uint32_t rows;     ///< matrices of a subgroup, of m rows each
  uint32_t columns;  ///< and side by side, of n columns each
  uint32_t down;     ///< subgroups across rows
  uint32_t across;   ///< and across columns
  uint32_t depth;    ///< matrices, of k summands each, that lie in shared memory at a time

  uint32_t subgroups() const { return down * across; }
  uint32_t tile_rows() const { return down * rows * matrix.m; }
  uint32_t tile_columns() const { return across * columns * matrix.n; }
  uint32_t slab() const { return depth * matrix.k; }
  /// As the kernel declares it: both halves of the double buffer, a matrix of each subgroup on its way out, and
  /// where the pixels of a product lie.
  uint32_t shared_bytes(CooperativeUse use) const;
  bool operator==(const CooperativeTile&) const = default;
};

/// Whether the kernel is right for the tile, and the device has its matrix, the invocations, the shared memory
/// and, by estimate, the registers.
bool fits(const CooperativeTile& tile, CooperativeUse use, const Caps& caps);
/// Tiles worth a try that fit.
std::vector<CooperativeTile> cooperative_tiles(CooperativeUse use, const Caps& caps);
/// Whether there is any: whether the device can run the kernel, on any shape.
bool can_cooperative(CooperativeUse use, const Caps& caps);
/// Whether the kernel is to be taken where nobody names one. float16: its operands, weights aside, are stored
/// so. Then it is where Caps::kernels says so and, by itself, on GPUs for channels enough to fill matrices;
/// never for operands of float32, which it would round, and never with exact sums.
bool prefers_cooperative(const ConvShape& shape, CooperativeUse use, bool float16, const Caps& caps);

/// What a tile is chosen by.
struct CooperativeWork {
  int64_t rows;
  int64_t columns;
  int64_t summed;
  int64_t repeats;  ///< products of that size: phases, strips
};

/// The tile estimated to be fastest among those that fit. Throws Error where none does.
CooperativeTile choose_cooperative_tile(const CooperativeWork& work, CooperativeUse use, const Caps& caps);

}  // namespace vkopple
