#include "runtime/guarded_memory.h"

#include <fmt/format.h>

#include "runtime/bounds.h"
#include "runtime/transfer.h"

namespace vkopple {
namespace {

/// NaN in both types, another one in every band and place: what a kernel carries from one band to another, as
/// arithmetic does with the bits of a NaN, is seen too.
std::vector<uint32_t> band_words(uint32_t band) {
  std::vector<uint32_t> words(kGuardBytes / 4);
  for (uint32_t i = 0; i < words.size(); ++i) {
    const uint32_t mixed = (band * 2654435761U + i * 2246822519U) >> 12;
    words[i] = 0x7fc07c00U | (mixed & 0x3f) << 16 | (1 + (mixed >> 6) % 0x3ff);
  }
  return words;
}

}  // namespace

GuardedMemory::GuardedMemory(const Device& device)
    : device_(&device), arena_(device, MemoryKind::kDevice, "check") {}

Slice GuardedMemory::allocate(uint64_t bytes, const std::string& what) {
  const Slice all = arena_.allocate(bytes + 2 * kGuardBytes);
  const Slice piece = all.sub(kGuardBytes, bytes);
  upload_values<uint32_t>(*device_, piece, std::vector<uint32_t>(bytes / 4, kNaNWord));
  add_band(all.sub(0, kGuardBytes), what, true);
  add_band(all.sub(kGuardBytes + bytes, kGuardBytes), what, false);
  return piece;
}

void GuardedMemory::add_band(const Slice& slice, const std::string& piece, bool before) {
  bands_.push_back({slice, band_words(static_cast<uint32_t>(bands_.size())), piece, before});
  upload_values<uint32_t>(*device_, slice, bands_.back().words);
}

std::string GuardedMemory::describe(const Band& band, const std::vector<uint32_t>& found) {
  size_t changed = 0;
  size_t nearest = 0;  // words between it and the piece
  for (size_t i = 0; i < found.size(); ++i) {
    const size_t word = band.before ? found.size() - 1 - i : i;
    if (found[word] == band.words[word]) continue;
    if (changed == 0) nearest = i;
    ++changed;
  }
  return band.before ? fmt::format("{} bytes changed beside {}, the last of them {} bytes before its beginning",
                                   changed * 4, band.piece, (nearest + 1) * 4)
                     : fmt::format("{} bytes changed beside {}, the first of them {} bytes beyond its end",
                                   changed * 4, band.piece, nearest * 4);
}

std::vector<std::string> GuardedMemory::damage() {
  std::vector<std::string> found;
  for (const Band& band : bands_) {
    const auto words = download_values<uint32_t>(*device_, band.slice);
    if (words == band.words) continue;
    found.push_back(describe(band, words));
    upload_values<uint32_t>(*device_, band.slice, band.words);
  }
  return found;
}

}  // namespace vkopple
