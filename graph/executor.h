#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graph/execution_plan.h"
#include "graph/executor_options.h"
#include "graph/graph.h"
#include "graph/memory_use.h"
#include "graph/profile.h"
#include "runtime/buffer.h"
#include "runtime/recorder.h"

namespace vkopple {

class Device;

/// Device memory of parameter, gradient and state groups by name. Executors that share a store share their
/// groups: the graphs of two training stages, or of training and evaluation.
class GroupStore {
 public:
  explicit GroupStore(const Device& device);
  /// Zeros at first. Throws Error where the group exists with another size.
  Slice get(const std::string& name, uint64_t bytes);
  bool has(const std::string& name) const { return slices_.contains(name); }
  uint64_t allocated_bytes() const { return arena_.allocated_bytes(); }

 private:
  const Device* device_;
  Arena arena_;
  std::map<std::string, Slice> slices_;
};

enum class Pass { kForward, kBackward, kUpdate };

/// Whether a backward pass of several portions is the first of its update.
enum class Portion { kFirst, kLater };

/// Runs a graph on a device: places every tensor, records each pass once, replays it as often as asked.
class Executor {
 public:
  /// The graph must outlive it and gets no further nodes. Throws Error where the device's memory is too small.
  Executor(const Device& device, Graph& graph, ExecutorOptions options = {});
  ~Executor();

  void forward();  ///< all nodes
  /// Gradients of the trained groups, from the last forward. With several portions each pass gives its share of
  /// the mean: the first in place of what the gradients were, the others added to it.
  void backward(Portion portion = Portion::kFirst);
  void update();  ///< the graph's update nodes

  /// Row-major values, converted to the value's layout. For inputs, group members and state. Throws Error on a
  /// wrong count.
  void write(Value value, std::span<const float> values);
  void write_words(Value value, std::span<const uint32_t> values);
  /// Copies from elsewhere in the device's memory, in the value's layout, over the last bytes of a value.
  /// Throws Error where there are more of them than the value has.
  void write_end(Value value, const Slice& from);
  /// Row-major values of an input, a kept value, or a group's member.
  std::vector<float> read(Value value) const;
  std::vector<uint32_t> read_words(Value value) const;
  /// The gradient of a parameter after backward, row-major.
  std::vector<float> read_gradient(Value parameter) const;
  /// Where a value lies. Intermediate values that are not kept share their bytes with others.
  Slice slice(Value value) const;

  /// Runs forward and backward again, an op at a time, and tells of the first that gave a number that is not
  /// finite: "conv2d of depth/down1, op 14 of 210 in forward". Nothing where all were finite. Slow, and changes
  /// what the two change.
  std::optional<std::string> find_not_finite();

  /// The passes that this executor has, each as it ran last (all of them must have run); without nodes unless
  /// profiling.
  std::vector<PassProfile> passes() const;
  /// One of them, which must have run. Throws Error where this executor does not have it.
  PassProfile pass(Pass which) const;
  uint64_t shared_bytes() const { return plan_.shared_bytes(); }  ///< of activations and gradients
  uint64_t total_bytes() const;                                   ///< everything on the device, groups included
  /// Where shared memory is fullest. Less than shared_bytes, as far as stretches could not be laid without
  /// gaps.
  MemoryPeak memory_peak() const { return find_peak(plan_.layout.stretches); }
  double forward_flop() const { return forward_flop_; }
  double backward_flop() const { return backward_flop_; }
  size_t dispatches() const;

 private:
  struct NodeMemory {
    std::vector<Operand> saved;
    Slice forward_scratch;
    Slice backward_scratch;
  };
  /// A section of the backward commands: a step of the plan, or a forward node that runs again.
  struct BackwardSection {
    bool again;
    size_t index;
  };
  void require_memory() const;
  void place_own();
  void place_shared();
  Operand operand(int value) const;
  Operand gradient_operand(int value) const;
  std::vector<Operand> operands(const std::vector<int>& values) const;
  std::vector<Operand> operands_in_backward(const std::vector<int>& values) const;
  /// Told on the host when a node has run, and what it gave. Null: nobody is told.
  using Watcher = std::function<void(const Node& node, size_t number, std::span<const Operand> given)>;
  std::unique_ptr<Commands> recorded_forward(bool profile, const Watcher& watcher);
  std::unique_ptr<Commands> recorded_backward(bool profile, const Watcher& watcher);
  void record_again(Recorder& recorder, size_t n);
  void clear_gradients(Recorder& recorder) const;
  void set_loss_gradient(Recorder& recorder) const;
  std::vector<std::string> gradients_done_after(size_t step) const;
  void record_update(bool profile);
  NodeProfile profile_of(const Node& node) const;
  NodeProfile forward_profile(size_t n) const;
  NodeProfile backward_profile(const BackwardStep& step) const;
  NodeProfile section_profile(const BackwardSection& section) const;
  NodeProfile update_profile(const Node& node) const;
  void require_host_access(Value value, const char* what) const;

  const Device* device_;
  Graph* graph_;
  Value loss_;
  Value loss_scale_;
  std::function<void(const std::string& group)> gradient_done_;
  int portions_;
  std::shared_ptr<GroupStore> groups_;
  std::unique_ptr<Arena> kept_;
  std::vector<std::unique_ptr<Buffer>> blocks_;
  std::vector<Slice> data_;       ///< by root value
  std::vector<Slice> again_;      ///< by root value: where backward computes it again
  std::vector<Slice> gradients_;  ///< by root value
  std::vector<NodeMemory> node_memory_;
  ExecutionPlan plan_;
  std::vector<BackwardSection> backward_sections_;
  std::unique_ptr<Commands> forward_;
  std::unique_ptr<Commands> clear_;  ///< of gradients, where backward does not do so itself
  std::unique_ptr<Commands> backward_;
  std::unique_ptr<Commands> update_;
  RunTimes forward_ran_;
  RunTimes backward_ran_;
  RunTimes update_ran_;
  double forward_flop_ = 0;
  double backward_flop_ = 0;
};

}  // namespace vkopple
