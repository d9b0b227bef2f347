#include "train/formats/inside.h"

#include <fmt/format.h>

#include <algorithm>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {

std::filesystem::path inside(const std::filesystem::path& folder, const std::string& name,
                             const std::string& where) {
  const std::filesystem::path relative(name);
  const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (name.empty() || relative.is_absolute() || climbs || name.find('\0') != std::string::npos)
    throw Error(
        fmt::format("{}: {} must be the name of a file within the data set's folder", where, quote(name)));
  return folder / relative;
}

}  // namespace vkopple
