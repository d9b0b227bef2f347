#include "graph/ops/splat.h"

#include <fmt/format.h>

#include <cmath>

#include "graph/kernels/expect.h"
#include "graph/kernels/words.h"

namespace vkopple {
namespace {

/// As splat.glsl has it.
struct SplatPush {
  uint32_t images;
  uint32_t slots;
  uint32_t width;
  uint32_t height;
  uint32_t cells;        ///< of an image: (W + 1)(H + 1), those whose corners are not all outside
  uint32_t chunks;       ///< of cells, for the prefix sums
  uint32_t chunk_cells;  ///< of a chunk
  float beta;
  uint32_t save;
  uint32_t want_uvd;
  uint32_t want_weight;
  uint32_t accumulate_uvd;
  uint32_t accumulate_weight;

  uint64_t points() const { return static_cast<uint64_t>(images) * slots * width * height; }
  uint64_t targets() const { return static_cast<uint64_t>(images) * width * height; }
};

SplatPush push_of(const Shape& weight, float beta) {
  SplatPush push{.images = u32(weight[0]),
                 .slots = u32(weight[1]),
                 .width = u32(weight[3]),
                 .height = u32(weight[2]),
                 .beta = beta};
  push.cells = (push.width + 1) * (push.height + 1);
  // As many chunks as cells in a chunk make both stages of the prefix sum equally short.
  push.chunk_cells = static_cast<uint32_t>(std::ceil(std::sqrt(push.cells)));
  push.chunks = (push.cells + push.chunk_cells - 1) / push.chunk_cells;
  return push;
}

/// The parts of forward's scratch.
struct Scratch {
  Slice counts;   ///< points in each cell (B, cells)
  Slice sums;     ///< of counts before each chunk (B, chunks)
  Slice starts;   ///< where each cell's list begins, and the end (B, cells + 1)
  Slice places;   ///< (cell, number within it) of each point, pairs (B, S·H·W, 2)
  Slice lists;    ///< points by cell (B, S·H·W)
  Slice records;  ///< (x, y, weight, d) of each point, vec4s (B, S·H·W)
  uint64_t bytes = 0;

  Scratch(const SplatPush& push, const Slice& all) {
    const auto take = [&](uint64_t words_taken) {
      const Slice part = all ? all.sub(bytes, words_taken * 4) : Slice{};
      bytes += aligned(words_taken * 4);
      return part;
    };
    const auto images = static_cast<uint64_t>(push.images);
    counts = take(images * push.cells);
    sums = take(images * push.chunks);
    starts = take(images * (push.cells + 1));
    places = take(push.points() * 2);
    lists = take(push.points());
    records = take(push.points() * 4);
  }
};

}  // namespace

std::vector<TensorSpec> Splat::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 3, "takes three inputs");
  const Shape& s = x[2].shape;
  require(row_floats(x[2], 4), fmt::format("takes row-major weights (B, S, H, W), not {}", s.text()));
  require(row_floats(x[0], s.with(1, 3)) && row_floats(x[1], {s[0], s[1], 3, s[2], s[3]}),
          fmt::format("takes row-major image (B, 3, H, W), points (B, S, 3, H, W) and weights (B, S, H, W), "
                      "not {}, {} and {}",
                      x[0].shape.text(), x[1].shape.text(), s.text()));
  require(beta_ >= 0 && std::isfinite(beta_), fmt::format("beta {} is not a finite number from 0 up", beta_));
  return {row_major(s.with(1, 3)), row_major(s.with(1, 1)), row_major(s.with(1, 1))};
}

Needs Splat::needs(std::span<const TensorSpec> x, const Caps&) const {
  const Shape& s = x[2].shape;
  const SplatPush push = push_of(s, beta_);
  return {.saved = {row_major(s.with(1, 1))},  // the sums of weights by which the means were divided
          .forward_scratch = Scratch(push, {}).bytes,
          .backward_scratch = push.targets() * 48,
          .outputs_for_backward = 0b011};
}

void Splat::record_forward(Recorder& recorder, const Forward& io) const {
  SplatPush push = push_of(io.x[2].shape(), beta_);
  push.save = io.saved[0] ? 1 : 0;
  const Scratch scratch(push, io.scratch);
  const uint64_t chunks = static_cast<uint64_t>(push.images) * push.chunks;
  recorder.fill(scratch.counts);
  recorder.dispatch_flat("splat_count", push.points(),
                         {io.x[1].slice, io.x[2].slice, scratch.counts, scratch.places, scratch.records}, push);
  recorder.dispatch_flat("splat_scan.chunks", chunks, {scratch.counts, scratch.sums}, push);
  recorder.dispatch_flat("splat_scan.images", push.images, {scratch.sums}, push);
  recorder.dispatch_flat("splat_scan.cells", chunks, {scratch.counts, scratch.sums, scratch.starts}, push);
  recorder.dispatch_flat("splat_lists.fill", push.points(), {scratch.places, scratch.starts, scratch.lists},
                         push);
  recorder.dispatch_flat("splat_lists.sort", static_cast<uint64_t>(push.images) * push.cells,
                         {scratch.starts, scratch.lists}, push);
  recorder.dispatch_flat("splat_gather", push.targets(),
                         {scratch.starts, scratch.lists, scratch.records, io.x[0].slice, io.y[0].slice,
                          io.y[1].slice, io.y[2].slice, io.saved[0].slice},
                         push);
}

void Splat::record_backward(Recorder& recorder, const Backward& io) const {
  SplatPush push = push_of(io.x[2].shape(), beta_);
  push.want_uvd = io.wants(1) ? 1 : 0;
  push.want_weight = io.wants(2) ? 1 : 0;
  push.accumulate_uvd = io.accumulates(1);
  push.accumulate_weight = io.accumulates(2);
  recorder.dispatch_flat("splat_backward.targets", push.targets(),
                         {io.saved[0].slice, io.y[0].slice, io.y[1].slice, io.dy[0].slice, io.dy[1].slice,
                          io.dy[2].slice, io.scratch},
                         push);
  recorder.dispatch_flat(
      "splat_backward.points", push.points(),
      {io.x[0].slice, io.x[1].slice, io.x[2].slice, io.scratch, io.dx[1].slice, io.dx[2].slice}, push);
}

std::vector<Value> splat(Value image, Value uvd, Value weight, float beta) {
  return image.graph().apply(std::make_shared<Splat>(beta), {image, uvd, weight});
}

}  // namespace vkopple
