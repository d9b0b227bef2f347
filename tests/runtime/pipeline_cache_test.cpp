#include "runtime/pipeline_cache.h"

#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <fstream>

#include "tests/support/temp_folder.h"

namespace vkopple {
namespace {

class PipelineCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    spdlog::null_logger_mt("vkopple");  // the warnings are expected, hundreds of them
    caps_.uuid.fill(7);
    caps_.driver_version = 3;
    file_ = folder_.path() / "cache.bin";
    save_pipeline_cache(file_, caps_, data_);
  }
  void TearDown() override { spdlog::drop("vkopple"); }

  test::TempFolder folder_;
  std::filesystem::path file_;
  Caps caps_;
  std::vector<std::byte> data_{std::byte{1}, std::byte{2}, std::byte{3}};
};

TEST_F(PipelineCacheTest, ComesBackAsItWasSaved) { EXPECT_EQ(load_pipeline_cache(file_, caps_), data_); }

TEST_F(PipelineCacheTest, AbsentFileIsEmpty) {
  EXPECT_TRUE(load_pipeline_cache(folder_.path() / "none.bin", caps_).empty());
}

TEST_F(PipelineCacheTest, AnotherDeviceOrDriverIsIgnored) {
  Caps other = caps_;
  other.uuid.fill(8);
  EXPECT_TRUE(load_pipeline_cache(file_, other).empty());
  other = caps_;
  other.driver_version = 4;
  EXPECT_TRUE(load_pipeline_cache(file_, other).empty());
}

TEST_F(PipelineCacheTest, EveryFlippedByteIsNoticed) {
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(file_));
  for (std::streamoff at = 0; at < size; ++at) {
    std::fstream file(file_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(at);
    const char before = static_cast<char>(file.get());
    file.seekp(at);
    file.put(static_cast<char>(before ^ 0x55));
    file.close();
    EXPECT_TRUE(load_pipeline_cache(file_, caps_).empty()) << "byte " << at;
    std::fstream again(file_, std::ios::in | std::ios::out | std::ios::binary);
    again.seekp(at);
    again.put(before);
  }
  EXPECT_EQ(load_pipeline_cache(file_, caps_), data_);
}

TEST_F(PipelineCacheTest, TruncatedOrLongerFileIsIgnored) {
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 1);
  EXPECT_TRUE(load_pipeline_cache(file_, caps_).empty());
  std::filesystem::resize_file(file_, 10);
  EXPECT_TRUE(load_pipeline_cache(file_, caps_).empty());
  save_pipeline_cache(file_, caps_, data_);
  std::ofstream(file_, std::ios::app | std::ios::binary) << 'x';
  EXPECT_TRUE(load_pipeline_cache(file_, caps_).empty());
}

TEST_F(PipelineCacheTest, AFolderThatCannotBeWrittenIsNoError) {
  save_pipeline_cache("/dev/null/cache.bin", caps_, data_);
  SUCCEED();
}

}  // namespace
}  // namespace vkopple
