#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "graph/ops/conv2d.h"
#include "graph/ops/conv_transpose2d.h"
#include "tests/support/expect_error.h"
#include "tests/support/gpu_caps.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/tuner.h"
#include "train/tuning_file.h"

namespace vkopple {
namespace {

using test::TempFolder;

Caps gpu() {
  Caps caps = test::gpu_caps();
  caps.uuid = {1, 2, 3};
  caps.driver_uuid = {4, 5, 6};
  caps.driver_version = 77;
  return caps;
}

/// Two equal convolutions, another one, and a transposed one.
void build(Graph& graph) {
  const Value x = graph.input("x", channels4({2, 8, 16, 16}));
  const auto weights = [&](const std::string& name, const Shape& shape) {
    return graph.parameter("g", name, shape);
  };
  const Value a = conv2d(x, weights("a", {8, 8, 3, 3}), {}, {.padding = 1});
  const Value b = conv2d(a, weights("b", {8, 8, 3, 3}), {}, {.padding = 1});
  const Value c = conv2d(b, weights("c", {16, 8, 3, 3}), {}, {.stride = 2, .padding = 1});
  conv_transpose2d(c, weights("d", {16, 8, 2, 2}), {});
}

TEST(Tuner, CollectsEveryProductOnce) {
  Graph graph;
  build(graph);
  const auto cases = tuning_cases(graph, gpu());
  EXPECT_EQ(cases.size(), 9U);  // three convolutions, three products each
  Caps plain = gpu();
  plain.kernels = KernelFamily::kPlain;
  EXPECT_TRUE(tuning_cases(graph, plain).empty());
}

TEST(Tuner, TellsMixedPrecisionFromFloat32) {
  Graph graph;
  graph.store_activations(Storage::kFloat16);
  build(graph);
  const auto keys = [&](size_t i) { return tuning_cases(graph, gpu()).at(i).tuning.key; };
  EXPECT_EQ(tuning_cases(graph, gpu()).size(), 12U);  // the first convolution's input stays float32
  EXPECT_THAT(keys(0), testing::HasSubstr("2x8x16x16 float32 to 8x16x16 float16"));
  EXPECT_THAT(keys(3), testing::HasSubstr("2x8x16x16 float16 to 8x16x16 float16"));
}

TEST(Tuner, TakesTheFastestThatIsWorthAChange) {
  const auto choose = [](const std::vector<double>& s) { return choose_from_timings(s); };
  EXPECT_EQ(choose({}), 0U);
  EXPECT_EQ(choose({1}), 0U);
  EXPECT_EQ(choose({1, 0.99, 0.98}), 0U);
  EXPECT_EQ(choose({1, 0.9, 0.8, 0.85}), 2U);
  EXPECT_EQ(choose({1, 2, 3}), 0U);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(choose({1, nan, 0, -1, infinity}), 0U);
  EXPECT_EQ(choose({nan, 5, 4}), 2U);
}

TEST(Tuner, TimesEveryTileAndRemembersWhatDiffers) {
  Graph graph;
  build(graph);
  const auto cases = tuning_cases(graph, gpu());
  const TuningCase& one = cases.front();
  ASSERT_GT(one.tuning.candidates.size(), 3U);
  const auto& fast = one.tuning.candidates[3];
  size_t timed = 0;
  const TunedCase tuned = tune(one, [&](const TuningCase&, const std::vector<uint32_t>& tile) {
    ++timed;
    return tile == fast ? 0.5 : 1.0;
  });
  EXPECT_EQ(timed, 1 + one.tuning.candidates.size());
  EXPECT_EQ(tuned.chosen, fast);
  EXPECT_DOUBLE_EQ(tuned.standard_seconds / tuned.chosen_seconds, 2);
  TunedChoices choices{{"other", {1}}};
  remember(tuned, choices);
  EXPECT_EQ(choices, (TunedChoices{{"other", {1}}, {one.tuning.key, fast}}));
  // Measured again, the standard is as good: the older choice goes.
  remember(tune(one, [](const TuningCase&, const std::vector<uint32_t>&) { return 1.0; }), choices);
  EXPECT_EQ(choices, (TunedChoices{{"other", {1}}}));
}

const std::string kKey =
    "conv_shared.forward 3x3 stride 1 padding 1 dilation 1, 2x8x16x16 float32 to 8x16x16 float32";

TEST(TuningFile, GivesBackWhatWasSaved) {
  const TempFolder folder;
  const auto file = folder / "cache" / "tuning.json";  // makes its folder
  EXPECT_EQ(read_tuned_choices(file, gpu()), nullptr);
  EXPECT_EQ(read_tuned_choices({}, gpu()), nullptr);
  const TunedChoices choices{{kKey, {2, 4, 16, 8, 2}}};
  save_tuned_choices(file, gpu(), choices);
  const auto found = read_tuned_choices(file, gpu());
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(*found, choices);
}

TEST(TuningFile, OfAnotherDeviceOrDriverIsIgnored) {
  const TempFolder folder;
  const auto file = folder / "tuning.json";
  save_tuned_choices(file, gpu(), {{kKey, {2, 4, 16, 8, 2}}});
  Caps other = gpu();
  other.uuid[0] = 9;
  EXPECT_EQ(read_tuned_choices(file, other), nullptr);
  other = gpu();
  other.driver_uuid[0] = 9;
  EXPECT_EQ(read_tuned_choices(file, other), nullptr);
  other = gpu();
  other.driver_version = 78;
  EXPECT_EQ(read_tuned_choices(file, other), nullptr);
}

TEST(TuningFile, UnknownAndIllegalChoicesAreIgnoredOneByOne) {
  const TempFolder folder;
  const auto file = folder / "tuning.json";
  // 256 invocations, no tile at all, an unknown kernel; the last is good.
  save_tuned_choices(file, gpu(),
                     {{kKey, {2, 8, 16, 16, 2}},
                      {kKey + "a", {}},
                      {"magic 3x3", {2, 4, 16, 8, 2}},
                      {kKey + "z", {2, 4, 16, 8, 2}}});
  const auto found = read_tuned_choices(file, gpu());
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(*found, (TunedChoices{{kKey + "z", {2, 4, 16, 8, 2}}}));
}

TEST(TuningFile, SurvivesWhateverLiesThere) {
  const TempFolder folder;
  const auto file = folder / "tuning.json";
  save_tuned_choices(file, gpu(), {{kKey, {2, 4, 16, 8, 2}}});
  const std::string good = read_text_file(file, 1 << 20);
  for (size_t length = 0; length + 1 < good.size(); length += 9) {
    write_file(file, good.substr(0, length));
    EXPECT_EQ(read_tuned_choices(file, gpu()), nullptr) << length;
  }
  for (const char* numbers : {"[-1, 4, 16, 8, 2]", "[1e99, 4, 16, 8, 2]", "[2.5, 4, 16, 8, 2]", "\"2\"", "null",
                              "[99999999999999999999, 4, 16, 8, 2]", "[[2], 4, 16, 8, 2]"}) {
    nlohmann::json json = nlohmann::json::parse(good);
    json["choices"][kKey] = nlohmann::json::parse(numbers);
    write_file(file, json.dump());
    EXPECT_EQ(read_tuned_choices(file, gpu()), nullptr) << numbers;
  }
  for (const char* text :
       {"[]", "{}", "{\"format\": 2}", "\xff\xfe", "{\"format\":1,\"made_for\":{},\"choices\":[]}"}) {
    write_file(file, text);
    EXPECT_EQ(read_tuned_choices(file, gpu()), nullptr) << text;
  }
  EXPECT_EQ(read_tuned_choices(folder.path(), gpu()), nullptr);  // a folder
}

TEST(TuningFile, SaysWhereItCannotBeWritten) {
  const TempFolder folder;
  write_file(folder / "file", "");
  test::expect_error([&] { save_tuned_choices(folder / "file" / "tuning.json", gpu(), {}); }, {"tuning.json"});
}

}  // namespace
}  // namespace vkopple
