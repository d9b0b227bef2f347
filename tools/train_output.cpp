#include "tools/train_output.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <system_error>

#include "train/training_log.h"

namespace vkopple {

TrainOutput::TrainOutput(const Choice& choice, uint64_t total) : json_(choice.json) {
  if (!choice.quiet) progress_.emplace(total);
  // Where the reader goes away, the run is to be saved before it ends.
  if (json_) std::signal(SIGPIPE, SIG_IGN);
}

void TrainOutput::show(const StepRecord& record) {
  if (progress_) progress_->show(record);
  write(to_json(record));
}

void TrainOutput::say(std::string_view text) {
  if (progress_) progress_->say(text);
}

void TrainOutput::end(const nlohmann::ordered_json& outcome) { write(outcome); }

void TrainOutput::write(const nlohmann::ordered_json& json) {
  if (!json_ || !fault_.empty()) return;
  const std::string line = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  if (std::fputs(line.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
    fault_ = std::generic_category().message(errno);
}

}  // namespace vkopple
