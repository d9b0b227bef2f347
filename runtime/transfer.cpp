#include "runtime/transfer.h"

#include <fmt/format.h>

#include <cstring>

#include "runtime/device.h"
#include "runtime/error.h"
#include "runtime/staging.h"

namespace vkopple {
namespace {

void require_fit(const Slice& slice, size_t bytes) {
  if (bytes > slice.bytes) throw Error("a transfer is larger than the buffer it goes to or comes from");
}

}  // namespace

void copy(const Device& device, const Slice& from, const Slice& to) {
  if (from.storage != to.storage) throw Error("a copy between float32 and float16 was asked for");
  if (from.bytes != to.bytes)
    throw Error(fmt::format("a copy of {} bytes into {} bytes was asked for", from.bytes, to.bytes));
  device.staging().copy(from, to);
}

void upload(const Device& device, const Slice& to, std::span<const std::byte> data) {
  require_fit(to, data.size());
  if (data.empty()) return;
  if (to.buffer->mapped() != nullptr)
    std::memcpy(to.buffer->mapped() + to.offset, data.data(), data.size());
  else
    device.staging().upload(to, data);
}

void download(const Device& device, const Slice& from, std::span<std::byte> data) {
  require_fit(from, data.size());
  if (data.empty()) return;
  if (from.buffer->mapped() != nullptr)
    std::memcpy(data.data(), from.buffer->mapped() + from.offset, data.size());
  else
    device.staging().download(from, data);
}

}  // namespace vkopple
