#include "tests/support/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <sstream>

#include "tests/support/temp_folder.h"

namespace vkopple::test {
namespace {

std::string text_of(const std::filesystem::path& path) {
  const std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// What a process started with, without what posix_spawn wants freed.
class Redirection {
 public:
  Redirection(const std::filesystem::path& output, const std::filesystem::path& errors) {
    ::posix_spawn_file_actions_init(&actions_);
    add(STDIN_FILENO, "/dev/null", O_RDONLY);
    add(STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC);
    add(STDERR_FILENO, errors, O_WRONLY | O_CREAT | O_TRUNC);
  }
  ~Redirection() { ::posix_spawn_file_actions_destroy(&actions_); }
  Redirection(const Redirection&) = delete;
  Redirection& operator=(const Redirection&) = delete;

  const posix_spawn_file_actions_t* actions() const { return &actions_; }

 private:
  void add(int descriptor, const std::filesystem::path& path, int flags) {
    ::posix_spawn_file_actions_addopen(&actions_, descriptor, path.c_str(), flags, 0600);
  }
  posix_spawn_file_actions_t actions_{};
};

int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

int Outcome::lines() const { return static_cast<int>(std::count(errors.begin(), errors.end(), '\n')); }

Outcome run_vkopple(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  const TempFolder folder;
  const Redirection redirection(output.empty() ? folder / "output" : output, folder / "errors");
  std::vector<std::string> words{VKOPPLE_BINARY};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t process = 0;
  const int problem =
      ::posix_spawn(&process, VKOPPLE_BINARY, redirection.actions(), nullptr, argv.data(), environ);
  if (problem != 0) {
    ADD_FAILURE() << VKOPPLE_BINARY << " cannot be started: " << std::strerror(problem);
    return {};
  }
  const int code = wait_for(process);
  return {code, text_of(folder / "output"), text_of(folder / "errors")};
}

void expect_failure(const Outcome& outcome, int code, const std::vector<std::string>& parts) {
  EXPECT_EQ(outcome.code, code) << outcome.errors;
  EXPECT_EQ(outcome.lines(), 1) << outcome.errors;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.errors.find(part), std::string::npos) << "no '" << part << "' in: " << outcome.errors;
}

void expect_success(const Outcome& outcome) { EXPECT_EQ(outcome.code, 0) << outcome.errors; }

}  // namespace vkopple::test
