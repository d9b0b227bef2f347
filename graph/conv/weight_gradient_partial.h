#pragma once

#include <cstdint>

#include "graph/conv/conv_shape.h"
#include "graph/conv/conv_tuning.h"
#include "graph/conv/cooperative_tile.h"
#include "graph/tensor.h"
#include "runtime/recorder.h"

namespace vkopple {

/// What the first stage of a weight gradient leaves for the second: the sums of each strip of gradient pixels,
/// [strip][channel][tap][lane] vec4, channels padded to a multiple of 4. Lanes are vectors of 4 ci and channels
/// are co, or the other way round.
struct WeightGradientPartial {
  int64_t strips = 1;
  bool lanes_are_out = false;
  bool flipped = false;     ///< taps run backwards
  bool many_lanes = false;  ///< the second stage takes a tap an invocation; neither of the above
};

/// Vectors that one strip leaves, whichever way round.
inline int64_t strip_vectors(const ConvShape& s) {
  return 4 * blocks4(s.co) * blocks4(s.ci) * s.kernel * s.kernel;
}

/// The first stage of the simple kernel and how it cuts the sum.
struct SimplePlan {
  uint32_t lanes;  ///< invocations of a workgroup
  int64_t strip_pixels;
  WeightGradientPartial partial;
};
SimplePlan plan_simple(const ConvShape& shape);
void record_simple(Recorder& recorder, const ConvShape& shape, const SimplePlan& plan, const Slice& x,
                   const Slice& dy, const Slice& partial);

/// The first stage of the register kernel: how it cuts the sum, and the tile that one lane holds.
struct RegisterPlan {
  ConvShape shape;  ///< as the kernel sees it
  bool swapped;     ///< x and dy change places (stride 1)
  uint32_t lanes;   ///< of a subgroup that share their pixels and differ in channels of dy
  uint32_t channels;
  uint32_t pixels;
  bool window;  ///< one stretch of x serves all taps of a row
  int64_t image_blocks;
  int64_t strip_blocks;
  WeightGradientPartial partial;
};
bool can_register(const ConvShape& shape, const Caps& caps);
RegisterPlan plan_register(const ConvShape& shape, const Caps& caps);
void record_register(Recorder& recorder, const RegisterPlan& plan, const Slice& x, const Slice& dy,
                     const Slice& partial);

/// How many pixels a strip of the following two kernels has, a multiple of `slab`: few enough to fill a large
/// GPU where a strip takes `groups` workgroups, and to keep the sums accurate.
int64_t strip_of(int64_t pixels, int64_t groups, int64_t slab);

/// Their push constants, as both shaders have them.
struct StripPush {
  int32_t n, ci4, h, w, co4, ho, wo, kernel, stride, padding, dilation, strip_pixels;
  int32_t step_rows, step_columns, step_images;

  StripPush(const ConvShape& shape, int64_t pixels, int64_t slab);
};

/// The first stage of the shared-memory kernel, and how it cuts the sum.
struct SharedPlan {
  SharedGradientTile tile;
  int64_t row_groups = 1;
  int64_t column_groups = 1;
  int64_t strip_pixels;
  WeightGradientPartial partial;
};
bool can_shared(const Caps& caps);
ConvTuning shared_tuning(const ConvShape& shape, const Caps& caps, ConvStorage storage);
SharedPlan plan_shared(const ConvShape& shape, const Caps& caps, ConvStorage storage);
void record_shared(Recorder& recorder, const ConvShape& shape, const SharedPlan& plan, const Slice& x,
                   const Slice& dy, const Slice& partial);

/// The first stage of the kernel of cooperative matrices, and how it cuts the sum.
struct CooperativePlan {
  CooperativeTile tile;
  int64_t row_groups = 1;
  int64_t column_groups = 1;
  int64_t strip_pixels;
  WeightGradientPartial partial;
};
CooperativePlan plan_cooperative(const ConvShape& shape, const Caps& caps, ConvStorage storage);
void record_cooperative(Recorder& recorder, const ConvShape& shape, const CooperativePlan& plan, const Slice& x,
                        const Slice& dy, const Slice& partial);

}  // namespace vkopple
