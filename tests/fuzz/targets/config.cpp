#include "models/config.h"

#include "tests/fuzz/fuzz.h"

namespace vkopple::fuzz {
namespace {

/// A configuration, and behind bytes of 0 what `--set` says.
std::vector<std::string> pieces(std::string_view text) {
  std::vector<std::string> all;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\0', begin), text.size());
    all.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

}  // namespace

void config(Input input) {
  std::vector<std::string> given = pieces(text_of(input));
  const std::string text = given.front();
  given.erase(given.begin());
  tolerate([&] { ModelConfig::parse(text, "model"); });
  const Config read = Config::parse(text, "input", given);
  require(Config::parse(read.to_json(), "output") == read, "a configuration comes back as it was written");
}

}  // namespace vkopple::fuzz
