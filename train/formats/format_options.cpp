#include "train/formats/format_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <numbers>

#include "runtime/error.h"
#include "train/quote.h"

namespace vkopple {
namespace {

template <class Number>
Number parse(const std::string& assigned, const std::string& text, Number lowest, Number highest) {
  Number value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem == std::errc() && end == text.data() + text.size() && value >= lowest && value <= highest)
    return value;
  throw UsageError(fmt::format("{}={}: must be a {}number from {} to {}", assigned, one_line(text),
                               std::is_integral_v<Number> ? "whole " : "", lowest, highest));
}

}  // namespace

std::string FormatOptions::text(const std::string& name, const std::string& otherwise) const {
  const auto found = settings.find(name);
  return found == settings.end() ? otherwise : found->second;
}

std::string FormatOptions::choice(const std::string& name, const std::vector<std::string>& choices,
                                  const std::string& otherwise) const {
  const std::string chosen = text(name, otherwise);
  if (std::find(choices.begin(), choices.end(), chosen) != choices.end()) return chosen;
  throw UsageError(
      fmt::format("{} {}={}: must be one of {}", option, name, one_line(chosen), fmt::join(choices, ", ")));
}

double FormatOptions::number(const std::string& name, double lowest, double highest, double otherwise) const {
  const auto found = settings.find(name);
  return found == settings.end() ? otherwise : parse(option + " " + name, found->second, lowest, highest);
}

long FormatOptions::integer(const std::string& name, long lowest, long highest, long otherwise) const {
  const auto found = settings.find(name);
  return found == settings.end() ? otherwise : parse(option + " " + name, found->second, lowest, highest);
}

double FormatOptions::degrees(const std::string& name, double lowest, double highest, double otherwise) const {
  return number(name, lowest, highest, otherwise) * std::numbers::pi / 180;
}

std::string FormatOptions::field(const std::string& name, const std::string& otherwise) const {
  const auto found = fields.find(name);
  return found == fields.end() ? otherwise : found->second;
}

void add_assignments(const std::string& text, const std::string& option,
                     std::map<std::string, std::string>& to) {
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string part = text.substr(begin, end - begin);
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == part.size())
      throw UsageError(
          fmt::format("{} {}: must be NAME=VALUE, several with commas between", option, quote(text)));
    if (!to.emplace(part.substr(0, equals), part.substr(equals + 1)).second)
      throw UsageError(fmt::format("{}: {} is given twice", option, quote(part.substr(0, equals))));
    begin = end + 1;
  }
}

}  // namespace vkopple
