#include "train/image_files.h"

// OpenImageIO's headers bring their own copy of fmt, set up differently from ours: no fmt in this file.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <set>
#include <string>
#include <system_error>

#include "runtime/error.h"
#include "train/natural_order.h"
#include "train/quote.h"

namespace vkopple {
namespace {

namespace fs = std::filesystem;

/// Endings of the formats that OpenImageIO reads, of a text "png:png;jpeg:jpg,jpe,jpeg;...".
std::set<std::string> endings() {
  const std::string list = OIIO::get_string_attribute("extension_list");
  std::set<std::string> found;
  std::string word;
  for (const char c : list + ";") {
    if (c == ',' || c == ';') found.insert(word);
    if (c == ',' || c == ';' || c == ':')
      word.clear();
    else
      word += c;
  }
  return found;
}

/// The ending of a file's name in small letters.
std::string ending(const fs::path& path) {
  std::string text = path.extension().string();
  text.erase(0, 1);
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
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
    if (!hidden && entry->is_regular_file(unknown) && known.contains(ending(entry->path())))
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
