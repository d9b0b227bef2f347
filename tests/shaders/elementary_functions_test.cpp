#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace vkopple {
namespace {

namespace fs = std::filesystem;

/// Vulkan lets devices compute these with few digits (shaders/include/precise.glsl); no check of an op on one
/// device shows what another one loses.
TEST(Shaders, CallNoInaccurateBuiltInFunction) {
  const std::regex call(
      R"((^|[^A-Za-z0-9_])(exp|exp2|log|log2|pow|sin|cos|tan|sinh|cosh|tanh|asin|acos|atan)\s*\()");
  size_t lines = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(VKOPPLE_SOURCE_DIR) / "shaders")) {
    if (entry.path().extension() != ".comp" && entry.path().extension() != ".glsl") continue;
    std::ifstream file(entry.path());
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
      ++lines;
      EXPECT_FALSE(std::regex_search(line.substr(0, line.find("//")), call))
          << entry.path().string() << ":" << number << ": " << line;
    }
  }
  EXPECT_GT(lines, 1000U) << "the shaders were not found";
}

}  // namespace
}  // namespace vkopple
