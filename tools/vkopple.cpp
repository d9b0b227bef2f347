#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "runtime/error.h"
#include "runtime/wide_vectors.h"
#include "tools/commands.h"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUse = 2;

/// Not by fmt::print, which throws where the stream is full.
int fail(int code, const std::string& message) {
  std::fputs(("vkopple: " + message + "\n").c_str(), stderr);
  return code;
}

/// What could not be written is known only when it leaves the buffer; a driver may have had it leave before.
int check_output() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return fail(kFailed, fmt::format("the results cannot be written to standard output: {}",
                                   errno != 0 ? std::strerror(errno) : "is it full, or closed?"));
}

int run(int argc, char** argv) {
  CLI::App app(
      "OPPLE on any Vulkan device: learns to cut images into objects, to place them in 3D and to see depth.");
  app.name("vkopple");
  app.set_version_flag("--version", std::string("vkopple ") + VKOPPLE_VERSION);
  app.require_subcommand(1);
  for (const vkopple::AddCommand add : vkopple::all_commands()) add(app);
  try {
    app.parse(argc, argv);
    return check_output();
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    const auto rest = app.remaining();
    const bool unknown = app.get_subcommands().empty() && !rest.empty() && !rest.front().starts_with('-');
    const std::string what = unknown ? "there is no command " + rest.front() : error.what();
    return fail(kWrongUse, what + " (see vkopple --help)");
  } catch (const vkopple::UsageError& error) {
    return fail(kWrongUse, error.what());
  } catch (const std::bad_alloc&) {
    return fail(kFailed, "out of memory; use a smaller --batch or image size");
  } catch (const std::exception& error) {
    return fail(kFailed, error.what());
  }
}

}  // namespace

// NOLINTNEXTLINE(bugprone-exception-escape): only describing the command line to CLI11 lies outside of run's
// try
int main(int argc, char** argv) {
  // Results go to standard output; what is said about them to standard error.
  spdlog::set_default_logger(spdlog::stderr_color_mt("vkopple"));
  spdlog::set_pattern("vkopple: %l: %v");
  vkopple::separate_vector_widths();
  return run(argc, argv);
}
