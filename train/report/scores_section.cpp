#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "train/report/html.h"
#include "train/report/report_page.h"

namespace vkopple {
namespace {

/// docs/model.md §10.
NamedScores published() {
  return {"published*",
          {{"ARI-fg", 0.58},
           {"IoU", 0.45},
           {"depth r, mean over images", 0.92},
           {"angle r", 0.86},
           {"distance r", 0.51}}};
}

std::string number(const std::optional<double>& value) {
  if (!value) return "–";
  const std::string digits = fmt::format("{:.3f}", std::abs(*value));
  return (*value < 0 && digits != "0.000" ? "−" : "") + digits;
}

std::string cell(const NamedScores& column, const std::string& name) {
  const auto found = std::find_if(column.scores.begin(), column.scores.end(),
                                  [&](const NamedScore& score) { return score.name == name; });
  return found == column.scores.end() ? "" : number(found->value);
}

std::string table(const std::vector<NamedScores>& columns) {
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr><th scope=\"col\">score</th>";
  for (const NamedScores& column : columns)
    html += fmt::format("<th scope=\"col\" class=\"number\">{}</th>", escape_html(column.name));
  html += "</tr></thead>\n<tbody>\n";
  for (const NamedScore& row : columns.front().scores) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", escape_html(row.name));
    for (const NamedScores& column : columns)
      html += fmt::format("<td class=\"number\">{}</td>", cell(column, row.name));
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

}  // namespace

std::string scores_section(const Report& report) {
  const EvaluationScores& scores = report.held_out.scores;
  std::vector<NamedScores> columns{{"this model", scores.named()}};
  columns.insert(columns.end(), report.held_out.baselines.begin(), report.held_out.baselines.end());
  columns.push_back(published());
  std::string html = table(columns);
  html += fmt::format(
      "<p class=\"quiet\">{} images, of which {} show no object and are left out of ARI-fg and the IoU of "
      "objects. 1 is perfect everywhere. ARI-fg: adjusted Rand index over the pixels of objects, 0 by chance. "
      "IoU: intersection over union of objects and background with what they are matched with; nothing but "
      "background still gets about a quarter. r: correlation with the truth, of depth over pixels, of angle "
      "and distance over matched objects. –: undefined.</p>\n",
      scores.images(), scores.skipped());
  for (const std::string& line : scores.left_out())
    html += fmt::format("<p class=\"note\">{}</p>\n", escape_html(line));
  html +=
      "<p class=\"quiet\">Beside the model stand masks that need no learning, on the same images. background: "
      "every pixel is background; one object: every pixel is of one object; random: every pixel of a random "
      "slot or background; k-means: clusters of colour and place, as many as slots and background; truth: what "
      "true masks, depth and places get.</p>\n"
      "<p class=\"quiet\">* The model’s authors, after training on 275 thousand triplets of their own rooms, "
      "128 × 128 pixels: other images, so a rough guide and no comparison.</p>\n";
  return section_html("scores", "Scores", html);
}

}  // namespace vkopple
