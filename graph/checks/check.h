#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/op.h"

namespace vkopple {

class Device;

/// A tensor of the plain double-precision references: row-major, whatever the op's layout.
struct HostTensor {
  Shape shape;
  std::vector<double> values;

  HostTensor() = default;
  explicit HostTensor(const Shape& s) : shape(s), values(static_cast<size_t>(s.elements()), 0.0) {}
  /// Element by its indices, as many as the rank.
  template <class... Index>
  double& at(Index... index) {
    return values[flat(index...)];
  }
  template <class... Index>
  double at(Index... index) const {
    return values[flat(index...)];
  }

 private:
  template <class... Index>
  size_t flat(Index... index) const {
    const std::array<int64_t, sizeof...(Index)> indices{static_cast<int64_t>(index)...};
    int64_t at = 0;
    for (size_t axis = 0; axis < indices.size(); ++axis) at = at * shape[axis] + indices[axis];
    return static_cast<size_t>(at);
  }
};

using HostTensors = std::vector<HostTensor>;

/// One configuration in which an op is checked.
struct CheckCase {
  std::string label;  ///< shapes and options, for messages
  std::shared_ptr<const Op> op;
  std::vector<TensorSpec> inputs;
  /// The plain reference: outputs, then the new values of mutated inputs in order. Differentiated numerically.
  std::function<HostTensors(const HostTensors& x)> reference;
  /// Inputs are uniform in these ranges, (-1, 1) where there is none.
  std::vector<std::pair<double, double>> ranges = {};
  /// Changes drawn inputs: integers, distributions, distances from a kink. Values are rounded to float
  /// afterwards.
  std::function<void(HostTensors& x)> prepare = {};
  /// Whether a device can run it, for ops forced to one family of kernels; empty: every device.
  std::function<bool(const Caps& caps)> runs_on = {};
};

using CheckList = std::vector<CheckCase>;

/// Relative errors: worst element against the largest magnitude, and L2 against L2.
struct Deviation {
  double worst = 0;
  double l2 = 0;
};

struct CheckResult {
  std::string op;
  std::string label;
  Deviation forward;                  ///< over all outputs, against the reference
  Deviation backward;                 ///< over all inputs, against central differences of the reference
  std::vector<std::string> failures;  ///< empty: passed
  bool passed() const { return failures.empty(); }
};

/// Limits of a check: the worst element scaled by the tensor's largest, and L2.
constexpr double kWorstLimit = 1e-3;
constexpr double kL2Limit = 1e-4;

/// Whether an op has NC4HW4 operands, which mixed precision stores as float16.
bool has_activations(const CheckCase& check);

/// Runs one case: outputs pre-filled with NaN, forward against the reference (and without saved tensors, as in
/// inference), padding lanes zero, gradients against finite differences, then backward again onto existing
/// gradients with the accumulate flag, expecting the sum. All memory lies between bands (GuardedMemory) that
/// must not change. `activations`: how NC4HW4 tensors are stored; inputs are rounded to it before the reference
/// sees them.
CheckResult run_check(const Device& device, const CheckCase& check, Storage activations = Storage::kFloat32);

/// An op and its cases; the build finds graph/checks/<op>.cpp, which defines `void check_<op>(CheckList&)`.
struct OpChecks {
  std::string_view op;
  CheckList cases;
};
std::vector<OpChecks> all_checks();
/// Every op that the build found in graph/ops.
std::vector<std::string_view> all_ops();

}  // namespace vkopple
