#include "graph/matmul/linear_shared.h"

namespace vkopple {
namespace {

/// As linear_shared.comp has it.
struct SharedPush {
  uint32_t rows, columns, terms;
  uint32_t a_offset, b_offset, out_offset;
  uint32_t accumulate;
};

/// How an operand lies and is read, as linear_shared.comp has it.
enum Lies : uint32_t { kTermsInside, kTermsOutside, kTermsOutsideInVectors };

Lies outside(bool vectors) { return vectors ? kTermsOutsideInVectors : kTermsOutside; }

/// out (+)= a b as a product of matrices.
struct Matrices {
  SharedPush push;
  Lies a;
  Lies b;
  bool vectors;  ///< of `out`
};

Matrices matrices_of(LinearPart part, const LinearPush& p) {
  const bool whole = p.inputs % 4 == 0;  // rows of weights
  switch (part) {
    case LinearPart::kDx:
      return {{p.rows, p.inputs, p.outputs, p.y_offset, 0, p.x_offset, p.accumulate},
              kTermsInside,
              outside(whole),
              p.vector_inputs()};
    case LinearPart::kDw:
      return {{p.outputs, p.inputs, p.rows, p.y_offset, p.x_offset, 0, p.accumulate},
              outside(p.vector_outputs()),
              outside(p.vector_inputs()),
              whole};
    case LinearPart::kForward:
      break;
  }
  return {{p.rows, p.outputs, p.inputs, p.x_offset, 0, p.y_offset, 0},
          kTermsInside,
          kTermsInside,
          p.vector_outputs()};
}

}  // namespace

void record_linear_shared(Recorder& recorder, LinearPart part, const LinearPush& push,
                          const LinearOperands& operands, const LinearTile& tile) {
  const Matrices m = matrices_of(part, push);
  const bool a4 = m.a == kTermsOutsideInVectors;
  const bool b4 = m.b == kTermsOutsideInVectors;
  recorder.dispatch("linear_shared",
                    {tile.invocations(), tile.rows4, tile.columns4, tile.across, tile.down, tile.depth, m.a,
                     m.b, m.vectors ? 1U : 0U, operands.bias ? 1U : 0U},
                    {a4 ? operands.a : Slice{}, a4 ? Slice{} : operands.a, b4 ? operands.b : Slice{},
                     b4 ? Slice{} : operands.b, operands.bias, operands.out, operands.out},
                    m.push,
                    {(m.push.columns + tile.columns() - 1) / tile.columns(),
                     (m.push.rows + tile.rows() - 1) / tile.rows(), 1});
}

void record_linear_shared(Recorder& recorder, LinearPart part, const LinearPush& push,
                          const LinearOperands& operands) {
  const SharedPush sizes = matrices_of(part, push).push;
  record_linear_shared(recorder, part, push, operands,
                       choose_linear_tile(sizes.rows, sizes.columns, recorder.caps()));
}

}  // namespace vkopple
