#include "models/presets.h"

#include "preset_texts.h"

namespace vkopple {

std::optional<std::string_view> find_preset(std::string_view name) {
  for (const auto& [known, text] : embedded::preset_texts()) {
    if (known == name) return text;
  }
  return std::nullopt;
}

std::vector<std::string_view> preset_names() {
  std::vector<std::string_view> names;
  for (const auto& [name, text] : embedded::preset_texts()) names.push_back(name);
  return names;
}

}  // namespace vkopple
