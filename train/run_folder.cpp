#include "train/run_folder.h"

#include <fmt/format.h>

#include <system_error>

#include "runtime/error.h"

namespace vkopple {

void RunFolder::create() const {
  std::error_code failure;
  std::filesystem::create_directories(path_, failure);
  if (!failure && !std::filesystem::is_directory(path_))
    failure = std::make_error_code(std::errc::not_a_directory);
  if (failure) throw Error(fmt::format("{}: the folder cannot be made: {}", path_.string(), failure.message()));
}

bool RunFolder::holds_checkpoint() const {
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(path_, failure)) {
    const std::string name = entry.path().filename().string();
    if (name == latest().filename() || (name.starts_with("step-") && name.ends_with(".safetensors")))
      return true;
  }
  return false;
}

std::filesystem::path RunFolder::numbered(uint64_t step) const {
  return path_ / fmt::format("step-{:06}.safetensors", step);
}

std::filesystem::path named_checkpoint(const std::filesystem::path& path) {
  std::error_code failure;
  return std::filesystem::is_directory(path, failure) ? RunFolder(path).latest() : path;
}

}  // namespace vkopple
