#include "tests/support/tiny_run.h"

#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "tests/support/test_device.h"
#include "train/atomic_file.h"
#include "train/resume_point.h"
#include "train/trainer.h"

namespace vkopple::test {
namespace {

constexpr size_t kLargestFile = size_t{64} << 20;

class Counting final : public TrainingListener {
 public:
  explicit Counting(uint64_t* shown) : shown_(shown) {}
  void show(const StepRecord&) override {
    if (shown_ != nullptr) ++*shown_;
  }
  void say(std::string_view) override {}

 private:
  uint64_t* shown_;
};

}  // namespace

Config TinyRun::config() {
  return Config::parse(R"({
      "model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4, "imagine_width": 1, "lstm": 4},
      "training": {"batch": 2, "stages": [{"networks": ["depth"], "hypotheses": "background"}]},
      "rooms": {"supersample": 1}})",
                       "tiny run");
}

bool TinyRun::train(FileSystem& files, uint64_t* shown, const std::function<bool()>& stop) const {
  TrainerOptions options{.folder = RunFolder(folder), .data = "rooms:1", .steps = steps, .seed = 9};
  options.checkpoint_every = 1;
  options.keep = keep;
  options.eval_every = eval_every;
  options.max_bad_steps = max_bad_steps;
  options.files = &files;
  const bool resume = options.folder.holds_checkpoint();
  if (resume) options.checkpoint = find_resume_point(options.folder);
  Trainer trainer(test_device(), config(), options, resume);
  Counting listener(shown);
  return trainer.run(listener, stop);
}

std::map<std::string, std::vector<std::byte>> remains_of(const std::filesystem::path& run) {
  std::map<std::string, std::vector<std::byte>> all;
  for (const auto& entry : std::filesystem::directory_iterator(run))
    if (entry.path().filename().string().find(".safetensors") != std::string::npos)
      all[entry.path().filename().string()] = read_file(entry.path(), kLargestFile);
  std::ifstream log(RunFolder(run).log());
  std::string line;
  for (int number = 1; std::getline(log, line); ++number) {
    auto json = nlohmann::json::parse(line);
    json.erase("seconds");
    json.erase("data_seconds");
    const std::string text = json.dump();
    const auto bytes = std::as_bytes(std::span(text));
    all["log " + std::to_string(number)] = {bytes.begin(), bytes.end()};
  }
  return all;
}

}  // namespace vkopple::test
