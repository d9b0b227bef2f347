#include "train/shards.h"

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/expect_error.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

std::vector<std::byte> bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Sample sample(const std::string& key, const std::string& text = "x") {
  return {key, {{"json", bytes_of(text)}, {"0.png", bytes_of(text + "0")}, {"0.exr", {}}}, {}};
}

/// A block of 512 bytes that describes a member, as POSIX has it.
std::string tar_header(const std::string& name, std::size_t size, char type = '0',
                       const std::string& link = "") {
  std::string block(512, '\0');
  const auto put = [&](std::size_t at, const std::string& text) { block.replace(at, text.size(), text); };
  char octal[12];
  std::snprintf(octal, sizeof octal, "%011zo", size);
  put(0, name);
  put(100, "0000644");
  put(124, octal);
  put(136, "00000000000");
  put(148, "        ");
  block[156] = type;
  put(157, link);
  put(257, std::string("ustar\0", 6) + "00");
  unsigned sum = 0;
  for (const char c : block) sum += static_cast<unsigned char>(c);
  std::snprintf(octal, sizeof octal, "%06o", sum);
  put(148, std::string(octal) + '\0');
  return block;
}

std::string tar_member(const std::string& name, const std::string& text = "x") {
  return tar_header(name, text.size()) + text + std::string((512 - text.size() % 512) % 512, '\0');
}

const std::string kTarEnd(1024, '\0');

class Shards : public testing::Test {
 protected:
  std::vector<Sample> read_all(const std::filesystem::path& path, const ShardLimits& limits = {}) {
    std::vector<Sample> all;
    ShardReader reader(path, limits);
    while (auto next = reader.next()) all.push_back(std::move(*next));
    return all;
  }
  void refuse(const std::string& tar, std::initializer_list<std::string> parts,
              const ShardLimits& limits = {}) {
    write_file(folder_ / "bad.tar", tar);
    expect_error([&] { read_all(folder_ / "bad.tar", limits); }, {"bad.tar"});
    expect_error([&] { read_all(folder_ / "bad.tar", limits); }, parts);
  }

  TempFolder folder_;
};

TEST_F(Shards, RoundTripInOrder) {
  ShardWriter writer(folder_ / "set", "rooms", 2);
  for (const char* key : {"b", "a", "c"}) writer.add(sample(key, std::string(700, key[0])));
  writer.finish();
  EXPECT_EQ(writer.shards(), 2u);
  const auto all = read_all(folder_ / "set");
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].key, "b");
  EXPECT_EQ(all[1].key, "a");
  EXPECT_EQ(all[2].key, "c");
  EXPECT_EQ(all[2].parts, sample("c", std::string(700, 'c')).parts);
  EXPECT_EQ(all[2].shard, folder_ / "set/rooms-000001.tar");
  EXPECT_EQ(read_all(folder_ / "set/rooms-000000.tar").size(), 2u);
}

TEST_F(Shards, RewindStartsAgain) {
  ShardWriter writer(folder_ / "set", "rooms", 1);
  for (const char* key : {"a", "b"}) writer.add(sample(key));
  ShardReader reader(folder_ / "set");
  EXPECT_EQ(reader.shards().size(), 2u);
  reader.next();
  EXPECT_EQ(reader.next()->key, "b");
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
  reader.rewind();
  EXPECT_EQ(reader.next()->key, "a");
}

TEST_F(Shards, SameSamplesSameBytes) {
  for (const char* set : {"one", "two"}) {
    ShardWriter writer(folder_ / set, "rooms", 10);
    writer.add(sample("a", std::string(1000, 'q')));
    writer.finish();
  }
  const std::string one = read_text_file(folder_ / "one/rooms-000000.tar", 1 << 20);
  EXPECT_EQ(one, read_text_file(folder_ / "two/rooms-000000.tar", 1 << 20));
  EXPECT_EQ(one.size(), 512 + 512 + 1024 + 512 + 1024 + 1024u);
  const auto field = [&](std::size_t at, std::size_t size) {
    return std::string(one.substr(at, size).c_str());
  };
  EXPECT_EQ(field(0, 100), "a.0.exr");
  EXPECT_EQ(std::stoi(field(100, 8), nullptr, 8), 0644);
  EXPECT_EQ(std::stoi(field(108, 8), nullptr, 8), 0);   // user
  EXPECT_EQ(std::stoi(field(136, 12), nullptr, 8), 0);  // time
  EXPECT_EQ(field(257, 6), "ustar");
  EXPECT_EQ(field(265, 32), "");  // user's name
}

TEST_F(Shards, UnfinishedShardLeavesNothing) {
  {
    ShardWriter writer(folder_ / "set", "rooms", 2);
    for (const char* key : {"a", "b", "c"}) writer.add(sample(key, std::string(100'000, 'x')));
  }
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "set"))
    names.push_back(entry.path().filename());
  EXPECT_EQ(names, (std::vector<std::string>{"rooms-000000.tar"}));
}

TEST_F(Shards, FullDiskLeavesNothingAndStopsTheWriter) {
  ShardWriter writer(folder_ / "set", "rooms", 2);
  writer.add(sample("a"));
  {
    const test::FileSizeLimit limit(100'000);
    expect_error([&] { writer.add(sample("b", std::string(200'000, 'x'))); },
                 {"rooms-000000.tar", "free some space"});
  }
  expect_error([&] { writer.add(sample("c")); }, {"set", "incomplete"});
  expect_error([&] { writer.finish(); }, {"set", "incomplete"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "set/rooms-000000.tar"));
}

TEST_F(Shards, WriterRefuses) {
  ShardWriter writer(folder_ / "set", "rooms", 1);
  writer.add(sample("a"));
  expect_error([&] { ShardWriter(folder_ / "set", "rooms", 1); },
               {"set", "rooms-000000.tar already", "another folder"});
  EXPECT_NO_THROW(ShardWriter(folder_ / "set", "other", 1));
  for (const char* key : {"", "a.b", "/a", "../a", "a/b"})
    expect_error([&] { writer.add(sample(key)); }, {"key of a sample"});
  expect_error([&] { writer.add(sample(std::string(300, 'k'))); }, {"cannot write", "rooms-000001.tar"});
  write_file(folder_ / "file", "");
  expect_error([&] { ShardWriter(folder_ / "file", "rooms", 1); }, {"cannot use the folder", "file"});
  ShardWriter twice(folder_ / "twice", "rooms", 9);
  twice.add(sample("a"));
  expect_error([&] { twice.add(sample("a")); }, {"'a'", "twice"});
  expect_error([&] { ShardWriter(folder_ / "none", "rooms", 0); }, {"at least one"});
}

TEST_F(Shards, ReadsWhatOtherToolsWrite) {
  write_file(folder_ / "a.tar", tar_header("./", 0, '5') + tar_member("./k.json", "{}") +
                                    tar_header("sub.dir/", 0, '5') + tar_member("sub.dir/k.1.png", "1") +
                                    tar_member("sub.dir/k.2.png", "2") + kTarEnd + std::string(8192, '\0'));
  const auto all = read_all(folder_ / "a.tar");
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].key, "k");
  EXPECT_EQ(all[0].part("json"), bytes_of("{}"));
  EXPECT_EQ(all[1].key, "sub.dir/k");
  EXPECT_EQ(all[1].part("2.png"), bytes_of("2"));
  expect_error([&] { all[0].part("0.png"); }, {"a.tar: k.0.png is missing"});
  write_file(folder_ / "empty.tar", kTarEnd);
  EXPECT_TRUE(read_all(folder_ / "empty.tar").empty());
}

TEST_F(Shards, RefusesEveryTruncation) {
  const std::string whole = tar_member("a.json", std::string(600, 'x')) + tar_member("b.json") + kTarEnd;
  for (std::size_t n = 0; n < whole.size(); n += 128) refuse(whole.substr(0, n), {"cut off"});
  refuse(whole.substr(0, 1024) + whole.substr(1536), {"damaged after 'a.json'"});
}

TEST_F(Shards, RefusesNoTar) {
  refuse(std::string(4096, 'x') + kTarEnd, {"not a tar file: "});
  refuse(std::string(512, 'x') + kTarEnd, {"bad.tar"});
  expect_error([&] { read_all(folder_ / "none.tar"); }, {"none.tar", "No such file"});
  expect_error([&] { read_all(folder_.path()); }, {"bad.tar"});
  std::filesystem::create_directory(folder_ / "nothing");
  expect_error([&] { ShardReader reader(folder_ / "nothing"); }, {"no .tar file lies in", "nothing"});
}

TEST_F(Shards, RefusesBadNames) {
  refuse(tar_member("/etc/a.json") + kTarEnd, {"'/etc/a.json'", "absolute"});
  for (const char* name : {"../a.json", "x/../../a.json", ".."}) refuse(tar_member(name) + kTarEnd, {"climbs"});
  for (const char* name : {"json", ".json", "a/.json", "./.json"})
    refuse(tar_member(name) + kTarEnd, {"KEY.EXTENSION"});
  refuse(tar_member("a.json") + tar_member("a.exe") + kTarEnd,
         {"'a.exe'", "unknown kind of file '.exe'", "exr, json, png"});
  refuse(tar_member("a.") + kTarEnd, {"unknown kind"});
  refuse(tar_member("a.json") + tar_member("a.json") + kTarEnd, {"'a.json'", "twice"});
  refuse(tar_member("a.json") + tar_member("b.json") + tar_member("a.png") + kTarEnd,
         {"'a'", "do not lie together"});
  refuse(tar_member("a\n.exe") + kTarEnd, {"'a?.exe'"});
}

TEST_F(Shards, RefusesLinksAndDevices) {
  refuse(tar_header("a.json", 0, '2', "/etc/passwd") + kTarEnd, {"'a.json'", "not a plain file"});
  refuse(tar_member("b.json") + tar_header("a.json", 0, '1', "b.json") + kTarEnd,
         {"'a.json'", "not a plain file"});
  refuse(tar_header("a.json", 0, '3') + kTarEnd, {"'a.json'", "not a plain file"});
  refuse(tar_header("a.json", 0, '4') + kTarEnd, {"'a.json'", "not a plain file"});
  refuse(tar_header("a.json", 0, '6') + kTarEnd, {"'a.json'", "not a plain file"});
}

TEST_F(Shards, PlacesLeadToTheSameSamples) {
  const auto shard = [&](const char* name, const std::string& text) { write_file(folder_ / name, text); };
  shard("a.tar", tar_member("1.json", "{}") + tar_member("1.0.png", std::string(700, 'x')) +
                     tar_member("2.json", "two") + kTarEnd);
  shard("b.tar", tar_member("1.json", "other") + kTarEnd);
  ShardReader reader(folder_.path());
  const auto all = read_all(folder_.path());
  ASSERT_EQ(all.size(), 3u);
  for (const Sample& expected : all) {
    const auto place = reader.next_place();
    ASSERT_TRUE(place);
    const Sample sample = reader.read(*place);
    EXPECT_EQ(sample.key, expected.key);
    EXPECT_EQ(sample.parts, expected.parts);
    EXPECT_EQ(sample.shard, expected.shard);
    EXPECT_EQ(reader.read(*place, {"json"}).parts.size(), 1u);
  }
  EXPECT_FALSE(reader.next_place());
  reader.rewind();
  const auto place = reader.next_place();
  std::filesystem::resize_file(folder_ / "a.tar", 1024);
  expect_error([&] { reader.read(*place); }, {"a.tar: 1.0.png", "start again"});
}

TEST_F(Shards, Limits) {
  const std::string three =
      tar_member("a.json", "12345") + tar_member("a.0.png") + tar_member("b.json") + kTarEnd;
  refuse(three, {"'a.json'", "5 bytes", "limit of 4"}, {.max_part_bytes = 4});
  refuse(three, {"more than 1 members"}, {.max_parts = 1});
  refuse(three, {"more than 1 samples"}, {.max_samples = 1});
  refuse(three, {"'a.0.png'", "unknown kind"}, {.suffixes = {"json"}});
  EXPECT_EQ(read_all(folder_ / "bad.tar", {.max_part_bytes = 5, .max_parts = 2, .max_samples = 2}).size(), 2u);
  refuse(tar_header("a.json", 077777777777) + kTarEnd, {"'a.json'", "8589934591 bytes"});
}

}  // namespace
}  // namespace vkopple
