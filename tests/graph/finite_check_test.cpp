#include "graph/finite_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "graph/state_backup.h"
#include "runtime/transfer.h"
#include "tests/support/test_device.h"

namespace vkopple {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

class FiniteCheckTest : public testing::Test {
 protected:
  Slice tensor(size_t elements) {
    const Slice slice = arena_.allocate(elements * sizeof(float));
    set(slice, std::vector<float>(elements, -3e38F));
    return slice;
  }
  static void set(const Slice& slice, const std::vector<float>& values) {
    upload_values<float>(test_device(), slice, values);
  }
  static std::vector<float> get(const Slice& slice) { return download_values<float>(test_device(), slice); }

  Arena arena_{test_device(), MemoryKind::kDevice, "test"};
};

TEST_F(FiniteCheckTest, FindsOneNumberThatIsNotFiniteAnywhere) {
  const std::vector<Slice> tensors{tensor(4), tensor(1036)};
  const FiniteCheck check(test_device(), tensors);
  EXPECT_TRUE(check.all_finite());
  for (const Slice& slice : tensors) {
    const auto good = get(slice);
    for (const float bad : {kInfinity, -kInfinity, kNone})
      for (const size_t at : {size_t{0}, good.size() / 2, good.size() - 1}) {
        auto values = good;
        values[at] = bad;
        set(slice, values);
        EXPECT_FALSE(check.all_finite()) << bad << " at " << at << " of " << good.size();
        set(slice, good);
        EXPECT_TRUE(check.all_finite());
      }
  }
}

TEST_F(FiniteCheckTest, ABackupTakesBackWhatWasDone) {
  const std::vector<Slice> tensors{tensor(4), tensor(1036)};
  const StateBackup backup(test_device(), tensors);
  const std::vector<std::vector<float>> before{get(tensors[0]), get(tensors[1])};
  backup.keep();
  for (const Slice& slice : tensors) set(slice, std::vector<float>(slice.bytes / sizeof(float), 1));
  backup.restore();
  for (size_t i = 0; i < tensors.size(); ++i) EXPECT_EQ(get(tensors[i]), before[i]);
}

TEST_F(FiniteCheckTest, NothingIsFiniteAndNeedsNoBackup) {
  EXPECT_TRUE(FiniteCheck(test_device(), {}).all_finite());
  const StateBackup backup(test_device(), {});
  backup.keep();
  backup.restore();
}

}  // namespace
}  // namespace vkopple
