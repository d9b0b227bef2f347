#include "tools/stage_rooms.h"

#include <fmt/format.h>

#include "runtime/error.h"

namespace vkopple {

RoomsConfig rooms_of_stage(const Config& config, const std::string& name) {
  std::string known;
  for (const TrainingStage& stage : config.stages()) {
    if (stage.name == name) return stage.rooms;
    known += (known.empty() ? "" : ", ") + stage.name;
  }
  throw UsageError(fmt::format("--stage {}: the configuration has no such stage; it has {}", name, known));
}

}  // namespace vkopple
