#include "models/quote_json.h"

namespace vkopple {

std::string quote_json(const nlohmann::json& value, std::size_t longest) {
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

std::string printable(std::string_view text, std::size_t longest) {
  const std::string quoted = quote_json(text, longest);
  return quoted.ends_with('"') ? quoted.substr(1, quoted.size() - 2) : quoted.substr(1);
}

}  // namespace vkopple
