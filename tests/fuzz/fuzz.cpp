#include "tests/fuzz/fuzz.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "runtime/error.h"

namespace vkopple::fuzz {

void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fputs(("does not hold: " + std::string(what) + "\n").c_str(), stderr);
  std::abort();
}

void tolerate(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos,
            std::string("a message is one line: ") + error.what());
  } catch (const std::exception& other) {
    require(false, std::string("nothing but Error is thrown: ") + other.what());
  }
}

}  // namespace vkopple::fuzz
