// Faults of disks, devices and processes. None may lose a checkpoint that was written before, and a run that is
// resumed after one must leave the same bytes as one that never stopped.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <memory>
#include <numeric>

#include "runtime/vulkan_error.h"
#include "tests/support/expect_error.h"
#include "tests/support/faulty_files.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_run.h"
#include "tests/support/vulkan_faults.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/interrupt.h"
#include "train/resume_point.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::FaultyFiles;
using test::TempFolder;
using test::TinyRun;
using test::VulkanFaults;
using Fault = FaultyFiles::Fault;

constexpr size_t kLargestFile = size_t{64} << 20;
constexpr uint64_t kLeastFaults = 200;
constexpr size_t kMostRuns = 12;
constexpr size_t kMostKills = 100;

std::vector<std::byte> bytes(const std::filesystem::path& path) { return read_file(path, kLargestFile); }

/// Of calls in a row to write one stands for all but the first two and the last: the others do the same.
std::vector<uint64_t> stages(const std::vector<std::string>& calls) {
  const auto is_write = [&](size_t i) { return i < calls.size() && calls[i] == "write"; };
  std::vector<uint64_t> chosen;
  for (size_t i = 0; i < calls.size(); ++i) {
    const bool within =
        i >= 3 && is_write(i - 3) && is_write(i - 2) && is_write(i - 1) && is_write(i) && is_write(i + 1);
    if (!within) chosen.push_back(i);
  }
  return chosen;
}

/// Runs that train take longest: of the places where a fault may strike those are tried that lie evenly between
/// the first and the last.
std::vector<uint64_t> sample(const std::vector<uint64_t>& places, size_t most) {
  std::vector<uint64_t> chosen;
  for (size_t i = 0; i < most && i < places.size(); ++i)
    chosen.push_back(places.size() <= most ? places[i] : places[i * (places.size() - 1) / (most - 1)]);
  return chosen;
}

std::vector<uint64_t> first(uint64_t count) {
  std::vector<uint64_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

class Faults : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    whole_ = std::make_unique<TempFolder>();
    straight_ = TinyRun{.folder = *whole_ / "straight", .keep = 2};
    EXPECT_TRUE(straight_.train());
    expected_ = straight_.remains();
  }
  static void TearDownTestSuite() {
    whole_.reset();
    std::cout << injected_ << " faults were injected\n";
    const testing::TestSuite& suite = *testing::UnitTest::GetInstance()->current_test_suite();
    if (suite.test_to_run_count() == suite.total_test_count()) {
      EXPECT_GE(injected_, kLeastFaults);
    }
  }

  TinyRun fresh() {
    TinyRun run = straight_;
    run.folder = folder_ / std::to_string(next_++);
    return run;
  }
  /// Nothing that was written before is lost, and going on leads to what would have been without the fault.
  /// `shown`: steps that were told of before; each but the last one had its checkpoint by then.
  static void expect_to_go_on(const TinyRun& run, uint64_t shown) {
    const RunFolder folder(run.folder);
    if (shown > 1) {
      ASSERT_TRUE(folder.holds_checkpoint());
      EXPECT_GE(verify_checkpoint(find_resume_point(folder)).step, shown - 1);
    }
    EXPECT_TRUE(run.train());
    const auto remains = run.remains();
    for (const auto& [name, content] : expected_) {
      ASSERT_TRUE(remains.contains(name)) << name;
      EXPECT_TRUE(remains.at(name) == content) << name;
    }
    for (const auto& [name, content] : remains) EXPECT_TRUE(expected_.contains(name)) << name;
  }

  TempFolder folder_;
  int next_ = 0;
  static inline std::unique_ptr<TempFolder> whole_;
  static inline TinyRun straight_;
  static inline std::map<std::string, std::vector<std::byte>> expected_;
  static inline uint64_t injected_ = 0;
};

/// Two checkpoints as files hold them, of which the second is to replace the first in a folder.
class Replacing {
 public:
  Replacing(const TempFolder& folder, const RunFolder& run)
      : folder_(folder), target_(folder / "latest.safetensors"), second_(run.numbered(3)) {
    for (const auto& name : second_.names()) tensors_.emplace(name, second_.read(name));
    before_ = bytes(run.numbered(2));
    FaultyFiles files;
    write(files);
    after_ = bytes(target_);
    calls_ = files.calls();
    EXPECT_NE(before_, after_);
  }

  void put_back() const { write_file(target_, before_); }
  void write(FileSystem& files) const { write_safetensors(target_, second_.metadata(), tensors_, files); }
  /// Names of the calls that it takes.
  const std::vector<std::string>& calls() const { return calls_; }
  /// The second where that was reported, one of both otherwise, whole; and nothing else.
  void expect_whole(bool reported) const {
    const auto now = bytes(target_);
    EXPECT_TRUE(now == after_ || (!reported && now == before_));
    EXPECT_EQ(folder_.entries(), 1U);
  }

 private:
  const TempFolder& folder_;
  std::filesystem::path target_;
  SafetensorsFile second_;
  std::map<std::string, StoredTensor> tensors_;
  std::vector<std::byte> before_, after_;
  std::vector<std::string> calls_;
};

TEST_F(Faults, WhateverCallFailsOneCheckpointIsThere) {
  const Replacing replacing(folder_, RunFolder(straight_.folder));
  for (const int error : {ENOSPC, EIO, EROFS}) {
    const auto& calls = replacing.calls();
    for (const uint64_t at : error == ENOSPC ? first(calls.size()) : stages(calls)) {
      SCOPED_TRACE(testing::Message() << calls[at] << ", call " << at << ", error " << error);
      replacing.put_back();
      FaultyFiles files(Fault::kFails, at, error);
      bool reported = false;
      try {
        replacing.write(files);
        reported = true;
      } catch (const Error& failure) {
        const std::string text = failure.what();
        EXPECT_NE(text.find("latest.safetensors"), std::string::npos) << text;
        EXPECT_NE(text.find("; "), std::string::npos) << "no advice: " << text;
      }
      EXPECT_TRUE(files.hit());
      ++injected_;
      replacing.expect_whole(reported);
    }
  }
}

TEST_F(Faults, AProcessThatIsKilledAtAnyCallLeavesOneCheckpoint) {
  const Replacing replacing(folder_, RunFolder(straight_.folder));
  for (const uint64_t at : sample(first(replacing.calls().size()), kMostKills)) {
    SCOPED_TRACE(testing::Message() << replacing.calls()[at] << ", call " << at);
    replacing.put_back();
    FaultyFiles files(Fault::kKilled, at);
    EXPECT_THROW(replacing.write(files), test::Killed);
    ++injected_;
    RunFolder(folder_.path()).remove_remains();
    replacing.expect_whole(false);
  }
}

TEST_F(Faults, AProcessThatIsReallyKilledDoesTheSame) {
  const Replacing replacing(folder_, RunFolder(straight_.folder));
  for (const uint64_t at : stages(replacing.calls())) {
    SCOPED_TRACE(testing::Message() << replacing.calls()[at] << ", call " << at);
    replacing.put_back();
    const pid_t child = ::fork();  // which touches nothing but files
    ASSERT_GE(child, 0);
    if (child == 0) {
      FaultyFiles files(Fault::kSigkill, at);
      replacing.write(files);
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
    ++injected_;
    RunFolder(folder_.path()).remove_remains();
    replacing.expect_whole(false);
  }
}

TEST_F(Faults, AFullDiskAtAnyStage) {
  FaultyFiles counted;
  ASSERT_TRUE(fresh().train(counted));
  uint64_t failures = 0;
  for (const uint64_t at : sample(stages(counted.calls()), kMostRuns)) {
    SCOPED_TRACE(testing::Message() << counted.calls()[at] << ", call " << at);
    const TinyRun run = fresh();
    FaultyFiles files(Fault::kFull, at);
    uint64_t shown = 0;
    try {
      run.train(files, &shown);
    } catch (const Error& failure) {
      const std::string text = failure.what();
      EXPECT_NE(text.find(run.folder.string()), std::string::npos) << text;
      EXPECT_NE(text.find("free some space"), std::string::npos) << text;
      ++failures;
    }
    ++injected_;
    expect_to_go_on(run, shown);
    std::filesystem::remove_all(run.folder);
  }
  EXPECT_GT(failures, kMostRuns / 2);
}

TEST_F(Faults, KilledAtAnyStage) {
  FaultyFiles counted;
  ASSERT_TRUE(fresh().train(counted));
  for (const uint64_t at : sample(stages(counted.calls()), kMostRuns)) {
    SCOPED_TRACE(testing::Message() << counted.calls()[at] << ", call " << at);
    const TinyRun run = fresh();
    FaultyFiles files(Fault::kKilled, at);
    uint64_t shown = 0;
    EXPECT_THROW(run.train(files, &shown), test::Killed);
    ++injected_;
    expect_to_go_on(run, shown);
    std::filesystem::remove_all(run.folder);
  }
}

TEST_F(Faults, AFileThatMayNotGrow) {
  const TinyRun run = fresh();
  {
    const test::FileSizeLimit limit(4096);
    expect_error([&] { run.train(); }, {"step-000001.safetensors", "File too large", "free some space"});
  }
  ++injected_;
  expect_to_go_on(run, 1);
}

TEST_F(Faults, AFolderThatMayNotBeWritten) {
  TinyRun run = straight_;
  run.folder = "/proc/vkopple";
  expect_error([&] { run.train(); }, {"/proc/vkopple", "cannot be made"});
  ++injected_;
}

TEST_F(Faults, SigtermSavesAndEnds) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const TinyRun run = fresh();
    const Interrupt interrupt;
    uint64_t shown = 0;
    const bool complete = run.train(system_files(), &shown, [&] {
      if (shown == 2) std::raise(signal);
      return interrupt.requested();
    });
    EXPECT_FALSE(complete);
    EXPECT_EQ(verify_checkpoint(RunFolder(run.folder).latest()).step, 2U);
    ++injected_;
    expect_to_go_on(run, shown);
  }
}

TEST_F(Faults, DamagedOrMissingTheLatestGivesWayToTheOneBefore) {
  const auto damage = [](const std::filesystem::path& path) {
    auto content = bytes(path);
    content[content.size() - 9] ^= std::byte{16};
    write_file(path, content);
  };
  const auto cut = [](const std::filesystem::path& path) {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  };
  const auto remove = [](const std::filesystem::path& path) { std::filesystem::remove(path); };
  const auto empty = [](const std::filesystem::path& path) { std::filesystem::resize_file(path, 0); };
  const std::vector<std::function<void(const std::filesystem::path&)>> faults{damage, cut, remove, empty};
  for (size_t i = 0; i < faults.size(); ++i) {
    SCOPED_TRACE(i);
    const TinyRun run = fresh();
    const RunFolder folder(run.folder);
    EXPECT_TRUE(run.train());
    faults[i](folder.latest());
    EXPECT_EQ(find_resume_point(folder), folder.numbered(3));
    faults[(i + 1) % faults.size()](folder.numbered(3));
    EXPECT_EQ(find_resume_point(folder), folder.numbered(2));
    injected_ += 2;
    expect_to_go_on(run, 3);
  }
}

TEST_F(Faults, WhereNoCheckpointIsLeftItIsSaid) {
  const TinyRun run = fresh();
  const RunFolder folder(run.folder);
  EXPECT_TRUE(run.train());
  for (const auto& path : {folder.latest(), folder.numbered(2), folder.numbered(3)})
    write_file(path, "nonsense");
  expect_error([&] { find_resume_point(folder); }, {run.folder.string(), "latest.safetensors", "step-000003",
                                                    "step-000002", "put a copy", "--out"});
  injected_ += 3;
}

TEST_F(Faults, ADeviceThatIsLostAtAnySubmission) {
  const auto expect_lost = [&](const std::string& call) {
    uint64_t calls = 0;
    {
      const TinyRun run = fresh();
      const VulkanFaults counted(call, UINT64_MAX, VK_SUCCESS);
      EXPECT_TRUE(run.train());
      calls = counted.calls();
    }
    EXPECT_GT(calls, 10U) << call;
    for (const uint64_t at : sample(first(calls), kMostRuns)) {
      SCOPED_TRACE(testing::Message() << call << ' ' << at << " of " << calls);
      const TinyRun run = fresh();
      uint64_t shown = 0;
      {
        const VulkanFaults faults(call, at, VK_ERROR_DEVICE_LOST);
        expect_error([&] { run.train(system_files(), &shown); }, {"VK_ERROR_DEVICE_LOST", "run again"});
        EXPECT_TRUE(faults.hit());
      }
      ++injected_;
      expect_to_go_on(run, shown);
      std::filesystem::remove_all(run.folder);
    }
  };
  expect_lost("vkQueueSubmit");
  expect_lost("vkWaitForFences");
}

TEST_F(Faults, NoMemoryAtAnyAllocation) {
  const auto calls_of = [&](const std::string& call) {
    TinyRun run = fresh();
    run.steps = 1;
    const VulkanFaults counted(call, UINT64_MAX, VK_SUCCESS);
    EXPECT_TRUE(run.train());
    return counted.calls();
  };
  const auto strike = [&](const std::string& call, uint64_t at) {
    SCOPED_TRACE(testing::Message() << call << ' ' << at);
    TinyRun run = fresh();
    run.steps = 1;
    const VulkanFaults faults(call, at, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    expect_error([&] { run.train(); }, {call, "VK_ERROR_OUT_OF_DEVICE_MEMORY", "smaller --batch"});
    EXPECT_TRUE(faults.hit());
    EXPECT_FALSE(RunFolder(run.folder).holds_checkpoint());
    ++injected_;
  };
  for (const uint64_t at : first(calls_of("vkAllocateMemory"))) strike("vkAllocateMemory", at);
  for (const std::string call :
       {"vkCreateBuffer", "vkMapMemory", "vkBindBufferMemory", "vkCreateBufferView", "vkCreateDescriptorPool",
        "vkCreateCommandPool", "vkCreateFence", "vkAllocateCommandBuffers"})
    for (const uint64_t at : sample(first(calls_of(call)), 3)) strike(call, at);
  expect_to_go_on(fresh(), 0);
}

/// A process that trains, and gets SIGKILL in the midst of a checkpoint.
class KilledTraining : public testing::TestWithParam<std::pair<const char*, uint64_t>> {};

TEST_P(KilledTraining, GoesOnAsIfItHadNotBeen) {
  constexpr const char* kFolder = "VKOPPLE_TEST_KILLED_TRAINING";  // tells the process where
  GTEST_FLAG_SET(death_test_style, "threadsafe");                  // which begins with this test anew
  std::unique_ptr<TempFolder> folder;
  if (std::getenv(kFolder) == nullptr) {
    folder = std::make_unique<TempFolder>();
    ::setenv(kFolder, folder->path().c_str(), 1);
  }
  const auto die = [&] {
    FaultyFiles files(Fault::kSigkill, GetParam().second, 0, GetParam().first);
    TinyRun{.folder = std::filesystem::path(std::getenv(kFolder)) / "killed", .keep = 2}.train(files);
  };
  EXPECT_EXIT(die(), testing::KilledBySignal(SIGKILL), "");
  ::unsetenv(kFolder);
  const TinyRun killed{.folder = *folder / "killed", .keep = 2};
  const TinyRun straight{.folder = *folder / "straight", .keep = 2};
  ASSERT_TRUE(std::filesystem::exists(killed.folder));
  EXPECT_TRUE(killed.train());
  EXPECT_TRUE(straight.train());
  EXPECT_TRUE(killed.remains() == straight.remains());
}

INSTANTIATE_TEST_SUITE_P(AtEachStage, KilledTraining,
                         testing::Values(std::pair("open", 4), std::pair("write", 300), std::pair("sync", 4),
                                         std::pair("rename", 3), std::pair("unlink", 0)));

}  // namespace
}  // namespace vkopple
