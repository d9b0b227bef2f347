#include "tools/output_folder.h"

#include <fmt/format.h>

#include <system_error>

#include "runtime/error.h"

namespace vkopple {

OutputFolder::OutputFolder(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code failure;
  std::filesystem::create_directories(path_, failure);
  if (!failure && !std::filesystem::is_directory(path_))
    failure = std::make_error_code(std::errc::not_a_directory);
  if (failure) throw Error(fmt::format("{}: the folder cannot be made: {}", path_.string(), failure.message()));
}

std::string OutputFolder::name_for(const std::filesystem::path& input) {
  return unique_name(input.stem().string());
}

std::string OutputFolder::unique_name(const std::string& name) {
  std::string unique = name;
  for (int number = 2; !names_.insert(unique).second; ++number) unique = fmt::format("{}-{}", name, number);
  return unique;
}

}  // namespace vkopple
