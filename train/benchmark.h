#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "graph/memory_use.h"
#include "graph/profile.h"
#include "models/config.h"

namespace vkopple {

class Device;

struct BenchmarkOptions {
  int64_t batch = 4;
  bool profile = true;  ///< times every op too, in runs of their own; false: passes and by_op stay empty
  int repeats = 5;      ///< timed runs, after one that builds pipelines and one that warms up
  std::filesystem::path trace;  ///< writes a step as a trace (train/trace.h); empty: none
  std::string stage;            ///< of training, by name; empty: the last one, which trains everything
};

/// Figures of one benchmark; seconds are wall-clock medians.
struct BenchmarkResult {
  double seconds_per_step = 0;
  double triplets_per_second = 0;  ///< images a second for inference
  double gflop_per_triplet =
      0;  ///< of convolutions and products, forward and backward as far as run; an image for inference
  double authors_gflop_per_triplet =
      0;  ///< the same of the graph that the authors run (models/authors_cost.h); 0 where only a part is timed
  uint64_t peak_device_bytes = 0;
  /// The process's largest memory during the steps less what it had before the model was built, in bytes; 0
  /// where the system does not tell. Of a CPU device it is all of a step; a GPU's memory is not in it.
  uint64_t resident_growth_bytes = 0;
  double first_step_seconds = 0;  ///< building the graph and its pipelines, and the first run
  size_t dispatches = 0;
  std::vector<PassProfile> passes;      ///< one step, op by op
  std::map<std::string, double> by_op;  ///< seconds of device time by op and pass, as "conv2d.backward"
};

/// Where the device memory of a training step goes.
struct StepMemory {
  uint64_t groups_bytes = 0;  ///< parameters, gradients, optimiser and running averages, inputs and outputs
  uint64_t shared_bytes = 0;  ///< activations, their gradients and scratch
  MemoryPeak peak;            ///< of what is shared
};
/// Builds the step and runs nothing.
StepMemory measure_memory(const Device& device, const Config& config, const BenchmarkOptions& options);
/// A training step on made-up images: forward, backward and update.
BenchmarkResult benchmark_step(const Device& device, const Config& config, const BenchmarkOptions& options);
/// Depth, masks and locations of single images. Both run in the precision of config.training.
BenchmarkResult benchmark_inference(const Device& device, const Config& config,
                                    const BenchmarkOptions& options);

}  // namespace vkopple
