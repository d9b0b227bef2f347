#include <fmt/format.h>

#include "graph/executor.h"
#include "runtime/error.h"

namespace vkopple {

NodeProfile Executor::profile_of(const Node& node) const {
  NodeProfile profile{.op = std::string(node.op->name()), .scope = node.scope};
  for (int id : node.inputs) profile.inputs.push_back(graph_->info(id).spec);
  for (int id : node.outputs) profile.outputs.push_back(graph_->info(id).spec);
  return profile;
}

NodeProfile Executor::forward_profile(size_t n) const {
  NodeProfile profile = profile_of(graph_->nodes()[n]);
  profile.flop = plan_.needs[n].forward_flop;
  for (const auto* side : {&profile.inputs, &profile.outputs})
    for (const TensorSpec& spec : *side) profile.bytes += spec.bytes();
  for (const Operand& saved : node_memory_[n].saved) profile.bytes += saved.spec.bytes();
  return profile;
}

NodeProfile Executor::backward_profile(const BackwardStep& step) const {
  const Needs& needs = plan_.needs[step.node];
  NodeProfile profile = profile_of(graph_->nodes()[step.node]);
  profile.flop = needs.backward_flop;
  for (size_t i = 0; i < profile.inputs.size(); ++i) {
    const uint64_t bytes = profile.inputs[i].bytes();
    if (in_mask(needs.inputs_for_backward, i)) profile.bytes += bytes;
    if (step.wants[i] != 0) profile.bytes += step.accumulate[i] != 0 ? 2 * bytes : bytes;
  }
  for (size_t i = 0; i < profile.outputs.size(); ++i)
    profile.bytes += profile.outputs[i].bytes() * (in_mask(needs.outputs_for_backward, i) ? 2 : 1);
  for (const Operand& saved : node_memory_[step.node].saved) profile.bytes += saved.spec.bytes();
  return profile;
}

NodeProfile Executor::section_profile(const BackwardSection& section) const {
  if (!section.again) return backward_profile(plan_.backward.steps[section.index]);
  NodeProfile profile = forward_profile(section.index);
  profile.op += " again";
  return profile;
}

NodeProfile Executor::update_profile(const Node& node) const {
  NodeProfile profile = profile_of(node);
  for (size_t i = 0; i < profile.inputs.size(); ++i)
    profile.bytes += profile.inputs[i].bytes() * (node.op->mutates(i) ? 2 : 1);
  return profile;
}

PassProfile Executor::pass(Pass which) const {
  const auto profile = [](const char* name, const std::unique_ptr<Commands>& commands, const RunTimes& host,
                          auto describe) {
    if (!commands) throw Error(fmt::format("this executor has no {} pass", name));
    PassProfile pass{.name = name, .host = host, .nodes = {}};
    int last = -2;  // no command's section
    for (const CommandTime& time : commands->command_times()) {
      if (time.section >= 0 && time.section != last)
        pass.nodes.push_back(describe(static_cast<size_t>(time.section)));
      else if (time.section < 0)
        pass.nodes.push_back({.op = time.name});
      pass.nodes.back().commands.push_back(time);
      last = time.section;
    }
    return pass;
  };
  switch (which) {
    case Pass::kForward:
      return profile("forward", forward_, forward_ran_, [&](size_t n) { return forward_profile(n); });
    case Pass::kBackward:
      return profile("backward", backward_, backward_ran_,
                     [&](size_t s) { return section_profile(backward_sections_[s]); });
    case Pass::kUpdate:
      break;
  }
  return profile("update", update_, update_ran_,
                 [&](size_t n) { return update_profile(graph_->updates()[n]); });
}

std::vector<PassProfile> Executor::passes() const {
  std::vector<PassProfile> all{pass(Pass::kForward)};
  if (backward_) all.push_back(pass(Pass::kBackward));
  if (update_) all.push_back(pass(Pass::kUpdate));
  return all;
}

}  // namespace vkopple
