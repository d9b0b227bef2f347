#include "graph/recompute.h"

#include <gtest/gtest.h>

#include "graph/memory_use.h"
#include "graph/ops/batch_norm.h"
#include "graph/ops/binary.h"
#include "graph/ops/conv2d.h"
#include "graph/ops/image_loss.h"
#include "graph/ops/relayout.h"
#include "runtime/caps.h"

namespace vkopple {
namespace {

class RecomputeTest : public testing::Test {
 protected:
  Value conv(Value x, const std::string& name) {
    return conv2d(x, graph_.parameter("p", name, {4, 4, 3, 3}), Value{}, {.padding = 1});
  }
  Value norm(Value x, const std::string& name) {
    return batch_norm(x, graph_.parameter("p", name + ".gamma", {4}),
                      graph_.parameter("p", name + ".beta", {4}),
                      graph_.state("s", name + ".mean", row_major({4})),
                      graph_.state("s", name + ".var", row_major({4})), Value{}, {});
  }
  Recomputation plan(Value y, uint64_t least_bytes = 0) {
    const Value loss = image_loss(to_row_major(y), graph_.input("target", row_major(y.shape())));
    const BackwardPlan backward = plan_backward(graph_, loss, {"p"});
    std::vector<Needs> needs;
    for (const Node& node : graph_.nodes()) {
      std::vector<TensorSpec> inputs;
      for (int id : node.inputs) inputs.push_back(graph_.info(id).spec);
      needs.push_back(node.op->needs(inputs, Caps{}));
    }
    steps_ = backward.steps;
    return plan_recomputation(graph_, backward, needs, least_bytes);
  }
  /// The backward step of the node that makes `value`.
  int64_t step_of(Value value) const {
    for (size_t s = 0; s < steps_.size(); ++s)
      if (graph_.nodes()[steps_[s].node].outputs[0] == value.id()) return static_cast<int64_t>(s);
    return -1;
  }
  static int64_t first(const Recomputation& plan, Value value) {
    return plan.first[static_cast<size_t>(value.id())];
  }

  Graph graph_;
  Value x_ = graph_.input("x", channels4({1, 4, 8, 8}));
  std::vector<BackwardStep> steps_;
};

// mid = norm(a) is read by no backward step, but the sum is made of it.
TEST_F(RecomputeTest, MakesWhatTheConvolutionReadsAndWhatThatIsMadeOf) {
  const Value before = conv(x_, "before");
  const Value a = conv(before, "a");
  const Value mid = norm(a, "mid");
  const Value sum = add(mid, before);
  const Value b = conv(sum, "b");
  const Recomputation chosen = plan(b);
  EXPECT_EQ(first(chosen, sum), step_of(b));
  EXPECT_EQ(first(chosen, mid), step_of(b));
  EXPECT_EQ(first(chosen, a), -1);
  const auto& nodes = chosen.before[static_cast<size_t>(step_of(b))];
  ASSERT_EQ(nodes.size(), 2U);
  EXPECT_EQ(graph_.nodes()[nodes[0]].op->name(), "batch_norm");
  EXPECT_EQ(graph_.nodes()[nodes[1]].op->name(), "binary");
}

TEST_F(RecomputeTest, KeepsWhatCouldOnlyBeMadeOfWhatIsGone) {
  // Nothing in backward reads a or c: to keep them for the sum would save nothing.
  const Value sum = add(conv(x_, "a"), conv(x_, "c"));
  const Value b = conv(sum, "b");
  EXPECT_EQ(first(plan(b), sum), -1);
}

// Along a chain of sums each would need the one before from the first step of backward on.
TEST_F(RecomputeTest, MakesNoChainsOfSums) {
  std::vector<Value> sums{norm(conv(x_, "in"), "nin")};
  for (const char* name : {"a", "b", "c"})
    sums.push_back(add(norm(conv(sums.back(), name), std::string("n") + name), sums.back()));
  const Recomputation chosen = plan(conv(sums.back(), "out"));
  EXPECT_GE(first(chosen, sums[0]), 0);
  EXPECT_EQ(first(chosen, sums[1]), -1);
  EXPECT_GE(first(chosen, sums[2]), 0);
  EXPECT_EQ(first(chosen, sums[3]), -1);
}

TEST_F(RecomputeTest, LeavesKeptValuesAlone) {
  const Value a = norm(conv(x_, "a"), "na");
  const Value b = norm(conv(a, "b"), "nb");
  graph_.keep("b", b);
  const Value c = norm(conv(b, "c"), "nc");
  const Recomputation chosen = plan(conv(c, "d"));
  EXPECT_GE(first(chosen, a), 0);
  EXPECT_EQ(first(chosen, b), -1);
  EXPECT_GE(first(chosen, c), 0);
}

TEST_F(RecomputeTest, LeavesSmallValuesAlone) {
  const Value a = norm(conv(x_, "a"), "na");
  EXPECT_EQ(first(plan(conv(a, "d"), a.spec().bytes() + 1), a), -1);
}

TEST(MemoryUseTest, FindsTheFullestStep) {
  const std::vector<MemoryUse> uses{{"a", 10, 0, 3}, {"b", 5, 2, 6}, {"c", 20, 4, 4}, {"d", 1, 5, 5}};
  const MemoryPeak peak = find_peak(uses);
  EXPECT_EQ(peak.step, 4);
  EXPECT_EQ(peak.bytes, 25U);
  ASSERT_EQ(peak.held.size(), 2U);
  EXPECT_EQ(peak.held[0].what, "c");
  EXPECT_EQ(find_peak({}).bytes, 0U);
}

}  // namespace
}  // namespace vkopple
