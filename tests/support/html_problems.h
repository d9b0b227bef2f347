#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vkopple::test {

/// What is wrong with a page: elements that are not closed or closed out of turn, attributes without quotes,
/// ids given twice, links to ids that are not there, and whatever would be fetched from elsewhere.
std::vector<std::string> html_problems(std::string_view page);

}  // namespace vkopple::test
