#include <fmt/format.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "runtime/error.h"
#include "tools/commands.h"

namespace {

constexpr int kFailed = 1;
constexpr int kWrongUse = 2;

int run(int argc, char** argv) {
  CLI::App app(
      "OPPLE on any Vulkan device: learns to cut images into objects, to place them in 3D and to see depth.");
  app.name("vkopple");
  app.set_version_flag("--version", std::string("vkopple ") + VKOPPLE_VERSION);
  app.require_subcommand(1);
  for (const vkopple::AddCommand add : vkopple::all_commands()) add(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    const auto rest = app.remaining();
    if (app.get_subcommands().empty() && !rest.empty() && !rest.front().starts_with('-'))
      fmt::print(stderr, "vkopple: there is no command {} (see vkopple --help)\n", rest.front());
    else
      fmt::print(stderr, "vkopple: {} (see vkopple --help)\n", error.what());
    return kWrongUse;
  } catch (const vkopple::UsageError& error) {
    fmt::print(stderr, "vkopple: {}\n", error.what());
    return kWrongUse;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "vkopple: out of memory; use a smaller --batch or image size\n");
    return kFailed;
  } catch (const std::exception& error) {
    fmt::print(stderr, "vkopple: {}\n", error.what());
    return kFailed;
  }
}

}  // namespace

int main(int argc, char** argv) {
  // Results go to standard output; what is said about them to standard error.
  spdlog::set_default_logger(spdlog::stderr_color_mt("vkopple"));
  spdlog::set_pattern("vkopple: %l: %v");
  return run(argc, argv);
}
