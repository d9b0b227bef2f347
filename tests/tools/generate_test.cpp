#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"
#include "train/shards.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::run_vkopple;
using test::TempFolder;

std::vector<std::string> command(const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> words{"generate", out, "--scenes", "3", "--seed", "5", "--size", "8"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(GenerateCommand, WritesShardsAndSaysSo) {
  const TempFolder folder;
  const std::string out = folder / "rooms";
  const auto outcome = run_vkopple(command(out, {"--frames", "4", "--scenes-per-shard", "2", "--json"}));
  expect_success(outcome);
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  const auto said = nlohmann::json::parse(outcome.output);
  EXPECT_EQ(said.at("scenes"), 3);
  EXPECT_EQ(said.at("frames"), 4);
  EXPECT_EQ(said.at("shards"), 2);
  EXPECT_EQ(said.at("height"), 8);
  ShardReader reader(out);
  EXPECT_EQ(reader.shards().size(), 2U);
  int scenes = 0;
  while (const auto sample = reader.next()) {
    EXPECT_TRUE(sample->parts.contains("3.png"));
    EXPECT_FALSE(sample->parts.contains("4.png"));
    ++scenes;
  }
  EXPECT_EQ(scenes, 3);
}

TEST(GenerateCommand, TheRoomsOfAStage) {
  const TempFolder folder;
  const std::string out = folder / "rooms";
  const auto outcome = run_vkopple(command(out, {"--stage", "depth"}));
  expect_success(outcome);
  EXPECT_EQ(outcome.output, out + ": 3 scenes of 3 frames, 8 x 8 pixels, in 1 shard\n");
}

TEST(GenerateCommand, DoesNotMixDataSets) {
  const TempFolder folder;
  expect_success(run_vkopple(command(folder.path())));
  const auto before = read_file(folder / "rooms-000000.tar", 1 << 20);
  expect_failure(run_vkopple(command(folder.path())), 1, {folder.path(), "rooms-000000.tar already"});
  EXPECT_EQ(read_file(folder / "rooms-000000.tar", 1 << 20), before);
}

TEST(GenerateCommand, RefusesImpossibleOptions) {
  const TempFolder folder;
  const std::string out = folder / "rooms";
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"--scenes", "0"},
                                             {"--scenes", "-1"},
                                             {"--seed", "-1"},
                                             {"--seed", "x"},
                                             {"--size", "3"},
                                             {"--size", "100000"},
                                             {"--height", "8"},
                                             {"--frames", "2"},
                                             {"--scenes-per-shard", "0"},
                                             {"--stage", "nap"},
                                             {"--config", "huge"}})
    expect_failure(run_vkopple(command(out, wrong)), 2, {wrong[0] == "--config" ? "huge" : wrong[0]});
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(GenerateCommand, NamesAFolderThatCannotBe) {
  const TempFolder folder;
  write_file(folder / "file", "");
  expect_failure(run_vkopple(command(folder / "file" / "rooms")), 1, {folder / "file"});
  write_file(folder / "config.json", R"({"rooms": {"objects": 99}})");
  expect_failure(run_vkopple(command(folder / "rooms", {"--config", folder / "config.json"})), 1,
                 {"config.json", "rooms.objects"});
}

}  // namespace
}  // namespace vkopple
