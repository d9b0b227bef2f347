#include "graph/ops/match.h"

#include <fmt/format.h>

#include "graph/kernels/words.h"

namespace vkopple {
namespace {

struct MatchPush {
  uint32_t rows;  ///< B · K
  uint32_t code;
  uint32_t identity;
};

struct MatchCodesPush {
  uint32_t words;
  uint32_t code;
  uint32_t identity;
  uint32_t of_a;  ///< 1: the gradient of a's codes, 0: of b's
  uint32_t accumulate;
};

uint32_t slots_of(const Shape& codes) { return u32(codes[1]); }

}  // namespace

std::vector<TensorSpec> Match::infer(std::span<const TensorSpec> x) const {
  require(x.size() == 2 && x[0].layout == Layout::kRowMajor && x[0].dtype == DType::kF32 && x[0] == x[1] &&
              x[0].shape.rank() == 3,
          "takes the codes of two frames, row-major (B, K, C) of equal shapes");
  const Shape& codes = x[0].shape;
  require(identity_ >= 1 && identity_ <= codes[2],
          fmt::format("{} has no identity of {} numbers in its codes", codes.text(), identity_));
  return {row_major({codes[0], codes[1], codes[1]}), row_major({codes[0], codes[1]})};
}

Needs Match::needs(std::span<const TensorSpec> x, const Caps&) const {
  const Shape& codes = x[0].shape;
  return {.backward_scratch = static_cast<uint64_t>(codes[0] * codes[1] * (codes[1] + 1)) * 4,
          .outputs_for_backward = 0};
}

void Match::record_forward(Recorder& recorder, const Forward& io) const {
  const Shape& codes = io.x[0].shape();
  const MatchPush push{u32(codes[0] * codes[1]), u32(codes[2]), u32(identity_)};
  recorder.dispatch_flat("match.forward", push.rows,
                         {io.x[0].slice, io.x[1].slice, io.y[0].slice, io.y[1].slice}, push, {slots_of(codes)});
}

void Match::record_backward(Recorder& recorder, const Backward& io) const {
  const Shape& codes = io.x[0].shape();
  const MatchPush push{u32(codes[0] * codes[1]), u32(codes[2]), u32(identity_)};
  recorder.dispatch_flat("match.scores", push.rows,
                         {io.x[0].slice, io.x[1].slice, io.dy[0].slice, io.dy[1].slice, io.scratch}, push,
                         {slots_of(codes)});
  for (size_t side = 0; side < 2; ++side) {
    if (!io.wants(side)) continue;
    const MatchCodesPush codes_push{words(io.x[0]), u32(codes[2]), u32(identity_), side == 0,
                                    io.accumulates(side)};
    recorder.dispatch_flat("match.codes", codes_push.words,
                           {io.x[0].slice, io.x[1].slice, io.scratch, io.dx[side].slice}, codes_push,
                           {slots_of(codes)});
  }
}

std::vector<Value> match(Value code_a, Value code_b, int64_t identity) {
  return code_a.graph().apply(std::make_shared<Match>(identity), {code_a, code_b});
}

}  // namespace vkopple
