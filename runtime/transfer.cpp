#include "runtime/transfer.h"

#include <algorithm>
#include <cstring>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/recorder.h"

namespace vkopple {
namespace {

constexpr uint64_t kStagingBytes = uint64_t{32} << 20;

void require_fit(const Slice& slice, size_t bytes) {
  if (bytes > slice.bytes) throw Error("a transfer is larger than the buffer it goes to or comes from");
}

}  // namespace

void copy(const Device& device, const Slice& from, const Slice& to) {
  Recorder recorder(device);
  recorder.copy(from, to);
  recorder.finish()->run();
}

void upload(const Device& device, const Slice& to, std::span<const std::byte> data) {
  require_fit(to, data.size());
  if (data.empty()) return;
  if (to.buffer->mapped() != nullptr) {
    std::memcpy(to.buffer->mapped() + to.offset, data.data(), data.size());
    return;
  }
  Buffer staging(device, std::min<uint64_t>(data.size(), kStagingBytes), MemoryKind::kHost, "staging");
  for (uint64_t at = 0; at < data.size(); at += kStagingBytes) {
    const uint64_t part = std::min<uint64_t>(kStagingBytes, data.size() - at);
    std::memcpy(staging.mapped(), data.data() + at, part);
    copy(device, {&staging, 0, part}, to.sub(at, part));
  }
}

void download(const Device& device, const Slice& from, std::span<std::byte> data) {
  require_fit(from, data.size());
  if (data.empty()) return;
  if (from.buffer->mapped() != nullptr) {
    std::memcpy(data.data(), from.buffer->mapped() + from.offset, data.size());
    return;
  }
  Buffer staging(device, std::min<uint64_t>(data.size(), kStagingBytes), MemoryKind::kHost, "staging");
  for (uint64_t at = 0; at < data.size(); at += kStagingBytes) {
    const uint64_t part = std::min<uint64_t>(kStagingBytes, data.size() - at);
    copy(device, from.sub(at, part), {&staging, 0, part});
    std::memcpy(data.data() + at, staging.mapped(), part);
  }
}

}  // namespace vkopple
