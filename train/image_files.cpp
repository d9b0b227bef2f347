#include "train/image_files.h"

// OpenImageIO's headers bring their own copy of fmt, set up differently from ours: no fmt in this file.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>

#include "runtime/error.h"
#include "train/natural_order.h"
#include "train/picture_reader.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

/// Endings of the formats that are read, of a text "png:png;jpeg:jpg,jpe,jpeg;...".
std::set<std::string> endings() {
  std::istringstream list(OIIO::get_string_attribute("extension_list"));
  std::set<std::string> found;
  for (std::string format; std::getline(list, format, ';');) {
    const std::size_t colon = std::min(format.find(':'), format.size());
    if (!picture_readers().contains(std::string_view(format).substr(0, colon))) continue;
    std::istringstream words(format.substr(std::min(colon + 1, format.size())));
    for (std::string word; std::getline(words, word, ',');) found.insert(word);
  }
  return found;
}

}  // namespace

std::vector<fs::path> image_files(const fs::path& path) {
  std::error_code failed;
  if (!fs::is_directory(path, failed)) return {path};
  const std::set<std::string> known = endings();
  std::vector<fs::path> files;
  for (auto entry = fs::directory_iterator(path, failed); !failed && entry != fs::directory_iterator();
       entry.increment(failed)) {
    std::error_code unknown;
    const bool hidden = entry->path().filename().string().starts_with('.');
    if (!hidden && entry->is_regular_file(unknown) &&
        known.contains(small_ending(entry->path().filename().string())))
      files.push_back(entry->path());
  }
  const std::string name = quote(path.string(), 4096);
  if (failed) throw Error("cannot read the folder " + name + ": " + failed.message());
  if (files.empty()) throw Error("no pictures lie in " + name + "; name files, or a folder that holds some");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return files;
}

}  // namespace vkopple
