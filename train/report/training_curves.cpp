#include "train/report/training_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "runtime/error.h"
#include "train/json_io.h"

namespace vkopple {
namespace {

constexpr std::uintmax_t kLargestLog = std::uintmax_t{1} << 30;
constexpr int64_t kMostSteps = 1'000'000'000'000;
constexpr std::array<const char*, 3> kHeldOut{"ari_fg", "iou", "depth_r"};
const JsonLimits kLineLimits{.max_depth = 8, .max_values = 1000};

void add_line(const JsonView& line, TrainingCurves& curves) {
  const int64_t step = line["step"].integer(0, kMostSteps);
  const auto x = static_cast<double>(step);
  const std::string& stage = line["stage"].string();
  if (curves.stages.empty() || curves.stages.back().name != stage)
    curves.stages.push_back({static_cast<uint64_t>(step), stage});
  const JsonView losses = line["losses"];
  for (const auto& [name, value] : losses.json().items()) {
    if (value.is_null())  // what JSON has for a number that is not finite
      ++curves.not_finite;
    else
      curves.losses[name].push_back({x, losses[name].number()});
  }
  curves.seconds.push_back({x, line["seconds"].number()});
  curves.data_seconds.push_back({x, line["data_seconds"].number()});
  for (const char* name : kHeldOut)
    if (line.contains(name) && !line[name].json().is_null())
      curves.held_out[name].push_back({x, line[name].number()});
  ++curves.steps;
}

}  // namespace

TrainingCurves read_training_curves(const std::filesystem::path& path) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (failure) throw Error(fmt::format("{}: cannot be read: {}", path.string(), failure.message()));
  if (size > kLargestLog)
    throw Error(fmt::format("{}: {} bytes are too many for a log; check the path", path.string(), size));
  std::ifstream file(path, std::ios::binary);
  TrainingCurves curves;
  std::string text;
  uint64_t number = 0;
  while (std::getline(file, text) && !file.eof()) {
    const std::string where = fmt::format("{}: line {}", path.string(), ++number);
    const Json json = parse_json(text, where, kLineLimits);
    add_line(JsonView(json, where), curves);
  }
  if (file.bad()) throw Error(fmt::format("{}: cannot be read", path.string()));
  return curves;
}

std::vector<CurveStretch> stretches(const Curve& curve, std::size_t most) {
  const std::size_t length = (curve.size() + most - 1) / most;
  std::vector<CurveStretch> out;
  for (std::size_t begin = 0; begin < curve.size(); begin += length) {
    const std::size_t end = std::min(begin + length, curve.size());
    CurveStretch s{(curve[begin].x + curve[end - 1].x) / 2, curve[begin].y, 0, curve[begin].y};
    for (std::size_t i = begin; i < end; ++i) {
      s.low = std::min(s.low, curve[i].y);
      s.high = std::max(s.high, curve[i].y);
      s.mean += curve[i].y / static_cast<double>(end - begin);
    }
    out.push_back(s);
  }
  return out;
}

}  // namespace vkopple
