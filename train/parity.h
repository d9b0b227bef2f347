#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "train/stored_tensor.h"

namespace vkopple {

class Device;

/// One tensor of a parity fixture against what this implementation computes.
struct ParityEntry {
  std::string name;                               ///< "grad/depth_model…", as in the file
  double error = 0;                               ///< relative L2
  double noise = 0;                               ///< relative L2 error of PyTorch's own float32
  double limit = 0;                               ///< max(1e-4, 5 · noise)
  bool passed() const { return error <= limit; }  // a NaN fails
};

struct ParityReport {
  std::vector<ParityEntry> entries;              ///< in the file's order
  std::map<std::string, StoredTensor> computed;  ///< by the file's names
  bool passed() const;
  /// The entry nearest to or furthest beyond its limit of each group ("out", "loss", "grad", …).
  std::map<std::string, ParityEntry> worst() const;
};

/// Rebuilds the model from a fixture's metadata, runs forward, backward and, where the fixture has one, the
/// training trajectory, and compares every out/, loss/, grad/, buffer_after/ and trajectory/ tensor
/// (tests/fixtures/README.md). Throws Error for a file that is no fixture, or has tensors that the model does
/// not.
ParityReport check_parity(const Device& device, const std::filesystem::path& fixture);

}  // namespace vkopple
