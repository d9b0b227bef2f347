#include "train/parallel/agreement.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "runtime/error.h"

namespace vkopple {
namespace {

/// FNV-1a, 64 bits, in quarters that floats hold exactly.
std::array<float, 4> fingerprint(std::string_view text) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  std::array<float, 4> quarters{};
  for (size_t i = 0; i < quarters.size(); ++i) quarters[i] = static_cast<float>(hash >> (16 * i) & 0xFFFF);
  return quarters;
}

}  // namespace

void require_same(Peers* peers, std::string_view text, std::string_view what) {
  if (!several(peers)) return;
  const auto own = fingerprint(text);
  const std::vector<float> all = peers->gather(own);
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i] != own[i % own.size()])
      throw Error(
          fmt::format("processes {} and {} differ in {}; start all with the same command, files and program",
                      peers->rank(), i / own.size(), what));
}

int count_same(Peers* peers, std::string_view text) {
  if (!several(peers)) return 1;
  const auto own = fingerprint(text);
  const std::vector<float> all = peers->gather(own);
  int same = 0;
  for (size_t at = 0; at < all.size(); at += own.size())
    if (std::equal(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(at))) ++same;
  return same;
}

float largest(Peers* peers, float here) {
  if (!several(peers)) return here;
  const std::vector<float> all = peers->gather({&here, 1});
  return *std::max_element(all.begin(), all.end());
}

bool any(Peers* peers, bool here) { return largest(peers, here ? 1.0F : 0.0F) != 0; }

}  // namespace vkopple
