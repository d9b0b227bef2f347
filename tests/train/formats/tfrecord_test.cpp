#include "train/formats/tfrecord.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tfrecord.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::framed;
using test::gzipped;

class TfRecords : public testing::Test {
 protected:
  std::vector<std::string> read(const std::string& file, std::size_t most_bytes = kMostRecordBytes) {
    write_file(folder_ / "a.tfrecord", file);
    TfRecordReader reader({folder_ / "a.tfrecord"}, most_bytes);
    std::vector<std::string> all;
    while (const auto record = reader.next()) {
      EXPECT_EQ(record->index, all.size());
      all.emplace_back(reinterpret_cast<const char*>(record->bytes.data()), record->bytes.size());
    }
    return all;
  }
  void refuse(const std::string& file, std::initializer_list<std::string> parts) {
    expect_error([&] { read(file); }, {"a.tfrecord"});
    expect_error([&] { read(file); }, parts);
  }

  test::TempFolder folder_;
};

TEST_F(TfRecords, PlainAndGzip) {
  const std::vector<std::string> records{"one", "", std::string(300'000, 'x') + "end"};
  std::string file;
  for (const std::string& record : records) file += framed(record);
  EXPECT_EQ(read(file), records);
  EXPECT_EQ(read(gzipped(file)), records);
  // Files compressed one by one and joined are one file.
  EXPECT_EQ(read(gzipped(framed("one")) + gzipped(framed("two"))), (std::vector<std::string>{"one", "two"}));
}

TEST_F(TfRecords, AnEmptyFileHasNone) {
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read(gzipped("")).empty());
}

TEST_F(TfRecords, ALengthThatLooksLikeGzipIsPlain) {
  const std::string record(0x8b1f, 'y');
  ASSERT_EQ(framed(record).substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(read(framed(record)), std::vector{record});
}

TEST_F(TfRecords, EveryCutOffIsFound) {
  const std::string file = framed("first") + framed("second record");
  const std::size_t first = framed("first").size();
  for (std::size_t size = 1; size < file.size(); ++size) {
    if (size == first) continue;  // a whole record: shorter, but sound
    expect_error([&] { read(file.substr(0, size)); }, {"a.tfrecord"});
  }
  refuse(file.substr(0, first + 5), {"record 1: it is cut off"});
  refuse(file.substr(0, file.size() - 1), {"record 1: it is cut off"});
  const std::string packed = gzipped(file);
  for (std::size_t size = 1; size < packed.size(); ++size)
    expect_error([&] { read(packed.substr(0, size)); }, {"a.tfrecord"});
}

TEST_F(TfRecords, EveryChangedByteIsFound) {
  const std::string file = framed("first") + framed("second");
  for (std::size_t i = 0; i < file.size(); ++i) {
    std::string damaged = file;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    expect_error([&] { read(damaged); }, {"a.tfrecord", "damaged"});
  }
  std::string damaged = file;
  damaged[framed("first").size() + 12] ^= 1;
  refuse(damaged, {"record 1: its checksum is wrong"});
  refuse(gzipped(damaged), {"record 1: its checksum is wrong"});
}

TEST_F(TfRecords, NothingIsAllocatedForAnEndlessRecord) {
  EXPECT_EQ(read(framed("12345"), 5).size(), 1u);
  expect_error([&] { read(framed("123456"), 5); }, {"record 0", "6 bytes are more than the 5"});
}

TEST_F(TfRecords, OtherFilesAreNone) {
  refuse("a text file, longer than a head", {"no TFRecord file"});
  refuse("\x1f\x8b and then rubbish", {"GZIP"});
  expect_error([&] { TfRecordReader({folder_ / "none"}).next(); }, {"none"});
}

TEST_F(TfRecords, AFolderGivesItsFilesInOrder) {
  write_file(folder_ / "x.tfrecord-00001-of-00002", framed("b"));
  write_file(folder_ / "x.tfrecord-00000-of-00002", framed("a"));
  write_file(folder_ / "dataset_info.json", "{}");
  const auto files = find_tfrecords(folder_.path());
  ASSERT_EQ(files.size(), 2u);
  TfRecordReader reader(files);
  EXPECT_EQ(reader.next()->where(), (folder_ / "x.tfrecord-00000-of-00002").string() + ": record 0");
  EXPECT_EQ(reader.next()->where(), (folder_ / "x.tfrecord-00001-of-00002").string() + ": record 0");
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(find_tfrecords(files[0]), std::vector{files[0]});
  std::filesystem::create_directory(folder_ / "empty");
  expect_error([&] { find_tfrecords(folder_ / "empty"); }, {"empty", ".tfrecord"});
}

}  // namespace
}  // namespace vkopple
