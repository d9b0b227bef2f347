#include "tests/soak/soak.h"

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "runtime/buffer.h"
#include "runtime/recorder.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"

namespace vkopple::test {
namespace {

/// AddressSanitizer holds back what was given back, to see who uses it still: a process's memory says nothing
/// then.
#if defined(__SANITIZE_ADDRESS__)
constexpr uint64_t kResidentSlack = uint64_t{1} << 40;
#else
constexpr uint64_t kResidentSlack = uint64_t{4} << 20;
#endif

/// The short one; tools/soak runs longer ones.
TEST(Soak, NothingGrows) {
  const TempFolder folder;
  const VulkanObjects before = VulkanObjects::now();
  const auto phases = soak(test_device(), {.folder = folder / "soak",
                                           .steps = 4 * kSoakRound,
                                           .all_networks = false,
                                           .inferences = 2 * kSoakRound});
  ASSERT_EQ(phases.size(), 3U);
  for (const SoakPhase& phase : phases)
    for (const std::string& line : growth(phase, kResidentSlack)) ADD_FAILURE() << line;
  // What the device itself keeps is pipelines and what it copies with; the rest went with its owners.
  const VulkanObjects after = VulkanObjects::now();
  for (const char* kind : {"descriptor sets", "descriptor pools", "query pools"}) {
    const auto count = [&](const VulkanObjects& objects) {
      const auto found = objects.counts.find(kind);
      return found == objects.counts.end() ? 0 : found->second;
    };
    EXPECT_EQ(count(after), count(before)) << kind;
  }
}

TEST(Soak, SeesWhatGrows) {
  SoakPhase phase{.name = "work", .each = 1, .rounds = {}};
  std::vector<std::unique_ptr<Buffer>> kept;
  std::vector<std::unique_ptr<Commands>> commands;
  const TempFolder folder;
  const auto round = [&] { phase.rounds.push_back(Holdings::now()); };
  round();
  round();
  EXPECT_TRUE(growth(phase, uint64_t{4} << 20).empty()) << growth(phase, uint64_t{4} << 20).front();
  kept.push_back(std::make_unique<Buffer>(test_device(), uint64_t{1} << 20, MemoryKind::kDevice, "test"));
  Recorder recorder(test_device());
  recorder.fill(kept.back()->whole());
  commands.push_back(recorder.finish());
  const std::ofstream file(folder / "open");
  phase.rounds.push_back(Holdings::now());
  phase.rounds.back().resident_bytes += uint64_t{5} << 20;
  std::string all;
  for (const std::string& line : growth(phase, uint64_t{4} << 20)) all += line + "\n";
  for (const char* what : {"work, open files: ", "bytes of device memory",
                           "work, buffers: ", "work, allocations: ", "command buffers", "command pools",
                           "fences", "bytes of resident memory"})
    EXPECT_NE(all.find(what), std::string::npos) << what << " is not in\n" << all;
  EXPECT_FALSE(growth({.name = "none", .each = 1, .rounds = {}}, 0).empty());
}

}  // namespace
}  // namespace vkopple::test
