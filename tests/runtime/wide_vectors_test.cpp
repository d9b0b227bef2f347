#include "runtime/wide_vectors.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/variable.h"

namespace vkopple {
namespace {

using test::Variable;

constexpr const char* kWidth = "LP_NATIVE_VECTOR_WIDTH";
constexpr const char* kKernelFolder = "MESA_SHADER_CACHE_DIR";

std::string kernel_folder() {
  const char* folder = std::getenv(kKernelFolder);
  return folder == nullptr ? "" : folder;
}

TEST(WideVectors, EachWidthHasAFolderOfItsOwn) {
  const test::TempFolder folder;
  const Variable kernels(kKernelFolder, folder.path().c_str());
  const Variable width(kWidth, "256");
  separate_vector_widths();
  EXPECT_EQ(kernel_folder(), folder / "vectors-256");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "vectors-256"));
  separate_vector_widths();  // as in a program that this one starts
  EXPECT_EQ(kernel_folder(), folder / "vectors-256");
}

TEST(WideVectors, TheFolderLiesAmongOtherCaches) {
  const test::TempFolder folder;
  const Variable caches("XDG_CACHE_HOME", folder.path().c_str());
  const Variable kernels(kKernelFolder, nullptr);
  const Variable width(kWidth, "512");
  separate_vector_widths();
  EXPECT_EQ(kernel_folder(), folder / "vkopple" / "vectors-512");
}

TEST(WideVectors, NothingIsKeptWhereNoFolderIsKnown) {
  const Variable caches("XDG_CACHE_HOME", nullptr), home("HOME", nullptr), kernels(kKernelFolder, nullptr);
  const Variable kept("MESA_SHADER_CACHE_DISABLE", nullptr);
  const Variable width(kWidth, "512");
  separate_vector_widths();
  EXPECT_EQ(kernel_folder(), "");
  EXPECT_STREQ(std::getenv("MESA_SHADER_CACHE_DISABLE"), "true");
}

TEST(WideVectors, WithoutAWidthTheFolderIsTheDrivers) {
  const test::TempFolder folder;
  const Variable kernels(kKernelFolder, folder.path().c_str());
  const Variable width(kWidth, nullptr);
  separate_vector_widths();
  EXPECT_EQ(kernel_folder(), folder.path());
}

/// Otherwise a folder named after one width has code of the other, as in a process whose first device came too
/// early.
TEST(WideVectors, WhicheverDeviceOfTheTestsComesFirstHasTheWidthThatIsAskedFor) {
  const Caps& first = exact_device().caps();
  EXPECT_EQ(test_device().caps().name, first.name);
  const char* width = std::getenv(kWidth);
  if (first.lavapipe && width != nullptr) {
    EXPECT_NE(first.name.find(std::string(" ") + width + " bits"), std::string::npos) << first.name;
  }
}

/// In the second and third of these, Mesa 25.0.7 crashed or read NaN when all had one folder.
TEST(WideVectors, ProgramsOfDifferentWidthsFollowEachOther) {
  const bool lavapipe = test_device().caps().lavapipe;
  const test::TempFolder folder;
  const Variable kernels(kKernelFolder, folder.path().c_str());
  for (const std::string bits : {"512", "256", "512"}) {
    const Variable width(kWidth, bits.c_str());
    test::expect_success(test::run_vkopple({"gradcheck", "layer_norm"}));
    ASSERT_TRUE(std::filesystem::exists(folder / ("vectors-" + bits)));
    EXPECT_TRUE(!lavapipe || !std::filesystem::is_empty(folder / ("vectors-" + bits)));
  }
  EXPECT_EQ(folder.entries(), 2U) << "something lies outside of the widths' folders";
}

}  // namespace
}  // namespace vkopple
