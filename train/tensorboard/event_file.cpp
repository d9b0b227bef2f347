#include "train/tensorboard/event_file.h"

#include <event.pb.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <span>
#include <system_error>

#include "runtime/error.h"
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

/// TensorBoard shows files by their names' order, so that the time stands first; the step tells two apart that
/// a process opens within a second.
fs::path name(uint64_t step) {
  return fmt::format("events.out.tfevents.{:010}.{}.{}.{}", static_cast<int64_t>(now()), host(), ::getpid(),
                     step);
}

}  // namespace

EventFile::EventFile(const fs::path& folder, uint64_t step) : path_(folder / name(step)) {
  file_.open(path_, std::ios::binary | std::ios::app);
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
  write_tfrecord(file_, std::as_bytes(std::span(message)));
  file_.flush();
  if (!file_)
    throw Error(
        fmt::format("{}: cannot be written: {}", path_.string(), std::generic_category().message(errno)));
}

}  // namespace vkopple
