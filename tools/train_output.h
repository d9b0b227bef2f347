#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "train/progress.h"
#include "train/training_listener.h"

namespace vkopple {

/// What `train` tells: progress on standard error unless it is to be quiet and, where JSON is wanted, an object
/// a line on standard output: those of the run's log, then one that tells what became of the run.
class TrainOutput final : public TrainingListener {
 public:
  struct Choice {
    bool quiet = false;
    bool json = false;
  };
  TrainOutput(const Choice& choice, uint64_t total);

  void show(const StepRecord& record) override;
  void say(std::string_view text) override;
  /// The last object.
  void end(const nlohmann::ordered_json& outcome);

  /// Why no more JSON can be written, empty while it can.
  const std::string& fault() const { return fault_; }

 private:
  void write(const nlohmann::ordered_json& json);

  std::optional<Progress> progress_;
  bool json_;
  std::string fault_;
};

}  // namespace vkopple
