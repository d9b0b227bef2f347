#include "train/trace.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "runtime/device.h"
#include "runtime/shader_library.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/json_io.h"
#include "train/progress.h"
#include "train/trainer.h"

namespace vkopple {
namespace {

using test::TempFolder;

/// An event of the document, in nanoseconds.
struct Event {
  int row;
  int64_t begin, end;
  std::string name, category;
  Json arguments;
  bool holds(const Event& other) const { return begin <= other.begin && other.end <= end; }
};

std::vector<Event> events_of(const Json& document) {
  std::vector<Event> events;
  for (const Json& e : document.at("traceEvents")) {
    if (e.at("ph") == "M") continue;
    EXPECT_EQ(e.at("ph"), "X");
    const int64_t begin = std::llround(e.at("ts").get<double>() * 1e3);
    events.push_back({e.at("tid"), begin, begin + std::llround(e.at("dur").get<double>() * 1e3), e.at("name"),
                      e.at("cat"), e.value("args", Json::object())});
  }
  return events;
}

/// Expects that the events of a row are in order and lie within or behind one another.
void expect_nested(const std::vector<Event>& events, int row) {
  std::vector<const Event*> open;
  int64_t last = 0;
  for (const Event& event : events) {
    if (event.row != row) continue;
    EXPECT_LE(event.begin, event.end) << event.name;
    EXPECT_LE(last, event.begin) << event.name;
    last = event.begin;
    while (!open.empty() && open.back()->end <= event.begin) open.pop_back();
    if (!open.empty()) {
      EXPECT_TRUE(open.back()->holds(event)) << event.name << " in " << open.back()->name;
    }
    open.push_back(&event);
  }
}

std::vector<Event> of_category(const std::vector<Event>& events, const std::set<std::string>& categories) {
  std::vector<Event> found;
  for (const Event& event : events)
    if (categories.contains(event.category)) found.push_back(event);
  return found;
}

int64_t total(const std::vector<Event>& events) {
  int64_t sum = 0;
  for (const Event& event : events) sum += event.end - event.begin;
  return sum;
}

/// Trains two steps and traces the second.
class TraceOfTraining : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const TempFolder folder;
    TrainerOptions options{.folder = RunFolder(folder / "run"), .data = "rooms:1", .steps = 2};
    options.eval_every = 0;
    options.profile = folder / "trace.json";
    Config config = test::tiny_config();
    config.training.stages.erase(config.training.stages.begin());  // everything from the start
    for (TrainingStage& stage : config.training.stages) stage.batch = 2;
    Trainer trainer(test_device(), config, options, false);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> sink(std::tmpfile(), &std::fclose);
    Progress progress(sink.get(), false, 2);
    ASSERT_TRUE(trainer.run(progress, [] { return false; }));
    document_ = read_json(folder / "trace.json");
    events_ = events_of(document_);
  }

  static Json document_;
  static std::vector<Event> events_;
};
Json TraceOfTraining::document_;
std::vector<Event> TraceOfTraining::events_;

TEST_F(TraceOfTraining, NamesDeviceRowsAndHostWork) {
  EXPECT_EQ(document_.at("otherData").at("device"), test_device().caps().name);
  std::set<std::string> rows;
  for (const Json& e : document_.at("traceEvents"))
    if (e.at("ph") == "M") rows.insert(e.at("args").at("name"));
  EXPECT_EQ(rows, (std::set<std::string>{"host", "device: passes", "device: ops and dispatches"}));
  std::multiset<std::string> host;
  for (const Event& event : of_category(events_, {"host"})) host.insert(event.name);
  EXPECT_EQ(host, (std::multiset<std::string>{"step", "data", "feed", "submit forward", "wait for forward",
                                              "submit backward", "wait for backward", "submit update",
                                              "wait for update", "read losses", "log and checkpoint"}));
}

TEST_F(TraceOfTraining, EventsAreOrderedAndNested) {
  for (const int row : {1, 2, 3}) expect_nested(events_, row);
  const auto steps = of_category(events_, {"host"});
  ASSERT_FALSE(steps.empty());
  EXPECT_EQ(steps.front().name, "step");
  for (const Event& event : events_) {
    if (event.category != "host") continue;
    EXPECT_TRUE(steps.front().holds(event)) << event.name;
  }
}

TEST_F(TraceOfTraining, TimesAddUp) {
  const auto passes = of_category(events_, {"pass"});
  ASSERT_EQ(passes.size(), 3U);
  for (const Event& pass : passes) {
    const auto ops = of_category(events_, {pass.name});
    ASSERT_FALSE(ops.empty()) << pass.name;
    for (const Event& op : ops) EXPECT_TRUE(pass.holds(op)) << op.name;
    // Only where a recording is cut into chunks does time pass between two ops.
    EXPECT_LE(total(ops), pass.end - pass.begin);
    EXPECT_GE(total(ops), (pass.end - pass.begin) / 2);
  }
  EXPECT_EQ(total(of_category(events_, {"forward", "backward", "update"})),
            total(of_category(events_, {"dispatch"})));
}

TEST_F(TraceOfTraining, NamesAreKnown) {
  size_t convolutions = 0;
  for (const Event& event : of_category(events_, {"dispatch"})) {
    if (event.name == "fill" || event.name == "copy") continue;
    EXPECT_NO_THROW(find_shader(event.name, test_device().caps().access)) << event.name;
  }
  for (const Event& event : of_category(events_, {"forward", "backward"})) {
    if (event.name != "conv2d") continue;
    ++convolutions;
    EXPECT_TRUE(event.arguments.at("scope").is_string());
    EXPECT_GE(event.arguments.at("inputs").size(), 2U);
    EXPECT_GT(event.arguments.at("bytes").get<uint64_t>(), 0U);
    EXPECT_GT(event.arguments.at("GFLOP/s").get<double>(), 0);
  }
  EXPECT_GT(convolutions, 10U);
}

TEST(TraceTest, WhereItCannotBeWrittenIsAnErrorThatNamesIt) {
  const TempFolder folder;
  Trace trace(Caps{});
  trace.add_host("work", Trace::Clock::now(), Trace::Clock::now());
  test::expect_error([&] { trace.write(folder / "absent" / "trace.json"); }, {"trace.json"});
}

}  // namespace
}  // namespace vkopple
