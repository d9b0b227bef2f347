#pragma once

#include <filesystem>
#include <string>

namespace vkopple::test {

/// The path of a file in tests/fixtures.
inline std::filesystem::path fixture(const std::string& name) {
  return std::filesystem::path(VKOPPLE_SOURCE_DIR) / "tests" / "fixtures" / name;
}

}  // namespace vkopple::test
