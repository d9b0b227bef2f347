#include "graph/conv/convolution.h"

#include <fmt/format.h>

#include <optional>

#include "graph/conv/weight_gradient.h"
#include "graph/conv/winograd.h"
#include "runtime/error.h"

namespace vkopple {
namespace {

constexpr std::string_view kWinograd2 = "winograd2";
constexpr std::string_view kWinograd4 = "winograd4";

WinogradTile tile_of(ConvAlgorithm algorithm) {
  return algorithm == ConvAlgorithm::kWinograd4 ? WinogradTile::k4 : WinogradTile::k2;
}

/// What a kernel's name says about the algorithm: nothing where it is empty.
std::optional<ConvAlgorithm> forced_algorithm(std::string_view kernel) {
  if (kernel.empty()) return std::nullopt;
  if (kernel == kWinograd2) return ConvAlgorithm::kWinograd2;
  if (kernel == kWinograd4) return ConvAlgorithm::kWinograd4;
  return ConvAlgorithm::kDirect;
}

/// The family of direct kernels that a name says.
std::string_view direct_kernel(std::string_view kernel) {
  return is_conv_kernel(kernel) ? kernel : std::string_view{};
}

/// Cores that costs are compared for. Not those at hand, for the choice decides how sums are rounded, and
/// results shall not depend on how many cores a process may use.
constexpr int64_t kThreads = 2;

/// The algorithm that Caps says, or the one of least cost; cost(tile) is Winograd's in nanoseconds.
template <class Cost>
ConvAlgorithm choose(const ConvShape& shape, const Caps& caps, double direct, const Cost& cost) {
  if (caps.exact_sums || caps.winograd == WinogradUse::kNever) return ConvAlgorithm::kDirect;
  if (caps.winograd != WinogradUse::kWhereFaster) {
    const bool tiles4 = caps.winograd == WinogradUse::kTiles4;
    const ConvAlgorithm forced = tiles4 ? ConvAlgorithm::kWinograd4 : ConvAlgorithm::kWinograd2;
    return can_winograd(shape, tile_of(forced), caps) ? forced : ConvAlgorithm::kDirect;
  }
  const bool registers = caps.kernels == KernelFamily::kAuto || caps.kernels == KernelFamily::kRegisters;
  if (!caps.cpu() || !registers) return ConvAlgorithm::kDirect;
  ConvAlgorithm best = ConvAlgorithm::kDirect;
  for (const ConvAlgorithm algorithm : {ConvAlgorithm::kWinograd2, ConvAlgorithm::kWinograd4}) {
    if (!can_winograd(shape, tile_of(algorithm), caps)) continue;
    const double ns = cost(tile_of(algorithm));
    if (ns >= direct) continue;
    direct = ns;
    best = algorithm;
  }
  return best;
}

void require_can(std::string_view kernel, const ConvShape& shape, const Caps& caps) {
  if (!can_run_convolution(kernel, shape, caps))
    throw Error(
        fmt::format("convolution kernel '{}' can't run a {}x{} convolution of stride {} on {}; leave the "
                    "choice to the device",
                    kernel, shape.kernel, shape.kernel, shape.stride, caps.name));
}

}  // namespace

std::string_view name_of(ConvAlgorithm algorithm) {
  switch (algorithm) {
    case ConvAlgorithm::kWinograd2:
      return kWinograd2;
    case ConvAlgorithm::kWinograd4:
      return kWinograd4;
    case ConvAlgorithm::kDirect:
      break;
  }
  return "direct";
}

bool is_convolution_kernel(std::string_view kernel) {
  return kernel == kWinograd2 || kernel == kWinograd4 || is_conv_kernel(kernel);
}

bool can_run_convolution(std::string_view kernel, const ConvShape& shape, const Caps& caps) {
  const auto forced = forced_algorithm(kernel);
  if (forced && *forced != ConvAlgorithm::kDirect) return can_winograd(shape, tile_of(*forced), caps);
  return can_run_conv_kernel(kernel, caps);
}

ConvAlgorithm choose_convolution(const ConvShape& s, ConvDirection direction, const Caps& caps,
                                 std::string_view kernel) {
  require_can(kernel, s, caps);
  if (const auto forced = forced_algorithm(kernel)) return *forced;
  // 0.31 ns for 8 multiply-adds of one lane each, measured where channels fill the direct kernel's tiles.
  const double direct = s.flop() / 16 * 0.31 / static_cast<double>(kThreads);
  return choose(s, caps, direct,
                [&](WinogradTile tile) { return winograd_product_cost(s, direction, tile, caps, kThreads); });
}

ConvAlgorithm choose_weight_gradient(const ConvShape& s, const Caps& caps, std::string_view kernel) {
  require_can(kernel, s, caps);
  if (const auto forced = forced_algorithm(kernel)) return *forced;
  const double direct = s.flop() / 16 * 0.33 / static_cast<double>(kThreads);
  return choose(s, caps, direct,
                [&](WinogradTile tile) { return winograd_weight_gradient_cost(s, tile, caps, kThreads); });
}

uint64_t convolution_scratch(const ConvShape& shape, ConvDirection direction, const Caps& caps,
                             std::string_view kernel) {
  const ConvAlgorithm algorithm = choose_convolution(shape, direction, caps, kernel);
  if (algorithm == ConvAlgorithm::kDirect) return conv_product_scratch(shape, direction);
  return winograd_product_scratch(shape, direction, tile_of(algorithm), caps);
}

uint64_t convolution_weight_gradient_scratch(const ConvShape& shape, const Caps& caps,
                                             std::string_view kernel) {
  const ConvAlgorithm algorithm = choose_weight_gradient(shape, caps, kernel);
  if (algorithm == ConvAlgorithm::kDirect) return weight_gradient_scratch(shape, caps);
  return winograd_weight_gradient_scratch(shape, tile_of(algorithm), caps);
}

void record_convolution(Recorder& recorder, const ConvShape& shape, ConvDirection direction,
                        const ConvOperands& operands, Slice scratch, std::string_view kernel) {
  const ConvAlgorithm algorithm = choose_convolution(shape, direction, recorder.caps(), kernel);
  if (algorithm == ConvAlgorithm::kDirect)
    record_conv_product(recorder, shape, direction, operands, scratch, direct_kernel(kernel));
  else
    record_winograd_product(recorder, shape, direction, operands, scratch, tile_of(algorithm));
}

void record_convolution_weight_gradient(Recorder& recorder, const ConvShape& shape, Slice x, Slice dy, Slice dw,
                                        uint32_t accumulate, Slice scratch, std::string_view kernel) {
  const ConvAlgorithm algorithm = choose_weight_gradient(shape, recorder.caps(), kernel);
  if (algorithm == ConvAlgorithm::kDirect)
    record_weight_gradient(recorder, shape, x, dy, dw, accumulate, scratch);
  else
    record_winograd_weight_gradient(recorder, shape, x, dy, dw, accumulate, scratch, tile_of(algorithm));
}

}  // namespace vkopple
