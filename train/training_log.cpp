#include "train/training_log.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <string>
#include <system_error>

#include "runtime/error.h"

namespace vkopple {
namespace {

std::string reason() { return std::generic_category().message(errno); }

/// Whether a whole line tells of one of the first `step` steps.
bool belongs(const std::string& line, uint64_t step) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  return json.is_object() && json.contains("step") && json["step"].is_number_unsigned() &&
         json["step"].get<uint64_t>() <= step;
}

/// Bytes of a log up to the first line that does not belong.
uint64_t bytes_to_keep(const std::filesystem::path& path, uint64_t step) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(fmt::format("{}: cannot be read: {}", path.string(), reason()));
  uint64_t bytes = 0;
  std::string line;
  while (std::getline(file, line) && !file.eof() && belongs(line, step)) bytes += line.size() + 1;
  return bytes;
}

/// Cuts off what does not belong, and returns the path.
const std::filesystem::path& shortened(const std::filesystem::path& path, uint64_t step) {
  if (!std::filesystem::exists(path)) return path;
  std::error_code failure;
  std::filesystem::resize_file(path, bytes_to_keep(path, step), failure);
  if (failure) throw Error(fmt::format("{}: cannot be shortened: {}", path.string(), failure.message()));
  return path;
}

}  // namespace

nlohmann::ordered_json to_json(const StepRecord& record) {
  nlohmann::ordered_json json{{"step", record.step},
                              {"stage", record.stage},
                              {"losses", record.losses},
                              {"seconds", record.seconds},
                              {"data_seconds", record.data_seconds}};
  const auto add_known = [&](const char* name, const std::optional<double>& score) {
    if (score) json[name] = *score;
  };
  if (record.held_out) {
    add_known("ari_fg", record.held_out->ari_fg);
    add_known("iou", record.held_out->iou);
    add_known("depth_r", record.held_out->depth_r);
  }
  if (record.shared) {
    json["processes"] = record.shared->processes;
    json["exchange_seconds"] = record.shared->exchange_seconds;
    json["efficiency"] = record.shared->efficiency;
  }
  if (record.skipped) json["skipped_steps"] = record.skipped_steps;
  return json;
}

TrainingLog::TrainingLog(const std::filesystem::path& path, uint64_t step, FileSystem& files)
    : file_(shortened(path, step), files) {}

void TrainingLog::add(const StepRecord& record) { file_.add(to_json(record).dump() + '\n'); }

}  // namespace vkopple
