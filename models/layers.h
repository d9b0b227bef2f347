#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "graph/graph.h"
#include "graph/parallel/peers.h"
#include "models/initialise.h"

namespace vkopple {

/// A parameter or running average with what it starts from.
struct InitialTensor {
  Value value;
  std::string name;
  Initial initial;
};

/// How a network's convolutions start.
enum class ConvInitial { kKaimingUniform, kKaimingNormal, kFramework };

/// What the layers of one network share: where its parameters live and how its layers behave. A layer asked for
/// twice under one name gets the same parameters, so that a network can be applied several times.
struct NetworkOptions {
  std::string group;   ///< of the parameters: "depth", "object", "imagination", "motion"
  std::string prefix;  ///< of their names (docs/model.md §11)
  ConvInitial initial = ConvInitial::kKaimingUniform;
  double dropout = 0;
  bool training = false;                     ///< batch statistics and dropout, or running averages and none
  Value random;                              ///< u32 (2): seed and step; needed where dropout acts
  uint64_t max_tensor_bytes = ~uint64_t{0};  ///< larger tensors are avoided by splitting the samples
  Peers* statistics_peers = nullptr;         ///< processes that share batch statistics; null: none do
};

/// The layers that the networks are made of; activations are NC4HW4, kept in line with docs/model.md §2.
class LayerFactory {
 public:
  LayerFactory(Graph& graph, NetworkOptions options) : graph_(&graph), options_(std::move(options)) {}

  Graph& graph() const { return *graph_; }
  const NetworkOptions& options() const { return options_; }
  const std::vector<InitialTensor>& tensors() const { return tensors_; }

  Value parameter(const std::string& name, const Shape& shape, const Initial& initial);

  /// 3×3 (padding = dilation) or 1×1 convolution with bias; `initial` of the weights, the network's own by
  /// default.
  Value conv(Value x, const std::string& name, int64_t channels, int64_t kernel, int64_t stride = 1,
             int64_t dilation = 1, bool bias = true);
  /// 3×3 convolution of [skip, x] with bias. With `inner` samples a run (see add_repeated) the skip is the same
  /// for all runs of x and for all calls with it, and its part is computed once; 0: as many samples as x has.
  Value conv_with_skip(Value skip, Value x, const std::string& name, int64_t channels, int64_t inner);
  /// Transposed convolution, doubling H and W: 2×2 or 3×3.
  Value conv_transpose(Value x, const std::string& name, int64_t channels, int64_t kernel);
  /// The last 3×3 convolution, started with `initial`.
  Value out_conv(Value x, const std::string& name, int64_t channels, const Initial& initial);
  /// The bias starts as the framework's default does, or as given.
  Value linear(Value x, const std::string& name, int64_t outputs, const Initial& weight,
               const std::optional<Initial>& bias = std::nullopt);

  /// dropout(batch_norm(leaky_relu(x))) with the statistics of `groups` runs of samples, each a call of its
  /// own.
  Value act_batch_norm(Value x, const std::string& name, double epsilon, int64_t groups);
  /// Batch norm alone.
  Value batch_norm(Value x, const std::string& name, double epsilon, int64_t groups, double bias = 0);
  /// dropout(layer_norm(leaky_relu(x))).
  Value act_layer_norm(Value x, double epsilon);
  /// dropout(leaky_relu(x)).
  Value act(Value x);
  Value dropout(Value x);

 private:
  Value batch_norm_with(Value x, const std::string& name, double epsilon, int64_t groups, double slope,
                        double dropout, double bias);
  Value state(const std::string& name, int64_t size, double initial);
  Initial conv_initial(const Shape& weight) const;
  uint32_t next_stream() { return stream_++; }
  double active_dropout() const { return options_.training ? options_.dropout : 0; }

  Graph* graph_;
  NetworkOptions options_;
  std::vector<InitialTensor> tensors_;
  std::map<std::string, Value> by_name_;
  std::map<std::pair<std::string, int>, Value> skip_parts_;  ///< by layer and skip
  uint32_t stream_ = 0;
};

constexpr float kSlope = 0.1F;  ///< of every LeakyReLU (docs/model.md §2)

}  // namespace vkopple
