#include "tests/support/dry_run.h"

#include <fmt/format.h>

#include "graph/autodiff.h"
#include "runtime/error.h"

namespace vkopple::test {
namespace {

class DryRun {
 public:
  DryRun(Graph& graph, Value loss, const std::vector<std::string>& trained, const Caps& caps,
         const DispatchSink& sink)
      : graph_(graph),
        caps_(caps),
        recorder_(caps, [this, &sink](const Dispatch& dispatch) { sink(*node_, dispatch); }) {
    if (loss) plan_ = plan_backward(graph, loss, trained);
    data_.resize(graph.value_count());
    gradients_.resize(graph.value_count());
    for (int root : plan_.zero_first)
      gradients_[static_cast<size_t>(root)] = place_of(data_, graph.gradient_of(root));
    memory_.resize(graph.nodes().size());
  }

  void run() {
    for (size_t n = 0; n < graph_.nodes().size(); ++n) at(graph_.nodes()[n], [&] { forward(n); });
    for (const BackwardStep& step : plan_.steps) at(graph_.nodes()[step.node], [&] { backward(step); });
    for (const Node& node : graph_.updates())
      at(node, [&] { node.op->record_forward(recorder_, {operands(data_, node.inputs), {}, {}, {}}); });
  }

 private:
  struct Memory {
    Needs needs;
    std::vector<Operand> saved;
  };

  template <class Record>
  void at(const Node& node, Record record) {
    node_ = &node;
    try {
      record();
    } catch (const Error& error) {
      throw Error(fmt::format("{} {}: {}", node.scope, node.op->name(), error.what()));
    }
  }

  /// Nobody looks into the buffer; it is there to tell a slice from none.
  Slice new_place(uint64_t bytes) {
    if (bytes == 0) return {};
    const Slice slice{reinterpret_cast<Buffer*>(buffer_), next_, bytes};
    next_ += (bytes + caps_.offset_alignment - 1) / caps_.offset_alignment * caps_.offset_alignment;
    return slice;
  }

  Slice place_of(std::vector<Slice>& slices, int id) {
    const ValueInfo& info = graph_.info(id);
    Slice& root = slices[static_cast<size_t>(info.root)];
    if (!root) root = new_place(graph_.info(info.root).spec.bytes());
    Slice slice = root.sub(info.offset, info.spec.bytes());
    slice.storage = info.spec.storage;
    return slice;
  }

  Operand operand(std::vector<Slice>& slices, int id) { return {graph_.info(id).spec, place_of(slices, id)}; }

  std::vector<Operand> operands(std::vector<Slice>& slices, const std::vector<int>& ids) {
    std::vector<Operand> all;
    for (int id : ids) all.push_back(operand(slices, id));
    return all;
  }

  void forward(size_t n) {
    const Node& node = graph_.nodes()[n];
    std::vector<TensorSpec> specs;
    for (int id : node.inputs) specs.push_back(stored_as(graph_.info(id).spec, Storage::kFloat32));
    Memory& memory = memory_[n];
    memory.needs = node.op->needs(specs, caps_);
    for (const TensorSpec& spec : memory.needs.saved)
      memory.saved.push_back({spec, plan_.steps.empty() ? Slice{} : new_place(spec.bytes())});
    node.op->record_forward(recorder_, {operands(data_, node.inputs), operands(data_, node.outputs),
                                        memory.saved, new_place(memory.needs.forward_scratch)});
  }

  void backward(const BackwardStep& step) {
    const Node& node = graph_.nodes()[step.node];
    std::vector<Operand> dx;
    for (size_t i = 0; i < node.inputs.size(); ++i)
      dx.push_back(step.wants[i] != 0 ? operand(gradients_, node.inputs[i])
                                      : Operand{graph_.info(node.inputs[i]).spec, {}});
    const Memory& memory = memory_[step.node];
    node.op->record_backward(recorder_, {operands(data_, node.inputs), operands(data_, node.outputs),
                                         memory.saved, operands(gradients_, node.outputs), dx, step.accumulate,
                                         new_place(memory.needs.backward_scratch)});
  }

  Graph& graph_;
  const Caps& caps_;
  const Node* node_ = nullptr;
  Recorder recorder_;
  BackwardPlan plan_;
  std::vector<Slice> data_;  ///< by root value, as gradients_
  std::vector<Slice> gradients_;
  std::vector<Memory> memory_;
  uint64_t next_ = 0;
  alignas(Buffer) std::byte buffer_[sizeof(Buffer)];
};

}  // namespace

void dry_run(Graph& graph, Value loss, const std::vector<std::string>& trained, const Caps& caps,
             const DispatchSink& sink) {
  DryRun(graph, loss, trained, caps, sink).run();
}

}  // namespace vkopple::test
