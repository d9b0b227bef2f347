#pragma once

#include <filesystem>
#include <string>

namespace vkopple::test {

/// The path of a file in tests/fixtures.
inline std::filesystem::path fixture(const std::string& name) {
  return std::filesystem::path(__FILE__).parent_path().parent_path() / "fixtures" / name;
}

}  // namespace vkopple::test
