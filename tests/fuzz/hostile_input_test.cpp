#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cctype>
#include <cstring>
#include <fstream>

#include "models/config.h"
#include "runtime/pipeline_cache.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/quiet.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/formats/authors/authors_table.h"
#include "train/formats/tfrecord.h"
#include "train/image_io.h"
#include "train/json_io.h"
#include "train/pickle/pickle.h"
#include "train/pickle/pickle_writer.h"
#include "train/safetensors.h"
#include "train/shards.h"
#include "train/training_log.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::TempFolder;

constexpr std::size_t kEnough = std::size_t{32} << 20;
constexpr std::size_t kDeep = 100'000;

std::string little_endian(std::uint64_t number) {
  std::string text(sizeof number, '\0');
  std::memcpy(text.data(), &number, sizeof number);
  return text;
}

/// Bytes of address space in use.
std::size_t address_space() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

[[noreturn]] void try_in_little_memory(const std::function<void()>& action) {
  const rlim_t most = address_space() + kEnough;
  const rlimit limit{most, most};
  fuzz::require(::setrlimit(RLIMIT_AS, &limit) == 0, "memory can be limited");
  fuzz::tolerate(action);
  ::_exit(0);
}

/// Files of a few bytes that announce many.
class SizesThatLie : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "a sanitizer takes more address space than this limits";
#endif
    GTEST_FLAG_SET(death_test_style, "threadsafe");  // drivers of other tests have threads
  }

  void takes_little_memory(const std::function<void()>& read) {
    EXPECT_EXIT(try_in_little_memory(read), testing::ExitedWithCode(0), "");
  }

  TempFolder folder_;
  fuzz::Quiet quiet_;
};

TEST_F(SizesThatLie, OfAPipelineCache) {
  const auto path = folder_ / "cache.bin";
  constexpr std::size_t kBytesAt = 48;
  save_pipeline_cache(path, Caps{}, {});
  std::string text = read_text_file(path, 1000);
  text.replace(kBytesAt, 8, little_endian(200 << 20));
  write_file(path, text);
  takes_little_memory([&] { load_pipeline_cache(path, Caps{}); });
}

TEST_F(SizesThatLie, OfSafetensors) {
  write_file(folder_ / "head", little_endian(99'000'000) + std::string(100, '{'));
  takes_little_memory([&] { SafetensorsFile(folder_ / "head"); });
  const std::string header = R"({"a":{"dtype":"U8","shape":[99000000],"data_offsets":[0,99000000]}})";
  write_file(folder_ / "tensor", little_endian(header.size()) + header + "123");
  takes_little_memory([&] { SafetensorsFile(folder_ / "tensor").read("a"); });
}

TEST_F(SizesThatLie, OfAShardsMember) {
  Sample sample{"a", {{"json", std::vector<std::byte>(600)}}, {}};
  ShardWriter writer(folder_ / "set", "rooms", 1);
  writer.add(sample);
  const auto path = folder_ / "set/rooms-000000.tar";
  std::string tar = read_text_file(path, 1 << 20);
  const auto sum_of = [&] {
    unsigned sum = 8 * ' ';
    for (std::size_t i = 0; i < 512; ++i)
      if (i < 148 || i >= 156) sum += static_cast<unsigned char>(tar[i]);
    return sum;
  };
  ASSERT_EQ(std::stoul(tar.substr(148, 6), nullptr, 8), sum_of());
  tar.replace(124, 11, "00360000000");  // 60 MiB, within the limit
  tar.replace(148, 6, fmt::format("{:06o}", sum_of()));
  write_file(path, tar);
  takes_little_memory([&] { ShardReader(folder_ / "set").next(); });
  expect_error([&] { ShardReader(folder_ / "set").next(); }, {"'a.json'", "cut off"});
  expect_error([&] { ShardReader(folder_ / "set").next_place(); }, {"'a.json'", "cut off"});
}

TEST_F(SizesThatLie, OfARecord) {
  // 60 MiB, within the limit, and the right checksum of this length.
  const std::string head("\x00\x00\xc0\x03\x00\x00\x00\x00\x07\x97\x0a\x7f", 12);
  write_file(folder_ / "a.tfrecord", head + "x");
  takes_little_memory([&] { TfRecordReader({folder_ / "a.tfrecord"}).next(); });
  expect_error([&] { TfRecordReader({folder_ / "a.tfrecord"}).next(); }, {"record 0", "cut off"});
}

TEST_F(SizesThatLie, OfAPickle) {
  const std::string text = "\x80\x04\x8e" + little_endian(std::uint64_t{1} << 40) + "x.";
  takes_little_memory([&] { Pickle(std::as_bytes(std::span(text)), "a.pickle"); });
}

TEST_F(SizesThatLie, OfAnExr) {
  const std::string longest = "\xff\xff\xff\x3f";
  const std::string text =
      std::string("\x76\x2f\x31\x01\x02\0\0\0owner\0string\0", 21) + longest + std::string(100, 'x');
  takes_little_memory([&] { decode_exr(std::as_bytes(std::span(text)), "a.exr"); });
  expect_error([&] { decode_exr(std::as_bytes(std::span(text)), "a.exr"); }, {"a.exr", "longer than the file"});
  write_file(folder_ / "a.exr", text);
  takes_little_memory([&] { read_rgb(folder_ / "a.exr"); });
}

TEST(HostileInput, ObjectsThatRowsShareAreCounted) {
  const TempFolder folder;
  AuthorsRow row{.stems = {"a", "b", "c"}, .cameras = {CameraPose{}, CameraPose{}, CameraPose{}}};
  row.objects.assign(3, std::vector<PlacedObject>(kMostSceneObjects + 1, {{}, 0.0}));
  write_file(folder / "data_map.pickle", authors_table_pickle({row}));
  expect_error([&] { read_authors_table(folder / "data_map.pickle"); }, {"'objpos1'", "at most 1000 objects"});
  row.objects.assign(3, std::vector<PlacedObject>(1, {{}, 0.0}));
  row.shapes.assign(kMostSceneObjects + 1, "cube");
  write_file(folder / "data_map.pickle", authors_table_pickle({row}));
  expect_error([&] { read_authors_table(folder / "data_map.pickle"); }, {"'objdeet1'", "at most 1000 objects"});
}

TEST(HostileInput, ColumnsAreCounted) {
  const TempFolder folder;
  PickleWriter pickle;
  pickle.dict([&] {
    for (int i = 0; i <= 1000; ++i) {
      pickle.text(fmt::format("frame{}", i));
      pickle.list([] {});
    }
  });
  write_file(folder / "data_map.pickle", pickle.finish());
  expect_error([&] { read_authors_table(folder / "data_map.pickle"); }, {"a dict of at most 1000 columns"});
}

/// Whoever walks such a value by recursion runs out of stack.
TEST(HostileInput, NestingIsRefused) {
  const TempFolder folder;
  const std::string nested = std::string(kDeep, '[') + std::string(kDeep, ']');
  expect_error([&] { Config::parse(nested, "run.json"); }, {"run.json", "nested deeper than 32"});
  expect_error([&] { parse_json(nested, "a.json"); }, {"a.json", "nested deeper than 64"});
  std::string set = "model";
  for (std::size_t i = 0; i < kDeep; ++i) set += ".a";
  expect_error([&] { Config::parse("{}", "run.json", std::vector<std::string>{set + "=1"}); },
               {"--set model.a.a.a", "nested too deep"});
  write_file(folder / "log.jsonl", nested + "\n");
  const TrainingLog log(folder / "log.jsonl", 3);
  EXPECT_EQ(std::filesystem::file_size(folder / "log.jsonl"), 0U);
}

TEST(HostileInput, MessagesStayOnOneLine) {
  for (const char* set : {"a\nb", "a\nb=1", "model.\n=1", "model.height=\n"})
    expect_error([&] { Config::parse("{}", "run.json", std::vector<std::string>{set}); }, {"--set"});
  expect_error([] { Config::parse(R"({"base": ")" + std::string(kDeep, 'x') + "\\n\"}", "run.json"); },
               {"run.json: base is \"xxx", "...; give a preset"});
}

/// Whether a call of that function, or of one whose name begins so, stands in a text.
bool calls(std::string_view text, std::string_view function) {
  for (std::size_t at = text.find(function); at != text.npos; at = text.find(function, at + 1)) {
    const auto before = at == 0 ? ' ' : static_cast<unsigned char>(text[at - 1]);
    if (std::isalnum(before) == 0 && before != '_') return true;
  }
  return false;
}

/// Names of files come from outside; no shell may see them.
TEST(HostileInput, NoCodeStartsAProgram) {
  std::size_t files = 0;
  for (const char* folder : {"runtime", "graph", "models", "train", "capi", "tools", "examples"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(VKOPPLE_SOURCE_DIR) / folder)) {
      const auto ending = entry.path().extension();
      if (ending != ".cpp" && ending != ".h" && ending != ".c") continue;
      ++files;
      const std::string text = read_text_file(entry.path(), 1 << 20);
      for (const char* function :
           {"system(", "popen(", "posix_spawn", "fork(", "vfork(", "execl", "execv", "wordexp("})
        EXPECT_FALSE(calls(text, function)) << entry.path() << " calls " << function;
    }
  EXPECT_GT(files, 500U);
}

}  // namespace
}  // namespace vkopple
