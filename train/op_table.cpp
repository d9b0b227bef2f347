#include "train/op_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace vkopple {
namespace {

bool is_image(const TensorSpec& spec) { return spec.layout == Layout::kChannels4; }

/// "3x3 s2 [4,64,128,128] -> 64", or nothing where the node is no convolution: images, then a kernel of
/// weights.
std::string convolution_text(const NodeProfile& node) {
  if (node.op.find("conv") == std::string::npos || node.inputs.size() < 2 || node.outputs.empty()) return {};
  const TensorSpec &x = node.inputs[0], &w = node.inputs[1], &y = node.outputs[0];
  if (!is_image(x) || !is_image(y) || is_image(w) || w.shape.rank() != 4) return {};
  const int64_t before = x.shape[2], after = y.shape[2];
  const std::string stride =
      after > before ? fmt::format("t{}", after / before) : fmt::format("s{}", (before + after - 1) / after);
  return fmt::format("{}x{} {} {} -> {}", w.shape[2], w.shape[3], stride, x.shape.text(), y.shape[1]);
}

}  // namespace

std::string shape_text(const NodeProfile& node) {
  if (const std::string text = convolution_text(node); !text.empty()) return text;
  if (node.inputs.empty()) return {};
  const Shape& x = node.inputs[0].shape;
  if (node.outputs.empty() || node.outputs[0].shape == x) return x.text();
  return fmt::format("{} -> {}", x.text(), node.outputs[0].shape.text());
}

std::vector<OpRow> op_table(const std::vector<PassProfile>& passes, OpRows rows) {
  std::map<std::tuple<std::string, std::string, std::string>, OpRow> found;
  double total = 0;
  for (const PassProfile& pass : passes) {
    for (const NodeProfile& node : pass.nodes) {
      const std::string shape = rows == OpRows::kByShape ? shape_text(node) : std::string();
      OpRow& row = found[{node.op, pass.name, shape}];
      row.op = node.op;
      row.pass = pass.name;
      row.shape = shape;
      ++row.count;
      row.seconds += node.seconds();
      row.gflop += node.flop * 1e-9;
      row.gbytes += static_cast<double>(node.bytes) * 1e-9;
      total += node.seconds();
    }
  }
  std::vector<OpRow> table;
  for (auto& [key, row] : found) {
    row.share = total > 0 ? row.seconds / total : 0;
    table.push_back(std::move(row));
  }
  std::stable_sort(table.begin(), table.end(),
                   [](const OpRow& a, const OpRow& b) { return a.seconds > b.seconds; });
  return table;
}

}  // namespace vkopple
