#pragma once

#include <string>
#include <string_view>

namespace vkopple {

/// Text as one word of a command line: in single quotes where a shell would see something in it.
std::string shell_word(std::string_view text);

}  // namespace vkopple
