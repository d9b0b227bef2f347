#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "tests/support/file_size_limit.h"
#include "tests/support/program.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::expect_success;
using test::run_vkopple;

/// Commands are found by their files, in whose names '_' stands for '-'.
std::set<std::string> command_names() {
  std::set<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VKOPPLE_SOURCE_DIR) / "tools" / "commands")) {
    if (entry.path().extension() != ".cpp") continue;
    std::string name = entry.path().stem();
    std::replace(name.begin(), name.end(), '_', '-');
    names.insert(name);
  }
  return names;
}

TEST(Commands, EveryHelpHasAnExample) {
  ASSERT_TRUE(command_names().contains("devices"));
  for (const std::string& name : command_names()) {
    SCOPED_TRACE(name);
    const auto outcome = run_vkopple({name, "--help"});
    expect_success(outcome);
    const size_t example = outcome.output.find("Example");
    ASSERT_NE(example, std::string::npos);
    EXPECT_NE(outcome.output.find("vkopple " + name, example), std::string::npos) << outcome.output;
    EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  }
}

TEST(Commands, UnknownOptionsAreWrongUse) {
  for (const std::string& name : command_names()) {
    SCOPED_TRACE(name);
    const auto outcome = run_vkopple({name, "--no-such-option"});
    EXPECT_EQ(outcome.code, 2) << outcome.errors;
    EXPECT_EQ(outcome.lines(), 1) << outcome.errors;
    EXPECT_TRUE(outcome.output.empty()) << outcome.output;
  }
}

TEST(Commands, WhatIsNoCommandIsWrongUse) {
  expect_failure(run_vkopple({"paint"}), 2, {"paint"});
  expect_failure(run_vkopple({}), 2, {"--help"});
}

TEST(Commands, TheHelpListsThemAll) {
  const auto outcome = run_vkopple({"--help"});
  expect_success(outcome);
  for (const std::string& name : command_names())
    EXPECT_NE(outcome.output.find("\n  " + name + " "), std::string::npos) << name;
  expect_success(run_vkopple({"--version"}));
}

TEST(Commands, ADeviceThatIsNotThereIsNamed) {
  expect_failure(run_vkopple({"gradcheck", "sigmoid", "--device", "no such device"}), 2, {"no such device"});
}

TEST(Commands, CooperativeMatricesAreRefusedToFloat32) {
  for (const std::vector<std::string>& command :
       std::vector<std::vector<std::string>>{{"train", "tiny", "--data", "rooms:1", "--out", "not-made"},
                                             {"gradcheck", "sigmoid"},
                                             {"bench", "conv"},
                                             {"verify", "not-read"},
                                             {"tune", "--preset", "tiny"}}) {
    SCOPED_TRACE(command.front());
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), {"--kernels", "cooperative"});
    expect_failure(run_vkopple(arguments), 2, {"--kernels cooperative", "--precision mixed"});
    EXPECT_FALSE(std::filesystem::exists("not-made"));
  }
}

TEST(Commands, WinogradIsForcedWithPlainSumsAlone) {
  expect_failure(run_vkopple({"verify", "fixture", "--winograd", "2"}), 2, {"--plain-sums"});
  expect_failure(run_vkopple({"verify", "fixture", "--winograd", "3"}), 2, {"--winograd"});
  expect_failure(run_vkopple({"train", "tiny", "--out", "run", "--winograd", "2", "--no-winograd"}), 2,
                 {"--winograd", "--no-winograd"});
}

TEST(Commands, ResultsThatCannotBeWrittenAreAFailure) {
  const test::FileSizeLimit limit(16);
  EXPECT_EQ(run_vkopple({"devices", "--json"}).code, 1);
}

}  // namespace
}  // namespace vkopple
