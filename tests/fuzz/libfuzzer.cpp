// What libFuzzer calls, for the target that VKOPPLE_FUZZ_TARGET names. Not part of the usual build.
#include <cstdint>

#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/quiet.h"

namespace vkopple::fuzz {
void VKOPPLE_FUZZ_TARGET(Input input);
}  // namespace vkopple::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const vkopple::fuzz::Quiet kQuiet;
  const auto input = std::as_bytes(std::span(data, size));
  vkopple::fuzz::tolerate([&] { vkopple::fuzz::VKOPPLE_FUZZ_TARGET(input); });
  return 0;
}
