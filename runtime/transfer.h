#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "runtime/buffer.h"

namespace vkopple {

class Device;

/// Copies to and from the device, straight where the host sees the memory, through a staging buffer elsewhere.
/// Both wait for the copy's end; the caller has no commands under way that use the slice.
void upload(const Device& device, const Slice& to, std::span<const std::byte> data);
void download(const Device& device, const Slice& from, std::span<std::byte> data);
/// Within the device's memory, likewise. Throws Error where the slices have different sizes or storage.
void copy(const Device& device, const Slice& from, const Slice& to);

template <class T>
void upload_values(const Device& device, const Slice& to, std::span<const T> values) {
  upload(device, to, std::as_bytes(values));
}

template <class T>
std::vector<T> download_values(const Device& device, const Slice& from) {
  std::vector<T> values(from.bytes / sizeof(T));
  download(device, from, std::as_writable_bytes(std::span(values)));
  return values;
}

}  // namespace vkopple
