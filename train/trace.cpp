#include "train/trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "train/atomic_file.h"

namespace vkopple {
namespace {

using OrderedJson = nlohmann::ordered_json;

int64_t nanoseconds(Trace::Clock::time_point time) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

OrderedJson shapes(const std::vector<TensorSpec>& specs) {
  OrderedJson list = OrderedJson::array();
  for (const TensorSpec& spec : specs) list.push_back(spec.shape.text());
  return list;
}

std::string described(const std::string& name, const std::string& category, const OrderedJson& arguments) {
  OrderedJson json{{"name", name}, {"cat", category}};
  if (!arguments.empty()) json["args"] = arguments;
  const std::string text = json.dump();
  return text.substr(1, text.size() - 2);  // without braces: times follow
}

/// Microseconds, as the format wants them.
std::string microseconds(int64_t ns) { return fmt::format("{}.{:03}", ns / 1000, ns % 1000); }

std::string row_name(int row, const std::string& name) {
  return OrderedJson{{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", row}, {"args", {{"name", name}}}}
      .dump();
}

}  // namespace

Trace::Trace(const Caps& caps) : caps_(caps) {}

void Trace::add_host(const std::string& name, Clock::time_point begin, Clock::time_point end) {
  events_.push_back({Row::kHost, nanoseconds(begin), nanoseconds(end), described(name, "host", {})});
}

void Trace::add_pass(const PassProfile& pass) {
  add_host("submit " + pass.name, pass.host.begin, pass.host.submitted);
  add_host("wait for " + pass.name, pass.host.submitted, pass.host.end);
  if (pass.nodes.empty()) return;
  const int64_t start = nanoseconds(pass.host.end) - nanoseconds(pass.nodes.back().end());
  events_.push_back({Row::kPasses, start + nanoseconds(pass.nodes.front().begin()),
                     start + nanoseconds(pass.nodes.back().end()), described(pass.name, "pass", {})});
  for (const NodeProfile& node : pass.nodes) add_node(node, pass.name, start);
}

void Trace::add_node(const NodeProfile& node, const std::string& pass, int64_t device_start) {
  OrderedJson arguments{{"pass", pass}};
  if (!node.scope.empty()) arguments["scope"] = node.scope;
  if (!node.inputs.empty()) arguments["inputs"] = shapes(node.inputs);
  if (!node.outputs.empty()) arguments["outputs"] = shapes(node.outputs);
  if (node.bytes > 0) {
    arguments["bytes"] = node.bytes;
    if (node.seconds() > 0) arguments["GB/s"] = static_cast<double>(node.bytes) * 1e-9 / node.seconds();
  }
  if (node.flop > 0) {
    arguments["GFLOP"] = node.flop * 1e-9;
    if (node.seconds() > 0) arguments["GFLOP/s"] = node.flop * 1e-9 / node.seconds();
  }
  events_.push_back({Row::kOps, device_start + nanoseconds(node.begin()),
                     device_start + nanoseconds(node.end()), described(node.op, pass, arguments)});
  for (const CommandTime& command : node.commands)
    events_.push_back({Row::kOps, device_start + nanoseconds(command.begin),
                       device_start + nanoseconds(command.end), described(command.name, "dispatch", {})});
}

std::string Trace::text() const {
  std::vector<const Event*> order;
  for (const Event& event : events_) order.push_back(&event);
  // What contains comes before what it contains, as added.
  std::stable_sort(order.begin(), order.end(), [](const Event* a, const Event* b) {
    if (a->row != b->row) return a->row < b->row;
    if (a->begin != b->begin) return a->begin < b->begin;
    return a->end > b->end;
  });
  int64_t first = INT64_MAX;
  for (const Event& event : events_) first = std::min(first, event.begin);
  std::string out = "{\"displayTimeUnit\": \"ms\",\n\"otherData\": ";
  out += OrderedJson{{"device", caps_.name}, {"driver", caps_.driver}}.dump();
  out += ",\n\"traceEvents\": [\n" + row_name(static_cast<int>(Row::kHost), "host");
  out += ",\n" + row_name(static_cast<int>(Row::kPasses), "device: passes");
  out += ",\n" + row_name(static_cast<int>(Row::kOps), "device: ops and dispatches");
  for (const Event* event : order)
    out += fmt::format(",\n{{{}, \"ph\": \"X\", \"pid\": 1, \"tid\": {}, \"ts\": {}, \"dur\": {}}}",
                       event->text, static_cast<int>(event->row), microseconds(event->begin - first),
                       microseconds(event->end - event->begin));
  return out + "\n]}\n";
}

void Trace::write(const std::filesystem::path& path) const { write_file(path, text()); }

}  // namespace vkopple
