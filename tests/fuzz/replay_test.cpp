#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/guarded_copy.h"
#include "tests/fuzz/quiet.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = 1 << 20;
constexpr std::size_t kCuts = 16;

void replay(const fuzz::Target& target, fuzz::Input input, fuzz::GuardedCopy::Edge edge) {
  const fuzz::GuardedCopy copy(input, edge);
  fuzz::tolerate([&] { target.run(copy.bytes()); });
}

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
    replay(target, bytes, fuzz::GuardedCopy::Edge::kFirst);
    const std::size_t step = 1 + bytes.size() / kCuts;
    for (std::size_t cut = 0; cut < bytes.size(); cut += step)
      replay(target, fuzz::Input(bytes).first(bytes.size() - cut), fuzz::GuardedCopy::Edge::kLast);
  }
}

INSTANTIATE_TEST_SUITE_P(EachParser, FuzzCorpus, testing::ValuesIn(fuzz::targets()),
                         [](const auto& target) { return std::string(target.param.name); });

}  // namespace
}  // namespace vkopple
