#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace vkopple {

bool is_terminal(std::FILE* stream);

/// Whether what is written there may have colours: it is a terminal that knows them (TERM is not "dumb"), and
/// the variable NO_COLOR is empty or not set (https://no-color.org).
bool may_have_colours(std::FILE* stream);

/// Colours for parts of a terminal's line, or none.
class Colours {
 public:
  explicit Colours(bool on) : on_(on) {}

  std::string stage(std::string_view text) const { return coloured(text, "36"); }  ///< cyan
  std::string score(std::string_view text) const { return coloured(text, "32"); }  ///< green

 private:
  std::string coloured(std::string_view text, std::string_view code) const;

  bool on_;
};

}  // namespace vkopple
