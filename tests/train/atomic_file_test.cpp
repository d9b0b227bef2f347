#include "train/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/support/expect_error.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/temp_folder.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::FileSizeLimit;
using test::TempFolder;

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const TempFolder folder;
  const auto path = folder / "a.txt";
  {
    AtomicFile file(path);
    file.write("one ");
    EXPECT_FALSE(std::filesystem::exists(path));
    file.write("two");
    file.commit();
  }
  EXPECT_EQ(read_text_file(path, 100), "one two");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, LeavesTheOldFileWhenAbandoned) {
  const TempFolder folder;
  write_file(folder / "a.txt", "old");
  {
    AtomicFile file(folder / "a.txt");
    file.write("new");
  }
  EXPECT_EQ(read_text_file(folder / "a.txt", 100), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, ReplacesAndFollowsLinks) {
  const TempFolder folder;
  write_file(folder / "a.txt", "old");
  std::filesystem::create_symlink("a.txt", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(read_text_file(folder / "a.txt", 100), "new");
}

TEST(AtomicFile, TwoAtOnceForOneName) {
  const TempFolder folder;
  AtomicFile first(folder / "a"), second(folder / "a");
  first.write("first");
  second.write("second");
  first.commit();
  second.commit();
  EXPECT_EQ(read_text_file(folder / "a", 100), "second");
  EXPECT_EQ(folder.entries(), 1u);
  expect_error([&] { second.commit(); }, {"already written"});
}

TEST(AtomicFile, FullDiskNamesPathAndLeavesNothing) {
  const TempFolder folder;
  const std::string large(1 << 16, 'x');
  const FileSizeLimit limit(1000);
  expect_error([&] { write_file(folder / "big.bin", large); },
               {"big.bin", "File too large", "free some space"});
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(AtomicFile, RefusesWhatIsNoFile) {
  const TempFolder folder;
  expect_error([&] { write_file(folder / "no/such/a", "x"); },
               {"no/such/a", "No such file", "create the folder"});
  expect_error([&] { write_file(folder.path(), "x"); }, {"not a regular file"});
  expect_error([] { write_file("/dev/null", "x"); }, {"/dev/null", "not a regular file"});
}

TEST(ReadFile, LimitsAndErrors) {
  const TempFolder folder;
  write_file(folder / "a", "12345");
  EXPECT_EQ(read_file(folder / "a", 5).size(), 5u);
  expect_error([&] { read_file(folder / "a", 4); }, {"larger than the 4 bytes"});
  expect_error([&] { read_file(folder / "b", 4); }, {"b'", "No such file"});
  expect_error([&] { read_file(folder.path(), 4); }, {"not a regular file"});
  EXPECT_EQ(read_text_file("/proc/self/comm", 100).back(), '\n');  // claims to be empty
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  expect_error([&] { read_file(folder / "pipe", 4); }, {"not a regular file"});
}

TEST(ReadFile, EmptyFile) {
  const TempFolder folder;
  write_file(folder / "empty", "");
  EXPECT_TRUE(read_file(folder / "empty", 0).empty());
}

}  // namespace
}  // namespace vkopple
