#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::run_vkopple;

nlohmann::json bench(std::vector<std::string> more) {
  more.insert(more.begin(), {"bench", "step", "--preset", "tiny", "--batch", "2", "--repeats", "1", "--json"});
  const auto outcome = run_vkopple(more);
  expect_success(outcome);
  return nlohmann::json::parse(outcome.output);
}

TEST(BenchCommand, TellsWhatIsComputedAndWhatTheAuthorsCompute) {
  const auto second = bench({});
  const auto all = bench({"--set", "model.statistics_frames=all", "--set", "model.dropout=[0,0,0]"});
  EXPECT_EQ(all.at("set").size(), 2U);
  EXPECT_EQ(second.at("authors_gflop_per_triplet"), all.at("authors_gflop_per_triplet"));
  EXPECT_LT(second.at("gflop_per_triplet"), all.at("gflop_per_triplet"));
  EXPECT_LT(all.at("gflop_per_triplet"), all.at("authors_gflop_per_triplet"));
}

TEST(BenchCommand, RefusesWhatIsNoKey) {
  expect_failure(run_vkopple({"bench", "step", "--preset", "tiny", "--set", "model.frames=all"}), 1,
                 {"preset tiny with --set: model.frames is no key"});
  expect_failure(run_vkopple({"bench", "step", "--preset", "tiny", "--set", "model"}), 2,
                 {"--set model", "KEY=VALUE"});
}

}  // namespace
}  // namespace vkopple
