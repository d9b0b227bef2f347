#include "runtime/device_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/error.h"

namespace vkopple {
namespace {

Candidate candidate(const std::string& name, DeviceType type, std::vector<std::string> missing = {}) {
  Candidate c;
  c.caps.name = name;
  c.caps.type = type;
  c.caps.uuid.fill(static_cast<uint8_t>(name.size()));
  c.missing = std::move(missing);
  return c;
}

const std::vector<Candidate> kThree{candidate("llvmpipe", DeviceType::kCpu),
                                    candidate("Radeon Graphics", DeviceType::kIntegrated),
                                    candidate("GeForce RTX", DeviceType::kDiscrete)};

std::string message_of(std::span<const Candidate> candidates, const std::string& selector) {
  try {
    choose_device(candidates, selector);
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(DeviceChoiceTest, AutoPrefersDiscreteThenIntegratedThenCpu) {
  EXPECT_EQ(choose_device(kThree, "auto"), 2U);
  EXPECT_EQ(choose_device(std::span(kThree).first(2), "auto"), 1U);
  EXPECT_EQ(choose_device(std::span(kThree).first(1), ""), 0U);
}

TEST(DeviceChoiceTest, SelectsByTypeIndexNameAndUuid) {
  EXPECT_EQ(choose_device(kThree, "cpu"), 0U);
  EXPECT_EQ(choose_device(kThree, "1"), 1U);
  EXPECT_EQ(choose_device(kThree, "radeon"), 1U);
  EXPECT_EQ(choose_device(kThree, uuid_text(kThree[2].caps.uuid)), 2U);
}

TEST(DeviceChoiceTest, AutoPassesOverWhatCannotBeUsed) {
  const std::vector<Candidate> two{candidate("old", DeviceType::kDiscrete, {"Vulkan 1.1"}),
                                   candidate("llvmpipe", DeviceType::kCpu)};
  EXPECT_EQ(choose_device(two, "auto"), 1U);
  EXPECT_THAT(message_of(two, "old"), testing::HasSubstr("Vulkan 1.1"));
  EXPECT_THAT(message_of(two, "0"), testing::HasSubstr("Vulkan 1.1"));
}

TEST(DeviceChoiceTest, SaysWhyThereIsNone) {
  EXPECT_THAT(message_of({}, "auto"), testing::HasSubstr("mesa-vulkan-drivers"));
  const std::vector<Candidate> none{candidate("old", DeviceType::kDiscrete, {"a compute queue"})};
  EXPECT_THAT(message_of(none, "auto"),
              testing::AllOf(testing::HasSubstr("old"), testing::HasSubstr("a compute queue")));
}

TEST(DeviceChoiceTest, TexelReadsNeedLongBuffersAndSubgroupsOf64BitIntegers) {
  Caps caps;
  caps.name = "made up";
  caps.int64 = caps.subgroup_shuffle = true;
  caps.max_texel_elements = uint64_t{1} << 26;
  EXPECT_EQ(missing_for(AccessPath::kTexel, caps), "");
  caps.max_texel_elements = 65536;
  EXPECT_THAT(missing_for(AccessPath::kTexel, caps), testing::HasSubstr("made up"));
  caps.max_texel_elements = uint64_t{1} << 27;
  caps.int64 = false;
  EXPECT_THAT(missing_for(AccessPath::kTexel, caps), testing::HasSubstr("64-bit integers"));
  EXPECT_EQ(missing_for(AccessPath::kStorage, Caps{}), "");
}

TEST(DeviceChoiceTest, UnknownSelectorsAreWrongUse) {
  EXPECT_THROW(choose_device(kThree, "7"), UsageError);
  EXPECT_THROW(choose_device(kThree, "arc"), UsageError);
  EXPECT_THROW(choose_device(kThree, "-1"), UsageError);
}

}  // namespace
}  // namespace vkopple
