#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace vkopple::fuzz {

using Input = std::span<const std::byte>;

/// A parser under test: it takes any bytes, and may refuse them by Error. Every tests/fuzz/targets/NAME.cpp
/// defines `void NAME(Input input);`, which the build finds (cmake/fuzz.cmake).
struct Target {
  std::string_view name;
  void (*run)(Input input);
};
/// All, by name.
std::vector<Target> targets();

/// Does what may refuse its input by an Error of one line. Anything else that it throws ends the process.
void tolerate(const std::function<void()>& action);

/// Ends the process where something does not hold that does for any input.
void require(bool holds, std::string_view what);

inline std::string_view text_of(Input input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

}  // namespace vkopple::fuzz
