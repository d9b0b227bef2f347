#include "train/model_layout.h"

#include <gtest/gtest.h>

namespace vkopple {
namespace {

constexpr const char* kDepth = "depth_model.depth_net.down1.conv.2.num_batches_tracked";
constexpr const char* kEncoder = "segmentation_model.seg_net.seg_net.down1.conv.2.num_batches_tracked";
constexpr const char* kDecoder = "segmentation_model.seg_net.seg_net.up0_att.conv.2.num_batches_tracked";

std::vector<int64_t> calls(StatisticsFrames frames, bool background_only) {
  ModelConfig config;
  config.statistics_frames = frames;
  const ModelLayout layout(config);
  std::vector<int64_t> counts;
  for (const char* name : {kDepth, kEncoder, kDecoder})
    counts.push_back(layout.calls_in_a_step(name, background_only, 2));
  return counts;
}

TEST(ModelLayoutTest, CountsTheCallsOfBatchNorms) {
  EXPECT_EQ(calls(StatisticsFrames::kAll, false), (std::vector<int64_t>{3, 3, 6}));
  EXPECT_EQ(calls(StatisticsFrames::kSecond, false), (std::vector<int64_t>{1, 3, 2}));
  EXPECT_EQ(calls(StatisticsFrames::kAll, true), (std::vector<int64_t>{1, 0, 0}));
}

}  // namespace
}  // namespace vkopple
