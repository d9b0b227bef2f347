#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/json_io.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::run_vkopple;
using test::TempFolder;

class BenchProfile : public testing::Test {
 protected:
  BenchProfile() {
    write_file(folder_ / "config.json", R"({
        "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4}})");
  }
  test::Outcome bench(const std::string& what, std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"bench", what, "--preset", folder_ / "config.json", "--batch", "1", "--repeats", "1"});
    return run_vkopple(more);
  }

  TempFolder folder_;
};

TEST_F(BenchProfile, TableOfOpsAddsUp) {
  for (const std::string what : {"step", "infer"}) {
    const std::string trace = folder_ / (what + ".json");
    const auto outcome = bench(what, {"--by-op", "--profile", trace, "--json"});
    expect_success(outcome);
    const Json json = parse_json(outcome.output, what);
    EXPECT_GT(json.at("peak_gflops").get<double>(), 0);
    double share = 0, before = 1e9;
    bool convolutions = false;
    for (const Json& row : json.at("ops")) {
      share += row.at("share").get<double>();
      EXPECT_LE(row.at("seconds").get<double>(), before);
      before = row.at("seconds").get<double>();
      if (row.at("op") != "conv2d") continue;
      convolutions = true;
      EXPECT_EQ(row.at("shape").get<std::string>().find("x"), 1U) << row;
      EXPECT_GT(row.at("peak_share").get<double>(), 0);
    }
    EXPECT_NEAR(share, 1, 1e-6);
    EXPECT_TRUE(convolutions);
    EXPECT_FALSE(read_json(trace).at("traceEvents").empty());
  }
}

TEST_F(BenchProfile, CoarseTableHasARowForEachOpAndPass) {
  const auto outcome = bench("step", {"--by-op=op", "--json"});
  expect_success(outcome);
  const Json json = parse_json(outcome.output, "bench");
  EXPECT_EQ(json.at("ops").size(), json.at("by_op").size());
  for (const Json& row : json.at("ops")) EXPECT_EQ(row.at("shape"), "");
}

TEST_F(BenchProfile, WithoutAProfileThereIsNoTable) {
  const auto outcome = bench("step", {"--no-profile", "--json"});
  expect_success(outcome);
  EXPECT_TRUE(parse_json(outcome.output, "bench").at("by_op").empty());
  expect_failure(bench("step", {"--no-profile", "--by-op"}), 2, {"--no-profile"});
  expect_failure(bench("conv", {"--by-op"}), 2, {"--by-op"});
  expect_failure(bench("step", {"--by-op=kernel"}), 2, {"--by-op"});
  expect_failure(bench("step", {"--profile", folder_ / "absent" / "trace.json"}), 1, {"absent"});
}

}  // namespace
}  // namespace vkopple
