#include <fmt/format.h>
#include <vulkan/vulkan.h>

#include <utility>

#include "train/report/html.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

std::string api_version(uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

}  // namespace

std::string origin_section(const Report& report) {
  const std::vector<std::pair<std::string, std::string>> rows{
      {"model", report.model},          {"images", report.data},
      {"vkopple", report.version},      {"device", report.device.name},
      {"driver", report.device.driver}, {"Vulkan", api_version(report.device.api_version)}};
  std::string html = "<table class=\"words\"><tbody>\n";
  for (const auto& [name, value] : rows)
    html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, escape_html(value));
  html += fmt::format("</tbody></table>\n<h3>Command</h3>\n<pre class=\"wrap\">{}</pre>\n",
                      escape_html(report.command));
  html += fmt::format(
      "<h3>Configuration</h3>\n<details><summary>All of it, as the model carries it</summary>\n<pre "
      "tabindex=\"0\">{}</pre></details>\n",
      escape_html(report.config.to_json()));
  return section_html("origin", "Where this comes from", html);
}

}  // namespace vkopple
