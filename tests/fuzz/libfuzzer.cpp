// What libFuzzer calls, for the target that VKOPPLE_FUZZ_TARGET names. Not part of the usual build.
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include <cstdint>

#include "tests/fuzz/fuzz.h"

namespace vkopple::fuzz {
void VKOPPLE_FUZZ_TARGET(Input input);
}  // namespace vkopple::fuzz

/// Warnings of damaged files are expected, thousands a second.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  spdlog::null_logger_mt("vkopple");
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto input = std::as_bytes(std::span(data, size));
  vkopple::fuzz::tolerate([&] { vkopple::fuzz::VKOPPLE_FUZZ_TARGET(input); });
  return 0;
}
