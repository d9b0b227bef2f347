#include "train/report/report_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "train/report/html.h"

namespace vkopple {
namespace {

constexpr std::string_view kContents = R"(<nav aria-label="Contents">
<a href="#scores">Scores</a> <a href="#pictures">Pictures</a> <a href="#predictions">Predictions</a>
<a href="#places">Places</a> <a href="#poses">Poses</a> <a href="#training">Training</a> <a href="#origin">Origin</a>
</nav>
)";

std::string summary(const Report& report) {
  const ModelConfig& model = report.config.model;
  const TrainingPosition& at = report.position;
  return fmt::format(
      "<p>Step {} of training on {}, in the stage {} (step {} of it), seed {}; images of {} × {} pixels, {} "
      "slots for objects. Looked at with {} images of {}.</p>\n",
      at.step, escape_html(at.data), escape_html(report.config.stages().at(at.stage).name), at.stage_step,
      at.seed, model.width, model.height, model.slots, report.held_out.scores.images(),
      escape_html(report.data));
}

std::string warnings(const Report& report) {
  std::string html;
  if (report.data == report.position.data)
    html +=
        "<p class=\"note\">The model was trained on these very data: this tells nothing of what it does with "
        "new images.</p>\n";
  std::string names;
  for (const Network network : report.untrained)
    names += (names.empty() ? "" : ", ") + std::string(kNetworkNames[static_cast<std::size_t>(network)]);
  if (!names.empty())
    html += fmt::format(
        "<p class=\"note\">Networks that have not learned yet: {}. What depends on them is noise.</p>\n",
        names);
  return html;
}

}  // namespace

bool Report::has_learned(Network network) const {
  return std::find(untrained.begin(), untrained.end(), network) == untrained.end();
}

std::string report_page(const Report& report) {
  const std::string title = "Report of " + report.model;
  std::string html = fmt::format("<header>\n<h1>{}</h1>\n{}{}{}</header>\n<main>\n", escape_html(title),
                                 summary(report), warnings(report), kContents);
  for (const auto section : {scores_section, pictures_section, prediction_section, places_section,
                             poses_section, training_section, origin_section})
    html += section(report);
  return page_html(title, html + "</main>\n");
}

}  // namespace vkopple
