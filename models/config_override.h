#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace vkopple {

/// Sets one value of a configuration's JSON, as `--set` has it: "model.reg=0.5", "model.pose_loss=js",
/// "training.stages[1].steps=100". The value is JSON, or else a text without quotes. Objects on the way are
/// made where they are absent; a list's element must be there. What the keys mean is not looked at: the reader
/// of the configuration refuses what it does not know. Throws UsageError for another form.
void override_value(nlohmann::json& root, std::string_view assignment);

}  // namespace vkopple
