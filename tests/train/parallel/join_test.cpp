#include "train/parallel/join.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/expect_error.h"

namespace vkopple {
namespace {

int processes_of(const std::map<std::string, const char*>& environment) {
  return launched_processes([&](const char* name) {
    const auto found = environment.find(name);
    return found == environment.end() ? nullptr : found->second;
  });
}

TEST(Launched, EveryLaunchersNumberIsSeen) {
  EXPECT_EQ(processes_of({}), 1);
  EXPECT_EQ(processes_of({{"OMPI_COMM_WORLD_SIZE", "4"}, {"PMIX_RANK", "0"}}), 4);
  EXPECT_EQ(processes_of({{"PMI_SIZE", "3"}, {"PMI_RANK", "2"}}), 3);
  EXPECT_EQ(processes_of({{"PMIX_RANK", "1"}, {"SLURM_STEP_NUM_TASKS", "8"}}), 8);
}

TEST(Launched, AMatterOfMpiAlone) {
  EXPECT_EQ(processes_of({{"SLURM_STEP_NUM_TASKS", "8"}}), 1);
  EXPECT_EQ(processes_of({{"PMIX_RANK", "1"}}), 1);
}

/// mpirun within an allocation of Slurm.
TEST(Launched, TheInnerLauncherCounts) {
  EXPECT_EQ(processes_of({{"OMPI_COMM_WORLD_SIZE", "2"}, {"PMIX_RANK", "0"}, {"SLURM_STEP_NUM_TASKS", "8"}}),
            2);
}

TEST(Launched, WhatIsNoNumberIsNamed) {
  for (const char* size : {"", "two", "2(x2)", "0", "-1", "99999999999"})
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
      test::expect_error(
          [&] {
            processes_of({{"PMIX_RANK", "0"}, {name, size}});
          },
          {name, std::string("'") + size + "'", "unset"});
}

}  // namespace
}  // namespace vkopple
