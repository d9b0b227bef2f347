#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/quiet.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 1 << 20;
constexpr std::size_t kCuts = 16;

/// Gives every parser what tests/fuzz/corpus keeps for it, usual input and what once broke it, whole and cut
/// off.
class FuzzCorpus : public testing::TestWithParam<fuzz::Target> {
 private:
  fuzz::Quiet quiet_;
};

TEST_P(FuzzCorpus, IsReadOrRefused) {
  const fuzz::Target& target = GetParam();
  std::vector<fs::path> files;
  for (const auto& entry :
       fs::directory_iterator(fs::path(VKOPPLE_SOURCE_DIR) / "tests/fuzz/corpus" / target.name))
    files.push_back(entry.path());
  ASSERT_FALSE(files.empty()) << "a target needs seeds";
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    const std::vector<std::byte> bytes = read_file(file, kMostBytes);
    SCOPED_TRACE(file.filename().string());
    fuzz::tolerate([&] { target.run(bytes); });
    const std::size_t step = 1 + bytes.size() / kCuts;
    for (std::size_t length = 0; length < bytes.size(); length += step)
      fuzz::tolerate([&] { target.run(fuzz::Input(bytes).first(length)); });
  }
}

INSTANTIATE_TEST_SUITE_P(EachParser, FuzzCorpus, testing::ValuesIn(fuzz::targets()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace vkopple
