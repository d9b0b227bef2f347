#include "train/tensorboard/event_file.h"

#include <event.pb.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <span>
#include <sstream>
#include <string_view>
#include <system_error>

#include "train/formats/tfrecord.h"
#include "train/image_io.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;
using tensorboard::Event;

double now() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Event event(uint64_t step) {
  Event event;
  event.set_wall_time(now());
  event.set_step(static_cast<int64_t>(step));
  return event;
}

std::string host() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "localhost";
  return name.data();
}

constexpr std::string_view kBefore = "events.out.tfevents.";

/// The latest time in the names of a folder's files of events; 0 where there are none.
int64_t latest_time(const fs::path& folder) {
  int64_t latest = 0;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    int64_t time = 0;
    if (!name.starts_with(kBefore)) continue;
    std::from_chars(name.data() + kBefore.size(), name.data() + name.size(), time);
    latest = std::max(latest, time);
  }
  return latest;
}

/// TensorBoard reads files in their names' order, so that the time stands first. A clock that was set back must
/// not put a file before one that it goes on from, nor one that was opened within the same second.
fs::path name(const fs::path& folder, uint64_t step) {
  const int64_t time = std::max(static_cast<int64_t>(now()), latest_time(folder) + 1);
  return fmt::format("{}{:010}.{}.{}.{}", kBefore, time, host(), ::getpid(), step);
}

}  // namespace

EventFile::EventFile(const fs::path& folder, uint64_t step, FileSystem& files)
    : file_(folder / name(folder, step), files) {
  Event version = event(0);
  version.set_file_version("brain.Event:2");
  write(version.SerializeAsString());
  Event start = event(step + 1);
  start.mutable_session_log()->set_status(tensorboard::SessionLog::START);
  write(start.SerializeAsString());
}

void EventFile::add(uint64_t step, const Scalars& scalars) {
  Event all = event(step);
  for (const auto& [tag, number] : scalars) {
    auto* value = all.mutable_summary()->add_values();
    value->set_tag(tag);
    value->set_scalar(static_cast<float>(number));
  }
  write(all.SerializeAsString());
}

void EventFile::add(uint64_t step, const std::string& tag, const RgbImage& picture) {
  const std::vector<std::byte> png = encode_png(picture);
  Event one = event(step);
  auto* value = one.mutable_summary()->add_values();
  value->set_tag(tag);
  value->mutable_picture()->set_height(picture.height);
  value->mutable_picture()->set_width(picture.width);
  value->mutable_picture()->set_colours(3);
  value->mutable_picture()->set_png(png.data(), png.size());
  write(one.SerializeAsString());
}

void EventFile::write(const std::string& message) {
  std::ostringstream record;
  write_tfrecord(record, std::as_bytes(std::span(message)));
  file_.add(record.str());
}

}  // namespace vkopple
