#include "train/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>
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
  return std::filesystem::exists(latest(), failure) || std::filesystem::exists(best(), failure) ||
         !numbered_steps().empty();
}

void RunFolder::remove_remains() const {
  std::error_code failure;
  std::vector<std::filesystem::path> remains;
  for (const auto& entry : std::filesystem::directory_iterator(path_, failure))
    if (entry.path().filename().string().find(".safetensors.tmp-") != std::string::npos)
      remains.push_back(entry.path());
  for (const auto& path : remains) std::filesystem::remove(path, failure);
}

std::filesystem::path RunFolder::numbered(uint64_t step) const {
  return path_ / fmt::format("step-{:06}.safetensors", step);
}

std::vector<uint64_t> RunFolder::numbered_steps() const {
  std::vector<uint64_t> steps;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(path_, failure)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view kBefore = "step-";
    if (!name.starts_with(kBefore)) continue;
    uint64_t step = 0;
    std::from_chars(name.data() + kBefore.size(), name.data() + name.size(), step);
    if (numbered(step).filename() == name) steps.push_back(step);
  }
  std::sort(steps.begin(), steps.end());
  return steps;
}

std::filesystem::path named_checkpoint(const std::filesystem::path& path) {
  std::error_code failure;
  return std::filesystem::is_directory(path, failure) ? RunFolder(path).latest() : path;
}

}  // namespace vkopple
