#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/wide_vectors.h"
#include "tools/access_option.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"
#include "train/parity.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

struct Options {
  std::string fixture;
  std::string dump;
  bool plain_sums = false;
  WinogradUse winograd = WinogradUse::kWhereFaster;
  bool json = false;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
  std::optional<AccessPath> access;
};

nlohmann::ordered_json to_json(const ParityEntry& e) {
  return {{"name", e.name}, {"error", e.error}, {"noise", e.noise}, {"limit", e.limit}, {"passed", e.passed()}};
}

void print(const ParityReport& report) {
  fmt::print("{:<14} {:>7} {:>10} {:>10} {:>10}   {}\n", "group", "tensors", "error", "noise", "limit",
             "worst tensor");
  for (const auto& [group, worst] : report.worst()) {
    size_t count = 0;
    for (const auto& e : report.entries) count += e.name.starts_with(group + "/") ? 1 : 0;
    fmt::print("{:<14} {:>7} {:>10.1e} {:>10.1e} {:>10.1e}   {}\n", group, count, worst.error, worst.noise,
               worst.limit, worst.name);
  }
  for (const auto& e : report.entries)
    if (!e.passed())
      fmt::print("OVER  {}: error {:.2e}, limit {:.2e} (noise {:.1e})\n", e.name, e.error, e.limit, e.noise);
}

void run(const Options& options) {
  require_kernels_suit(options.kernels, Precision::kFloat32);
  const bool forced = options.winograd == WinogradUse::kTiles2 || options.winograd == WinogradUse::kTiles4;
  if (forced && !options.plain_sums)
    throw UsageError(
        "--winograd 2 and 4 go with --plain-sums: convolutions that keep what sums round off are direct");
  prefer_wide_vectors();
  const Device device({.selector = options.device,
                       .access = options.access,
                       .exact_sums = !options.plain_sums,
                       .winograd = options.winograd,
                       .kernels = options.kernels});
  const ParityReport report = check_parity(device, options.fixture);
  if (!options.dump.empty()) write_safetensors(options.dump, {{"fixture", options.fixture}}, report.computed);
  if (options.json) {
    nlohmann::ordered_json out{{"fixture", options.fixture}, {"passed", report.passed()}};
    out["worst"] = nlohmann::ordered_json::object();
    for (const auto& [group, worst] : report.worst()) out["worst"][group] = to_json(worst);
    for (const auto& e : report.entries) out["tensors"].push_back(to_json(e));
    fmt::print("{}\n", out.dump(2));
  } else {
    print(report);
    fmt::print("{}: {}\n", options.fixture, report.passed() ? "every tensor is within its limit" : "FAILED");
  }
  if (!report.passed()) throw CLI::RuntimeError(1);
}

}  // namespace

void add_verify(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("verify", "Compare every stage, loss and gradient with a reference fixture");
  const auto options = std::make_shared<Options>();
  command->add_option("fixture", options->fixture, "Parity fixture (safetensors)")->required();
  command->add_option("--dump", options->dump, "Write what was computed, under the fixture's names");
  command->add_flag(
      "--plain-sums", options->plain_sums,
      "Convolve with training's plain float32 sums. By default their rounding is kept and added back, so that "
      "what is compared is the formulas: with batch statistics, rounding alone moves LeakyReLU over its kink");
  add_winograd_option(*command, options->winograd);
  command->add_flag("--json", options->json, "Print JSON");
  add_device_option(*command, options->device);
  add_kernels_option(*command, options->kernels);
  add_access_option(*command, options->access);
  command->footer("Example: vkopple verify tests/fixtures/rigid.safetensors --dump computed.safetensors");
  command->callback([options] { run(*options); });
}

}  // namespace vkopple
