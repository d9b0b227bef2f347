#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/html_problems.h"
#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;
using testing::HasSubstr;
using testing::Not;

constexpr size_t kLargestPage = size_t{64} << 20;

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

class ReportCommand : public testing::Test {
 protected:
  std::string model() const { return folder_ / "model.safetensors"; }
  std::string out() const { return folder_ / "out"; }
  Outcome report(const std::string& model, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"report", model, "--out", out()};
    words.insert(words.end(), more.begin(), more.end());
    return run_vkopple(words);
  }
  /// Which must be sound.
  std::string page() const {
    const std::string text = read_text_file(folder_ / "out/index.html", kLargestPage);
    EXPECT_THAT(test::html_problems(text), testing::IsEmpty());
    EXPECT_THAT(text, Not(HasSubstr("http:")));
    EXPECT_THAT(text, Not(HasSubstr("https:")));
    for (const char* id : {"scores", "pictures", "predictions", "places", "poses", "training", "origin"})
      EXPECT_EQ(count(text, fmt::format("<section id=\"{}\">", id)), 1U) << id;
    return text;
  }

  TempFolder folder_;
};

TEST_F(ReportCommand, OfARunShowsEverything) {
  const std::string run = folder_ / "a run <&>";
  write_file(folder_ / "config.json", test::tiny_config().to_json());
  expect_success(run_vkopple({"train", folder_ / "config.json", "--data", "rooms:1", "--out", run, "--steps",
                              "7", "--batch", "2", "--eval-every", "0"}));
  const auto outcome = report(run, {"--images", "9", "--json"});
  expect_success(outcome);
  EXPECT_TRUE(outcome.errors.empty()) << outcome.errors;
  const json told = json::parse(outcome.output);
  EXPECT_EQ(told.at("page"), out() + "/index.html");
  EXPECT_EQ(told.at("scores").at("images"), 9);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out()), {}), 1);

  const std::string html = page();
  EXPECT_EQ(count(html, "src=\"data:image/png;base64,"), 6U * 5U + 4U * 7U);
  EXPECT_THAT(html, HasSubstr("a run &lt;&amp;&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("a run <&>")));
  EXPECT_THAT(html, HasSubstr(fmt::format("<td class=\"number\">{:.3f}</td>",
                                          told.at("scores").at("iou").get<double>())));
  EXPECT_THAT(html, HasSubstr("Step 7 of training on rooms:1, in the stage all (step 2 of it)"));
  for (const char* part :
       {"frame 2 left as it is", "Inferred over true angle", "Inferred over true distance",
        "Distribution over yaw, image 1", "class=\"mark\"", "total loss over the steps", "pose, nats",
        ">depth</text>", ">all</text>", "--data rooms:9001 --images 9", "&quot;bins&quot;: 12"})
    EXPECT_THAT(html, HasSubstr(part));
  EXPECT_THAT(html, Not(HasSubstr("Nothing to show")));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
  expect_success(report(run, {"--images", "9"}));
  EXPECT_EQ(page(), html);
}

TEST_F(ReportCommand, OfDepthAloneSaysWhatIsMissing) {
  test::write_tiny_model(model(), 0);
  const auto outcome = report(model(), {"--images", "2", "--data", "rooms:7"});
  expect_success(outcome);
  EXPECT_THAT(outcome.output, HasSubstr("index.html\nARI-fg"));
  EXPECT_THAT(outcome.errors, HasSubstr("was trained on rooms:7"));
  EXPECT_THAT(outcome.errors, HasSubstr("networks that have not learned yet at step 4"));
  const std::string html = page();
  EXPECT_EQ(count(html, "src=\"data:image/png;base64,"), 2U * 4U + 2U * 7U);
  for (const char* part :
       {"trained on these very data", "not learned yet: object, imagination", "there is no log of a run",
        "Nothing to show: the object network has not learned yet"})
    EXPECT_THAT(html, HasSubstr(part));
}

TEST_F(ReportCommand, WithoutCamerasNothingIsPredicted) {
  test::write_tiny_model(model());
  const auto outcome =
      report(model(), {"--data", std::string(VKOPPLE_SOURCE_DIR) + "/tests/fixtures/records-clevr.tfrecord"});
  expect_success(outcome);
  EXPECT_THAT(outcome.errors, HasSubstr("1 of 64 images scored"));
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("do not tell where the camera was"));
  EXPECT_THAT(html, HasSubstr("no object whose place is known was matched with a slot"));
  EXPECT_THAT(html, HasSubstr("1 of 1 images have no true depth"));
}

TEST_F(ReportCommand, RotationsIn3dHaveNoDistribution) {
  Config config = test::tiny_config();
  config.model.orientation = Orientation::kEuler;
  test::write_model(model(), config);
  expect_success(report(model(), {"--images", "2"}));
  EXPECT_THAT(page(), HasSubstr("a model of 3D rotation gives a single rotation"));
}

TEST_F(ReportCommand, RefusesWrongUse) {
  test::write_tiny_model(model());
  expect_failure(run_vkopple({"report", model()}), 2, {"--out"});
  expect_failure(report(model(), {"--images", "0"}), 2, {"--images"});
  expect_failure(report(model(), {"--data", "rooms:x"}), 2, {"rooms:x"});
  expect_failure(report(folder_ / "absent"), 1, {"absent"});
  write_file(folder_ / "log.jsonl", "{}\n");
  expect_failure(report(model()), 1, {"log.jsonl: line 1"});
  EXPECT_FALSE(std::filesystem::exists(out()));
}

TEST(HtmlProblems, AreFound) {
  const auto problems = [](const std::string& page) { return test::html_problems(page); };
  EXPECT_TRUE(
      problems("<!DOCTYPE html>\n<p id=\"a\"><img src=\"data:,\" alt=\"\"><a href=\"#a\">x</a></p>").empty());
  for (const char* wrong :
       {"<p>", "<p></a></p>", "<p><b></p></b>", "<p id=a></p>", "<img src=\"x.png\">", "<a href=\"//x\"></a>",
        "<a href=\"#b\"></a>", "<p id=\"a\"></p><p id=\"a\"></p>", "<script></script>",
        "<style>@import 'x'</style>", "<p onclick=\"x\"></p>", "a > b"})
    EXPECT_FALSE(problems(wrong).empty()) << wrong;
}

}  // namespace
}  // namespace vkopple
