#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/op.h"
#include "graph/tensor.h"

namespace vkopple {

class Graph;

/// Handle to a tensor of a graph; cheap to copy. Valid as long as the graph.
class Value {
 public:
  Value() = default;
  Value(Graph& graph, int id) : graph_(&graph), id_(id) {}
  Graph& graph() const { return *graph_; }
  int id() const { return id_; }
  /// Valid as long as the graph, whatever is added to it.
  const TensorSpec& spec() const;
  const Shape& shape() const { return spec().shape; }
  explicit operator bool() const { return graph_ != nullptr; }

 private:
  Graph* graph_ = nullptr;
  int id_ = -1;
};

enum class Role {
  kIntermediate,  ///< shares memory by lifetime
  kInput,         ///< written by the host, kept
  kParameter,     ///< a group of learnt tensors, kept
  kState,         ///< running averages, random counters, optimiser state: kept, written by ops
  kGradient,      ///< the gradient of a parameter group, kept
};

/// A tensor of the graph. A view shares the bytes of its root, from `offset` on; a root's root is itself.
struct ValueInfo {
  TensorSpec spec;
  int root = -1;
  uint64_t offset = 0;  ///< bytes into the root
  Role role = Role::kIntermediate;
  std::string name;   ///< of inputs, groups and kept outputs
  bool kept = false;  ///< the host reads it: alive to the end
};

struct Node {
  std::shared_ptr<const Op> op;
  std::vector<int> inputs;
  std::vector<int> outputs;
  std::string scope;  ///< where it belongs, for messages and benchmarks: "depth/down1"
};

/// A named tensor inside a group of parameters or state.
struct GroupMember {
  std::string name;
  int value;
};

/// The computation: built once for a configuration, then given to an Executor. Holds no device memory.
/// Parameters and state live in groups, each one contiguous flat tensor whose members are views of it, so that
/// the optimiser takes a group in one step. Groups are open until the first executor is made.
class Graph {
 public:
  Graph() = default;
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  /// How the NC4HW4 outputs of nodes added from now on are stored: network activations, and their gradients
  /// with them. Inputs and everything row-major stay float32.
  void store_activations(Storage storage) { activations_ = storage; }

  Value input(const std::string& name, const TensorSpec& spec);
  /// A learnt tensor, row-major. Throws Error for a name that exists.
  Value parameter(const std::string& group, const std::string& name, const Shape& shape);
  /// A tensor that ops update in place.
  Value state(const std::string& group, const std::string& name, const TensorSpec& spec);
  /// The flat tensor of all of a group's members.
  Value group(const std::string& group);
  /// The gradient of a whole parameter group, for update ops.
  Value gradient(const std::string& group);

  /// Adds a node. Throws Error where the op refuses the inputs.
  std::vector<Value> apply(std::shared_ptr<const Op> op, const std::vector<Value>& inputs);
  /// The same for ops of one output.
  Value apply1(std::shared_ptr<const Op> op, const std::vector<Value>& inputs) {
    return apply(std::move(op), inputs).at(0);
  }
  /// Adds a node that runs after backward (Adam).
  void update(std::shared_ptr<const Op> op, const std::vector<Value>& inputs);

  /// The same bytes with another shape of as many bytes.
  Value reshape(Value value, const TensorSpec& spec);
  /// `count` entries of the outermost axis from `begin` on, without copying. Only where can_slice_outer.
  Value slice_outer(Value value, int64_t begin, int64_t count);
  /// Whether entry `begin` of the outermost axis starts where it can be bound.
  bool can_slice_outer(Value value, int64_t begin) const;
  /// Keeps a value for the host under a name.
  void keep(const std::string& name, Value value);

  /// Valid as long as the graph.
  const ValueInfo& info(int id) const { return values_.at(static_cast<size_t>(id)); }
  size_t value_count() const { return values_.size(); }
  const std::vector<Node>& nodes() const { return nodes_; }
  const std::vector<Node>& updates() const { return updates_; }
  const std::map<std::string, int>& kept() const { return kept_; }
  const std::map<std::string, int>& inputs() const { return inputs_; }
  /// Members of every parameter group, or every state group, in order of declaration.
  const std::map<std::string, std::vector<GroupMember>>& parameters() const { return parameters_; }
  const std::map<std::string, std::vector<GroupMember>>& states() const { return states_; }
  /// A member or input by name. Throws Error.
  Value find(const std::string& name);
  /// Gradient group root of a parameter group root, or -1.
  int gradient_of(int root) const;

  /// Prefix of the scopes of nodes added from now on; returns the one before.
  std::string set_scope(std::string scope) { return std::exchange(scope_, std::move(scope)); }
  const std::string& scope() const { return scope_; }

 private:
  int add_value(ValueInfo info);
  Value add_member(std::map<std::string, std::vector<GroupMember>>& groups, Role role, const std::string& group,
                   const std::string& name, const TensorSpec& spec);
  Value view(Value value, const TensorSpec& spec, uint64_t offset);

  std::deque<ValueInfo> values_;  ///< references to it stay valid while values are added
  std::vector<Node> nodes_;
  std::vector<Node> updates_;
  std::map<std::string, int> inputs_;
  std::map<std::string, int> kept_;
  std::map<std::string, int> roots_;    ///< group name → its flat value
  std::map<std::string, int> members_;  ///< member name → value
  std::map<int, int> gradients_;        ///< parameter group root → gradient root
  std::map<std::string, std::vector<GroupMember>> parameters_;
  std::map<std::string, std::vector<GroupMember>> states_;
  std::string scope_;
  Storage activations_ = Storage::kFloat32;
};

/// Sets a graph's scope for a block of code, below the current one.
class Scope {
 public:
  Scope(Graph& graph, const std::string& name);
  ~Scope() { graph_->set_scope(before_); }
  Scope(const Scope&) = delete;
  Scope& operator=(const Scope&) = delete;

 private:
  Graph* graph_;
  std::string before_;
};

}  // namespace vkopple
