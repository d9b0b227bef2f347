#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "graph/conv/conv_product.h"
#include "graph/conv/conv_tuning.h"
#include "graph/graph.h"
#include "runtime/device.h"

namespace vkopple {

/// One product of one convolution that can be tuned.
struct TuningCase {
  ConvShape shape;
  std::optional<ConvDirection> direction;  ///< none: the weight gradient
  ConvStorage storage;
  ConvTuning tuning;
};

/// The products of all convolutions of a graph, forward and backward, each once.
std::vector<TuningCase> tuning_cases(const Graph& graph, const Caps& caps);

/// Which of these seconds to choose, of which the first are those of the standard: the least, but the standard
/// where nothing is 3 % faster. What is no positive number counts as failed.
size_t choose_from_timings(std::span<const double> seconds);

/// Seconds that a case takes with a tile.
using TileTiming = std::function<double(const TuningCase& tuned, const std::vector<uint32_t>& tile)>;

struct TunedCase {
  std::string key;
  std::vector<uint32_t> standard;
  std::vector<uint32_t> chosen;
  double standard_seconds = 0;
  double chosen_seconds = 0;
};

/// Times the standard tile and all candidates.
TunedCase tune(const TuningCase& tuned, const TileTiming& timing);
/// Makes choices say what was found.
void remember(const TunedCase& tuned, TunedChoices& choices);

/// Times tiles on a device, with timestamps where it has them.
class DeviceTiming {
 public:
  /// The device is made with Caps::tuned of its own. Of `repeats` runs the best counts.
  DeviceTiming(DeviceOptions options, int repeats);

  const Device& device() const { return *device_; }
  double operator()(const TuningCase& tuned, const std::vector<uint32_t>& tile);

 private:
  std::shared_ptr<TunedChoices> choices_ = std::make_shared<TunedChoices>();
  std::unique_ptr<Device> device_;
  int repeats_;
};

}  // namespace vkopple
