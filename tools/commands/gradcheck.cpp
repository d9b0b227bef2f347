#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "graph/checks/check.h"
#include "models/model_check.h"
#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/wide_vectors.h"
#include "tools/access_option.h"
#include "tools/command.h"
#include "tools/device_option.h"
#include "tools/precision_option.h"

namespace vkopple {
namespace {

struct Options {
  std::vector<std::string> ops;
  bool all = false;
  bool json = false;
  std::string device;
  KernelFamily kernels = KernelFamily::kAuto;
  std::optional<AccessPath> access;
};

struct Summary {
  std::string op;
  size_t cases = 0;
  Deviation forward;
  Deviation backward;
  std::vector<std::string> failures;
};

void merge(Deviation& total, const Deviation& d) {
  // Written so that a NaN stays.
  if (!(d.worst <= total.worst)) total.worst = d.worst;
  if (!(d.l2 <= total.l2)) total.l2 = d.l2;
}

Summary run_op(const Device& device, const OpChecks& checks) {
  Summary summary{.op = std::string(checks.op)};
  for (const CheckCase& check : checks.cases) {
    if (check.runs_on && !check.runs_on(device.caps())) continue;
    ++summary.cases;
    const CheckResult result = run_check(device, check);
    merge(summary.forward, result.forward);
    merge(summary.backward, result.backward);
    for (const auto& failure : result.failures) summary.failures.push_back(result.label + ": " + failure);
  }
  if (summary.cases == 0) summary.failures.emplace_back("there are no cases that the device can run");
  return summary;
}

std::vector<OpChecks> chosen_checks(const Options& options) {
  auto checks = all_checks();
  if (options.all) return checks;
  if (options.ops.empty()) throw UsageError("gradcheck: name ops, or say --all");
  std::vector<OpChecks> chosen;
  for (const auto& op : options.ops) {
    const auto found =
        std::find_if(checks.begin(), checks.end(), [&](const OpChecks& c) { return c.op == op; });
    if (found == checks.end()) {
      std::string known;
      for (const auto& c : checks) known += (known.empty() ? "" : ", ") + std::string(c.op);
      throw UsageError(fmt::format("gradcheck: there is no op {}; there are {}", op, known));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

void print_row(const Summary& s) {
  fmt::print("{:<22} {:>5}   {:>8.1e} {:>8.1e}   {:>8.1e} {:>8.1e}   {}\n", s.op, s.cases, s.forward.worst,
             s.forward.l2, s.backward.worst, s.backward.l2, s.failures.empty() ? "ok" : "FAILED");
  for (const auto& failure : s.failures) fmt::print("    {}\n", failure);
}

void print_row(std::string_view model, const DirectionalCheck& c) {
  fmt::print("model, {:<23} {:<11} along {:<9} derivative {:>12.6g}, differences {:>12.6g}   {}\n", model,
             c.group, c.direction, c.analytic, c.numeric, c.passed() ? "ok" : "FAILED");
}

nlohmann::ordered_json to_json(std::string_view model, const DirectionalCheck& c) {
  return {{"model", model},           {"network", c.group},      {"direction", c.direction},
          {"derivative", c.analytic}, {"difference", c.numeric}, {"limit", c.limit},
          {"passed", c.passed()}};
}

nlohmann::ordered_json to_json(const Summary& s) {
  return {{"op", s.op},
          {"cases", s.cases},
          {"forward_worst", s.forward.worst},
          {"forward_l2", s.forward.l2},
          {"gradient_worst", s.backward.worst},
          {"gradient_l2", s.backward.l2},
          {"failures", s.failures}};
}

void run(const Options& options) {
  require_kernels_suit(options.kernels, Precision::kFloat32);
  const auto checks = chosen_checks(options);
  prefer_wide_vectors();
  const Device device({.selector = options.device, .access = options.access, .kernels = options.kernels});
  nlohmann::ordered_json out{{"ops", nlohmann::ordered_json::array()}};
  bool failed = false;
  if (!options.json)
    fmt::print("{:<22} {:>5}   {:>17}   {:>17}\n{:<22} {:>5}   {:>8} {:>8}   {:>8} {:>8}\n", "", "",
               "forward error", "gradient error", "op", "cases", "worst", "L2", "worst", "L2");
  for (const OpChecks& op : checks) {
    const Summary summary = run_op(device, op);
    failed = failed || !summary.failures.empty();
    if (options.json)
      out["ops"].push_back(to_json(summary));
    else
      print_row(summary);
  }
  if (options.all) {
    for (const CheckedModel& model : checked_models()) {
      for (const DirectionalCheck& c : check_model(device, model.config)) {
        failed = failed || !c.passed();
        if (options.json)
          out["model"].push_back(to_json(model.name, c));
        else
          print_row(model.name, c);
      }
    }
  }
  if (options.json) fmt::print("{}\n", out.dump(2));
  if (failed) throw CLI::RuntimeError(1);
}

}  // namespace

void add_gradcheck(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "gradcheck", "Check ops against plain double-precision references and finite differences");
  const auto options = std::make_shared<Options>();
  command->add_option("op", options->ops, "Ops to check, as their files are called");
  command->add_flag("--all", options->all,
                    "Check every op, and the whole model along directions in its parameters");
  command->add_flag("--json", options->json, "Print JSON");
  add_device_option(*command, options->device);
  add_kernels_option(*command, options->kernels);
  add_access_option(*command, options->access);
  command->footer("Examples: vkopple gradcheck conv2d lstm\n          vkopple gradcheck --all --json");
  command->callback([options] { run(*options); });
}

}  // namespace vkopple
