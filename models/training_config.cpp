#include "models/training_config.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vkopple {
namespace {

constexpr double kSmallestRate = 1e-12;
constexpr std::size_t kMostStages = 100;

/// What a stage takes over from its surroundings.
struct StageDefaults {
  const TrainingConfig& training;
  const ModelConfig& model;
  const RoomsConfig& rooms;
};

TrainingStage read_stage(JsonObject object, const StageDefaults& defaults) {
  TrainingStage s;
  s.networks = networks_of(defaults.model);
  s.learning_rate = defaults.training.learning_rate;
  s.batch = defaults.training.batch;
  s.accumulate = defaults.training.accumulate;
  object.text("name", s.name);
  object.choices("networks", s.networks, kNetworkNames);
  if (s.learns(Network::kMotion) && !defaults.model.relaxed)
    object.refuse("networks", "has motion, which is learned only where model.relaxed is true");
  object.choice("hypotheses", s.hypotheses, kHypothesesNames);
  if (s.hypotheses == Hypotheses::kBackground && s.networks != std::vector{Network::kDepth})
    object.refuse("networks", "must be [\"depth\"] where only the background's hypothesis warps");
  std::int64_t steps = 0;
  object.integer("steps", steps, 1, 1'000'000'000'000);
  if (steps > 0) s.steps = steps;
  object.number("learning_rate", s.learning_rate, kSmallestRate, 1);
  object.integer("warmup", s.warmup, 0, 1'000'000'000);
  const auto optional = [&](const char* key, std::optional<double>& value, double most) {
    double given = 0;
    object.number(key, given, 0, most);
    if (object.has(key)) value = given;
  };
  optional("final_learning_rate", s.final_learning_rate, 1);
  if (s.final_learning_rate && !s.steps)
    object.refuse("final_learning_rate", "needs the stage's steps, at whose end it is reached; give them");
  optional("reg", s.reg, 1e6);
  optional("slot_contrast", s.slot_contrast, 1000);
  int slots = 0;
  object.integer("slots", slots, 1, kMostSlots);
  if (slots > 0) s.slots = slots;
  object.integer("batch", s.batch, 1, kLargestBatch);
  object.integer("accumulate", s.accumulate, 1, kLargestBatch);
  s.rooms = read_rooms_config(object.object("rooms"), defaults.rooms);
  object.finish();
  const bool plain = std::all_of(s.name.begin(), s.name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!plain || s.name.empty() || s.name.size() > 40) {
    object.refuse("name", "is no name of a stage; give 1 to 40 of a-z, 0-9, _ and -");
  }
  return s;
}

nlohmann::ordered_json write_stage(const TrainingStage& s, int accumulate, const RoomsConfig& rooms) {
  nlohmann::ordered_json networks = nlohmann::ordered_json::array();
  for (const Network network : s.networks) networks.push_back(kNetworkNames[static_cast<std::size_t>(network)]);
  nlohmann::ordered_json result{{"name", s.name},
                                {"networks", networks},
                                {"hypotheses", kHypothesesNames[static_cast<std::size_t>(s.hypotheses)]}};
  if (s.steps) result["steps"] = *s.steps;
  result["learning_rate"] = s.learning_rate;
  // Left out where they say nothing: checkpoints stay as they were before there were schedules.
  if (s.warmup > 0) result["warmup"] = s.warmup;
  if (s.final_learning_rate) result["final_learning_rate"] = *s.final_learning_rate;
  if (s.reg) result["reg"] = *s.reg;
  if (s.slot_contrast) result["slot_contrast"] = *s.slot_contrast;
  if (s.slots) result["slots"] = *s.slots;
  result["batch"] = s.batch;
  if (s.accumulate != accumulate) result["accumulate"] = s.accumulate;
  const nlohmann::ordered_json base = write_rooms_config(rooms);
  const nlohmann::ordered_json mine = write_rooms_config(s.rooms);
  auto overrides = nlohmann::ordered_json::object();
  for (const auto& [key, value] : mine.items()) {
    if (value != base.at(key)) overrides[key] = value;
  }
  result["rooms"] = overrides;
  return result;
}

void read_stages(JsonObject& object, TrainingConfig& c, const ModelConfig& model, const RoomsConfig& rooms) {
  const StageDefaults defaults{c, model, rooms};
  std::vector<JsonObject> listed = object.objects("stages", kMostStages);
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const TrainingStage stage = read_stage(listed[i], defaults);
    const bool taken =
        std::any_of(c.stages.begin(), c.stages.end(), [&](const auto& s) { return s.name == stage.name; });
    if (taken) listed[i].refuse("name", "is another stage's too; give each its own");
    if (!stage.steps && i + 1 < listed.size()) {
      listed[i].refuse("steps", "is missing; only the last stage may go on without end");
    }
    c.stages.push_back(stage);
  }
}

}  // namespace

bool TrainingStage::learns(Network network) const {
  return std::find(networks.begin(), networks.end(), network) != networks.end();
}

ModelConfig TrainingStage::model_in(ModelConfig model) const {
  model.reg = reg.value_or(model.reg);
  model.slot_contrast = slot_contrast.value_or(model.slot_contrast);
  model.slots = slots.value_or(model.slots);
  return model;
}

double TrainingStage::learning_rate_at(std::uint64_t step) const {
  double rate = learning_rate;
  if (final_learning_rate && steps) {
    const double done = std::min(1.0, static_cast<double>(step) / static_cast<double>(*steps));
    rate = *final_learning_rate +
           (learning_rate - *final_learning_rate) * (1 + std::cos(std::numbers::pi * done)) / 2;
  }
  const auto warm = static_cast<double>(warmup);
  return warmup > 0 ? rate * std::min(1.0, (static_cast<double>(step) + 1) / warm) : rate;
}

std::vector<Network> networks_of(const ModelConfig& model) {
  std::vector<Network> networks{Network::kDepth, Network::kObject, Network::kImagination};
  if (model.relaxed) networks.push_back(Network::kMotion);
  return networks;
}

TrainingConfig read_training_config(JsonObject object, const ModelConfig& model, const RoomsConfig& rooms) {
  TrainingConfig c;
  object.integer("batch", c.batch, 1, kLargestBatch);
  object.integer("accumulate", c.accumulate, 1, kLargestBatch);
  object.number("learning_rate", c.learning_rate, kSmallestRate, 1);
  object.numbers("betas", c.betas, 0, 0.999999);
  object.number("epsilon", c.epsilon, 1e-12, 1);
  JsonObject clip = object.object("clip");
  clip.number("depth", c.clip.depth, 1e-9, 1e9);
  clip.number("object", c.clip.object, 1e-9, 1e9);
  clip.number("imagination", c.clip.imagination, 1e-9, 1e9);
  clip.number("motion", c.clip.motion, 1e-9, 1e9);
  clip.finish();
  object.choice("precision", c.precision, kPrecisionNames);
  object.boolean("sync_batch_norm", c.sync_batch_norm);
  object.number("reverse_probability", c.reverse_probability, 0, 1);
  read_stages(object, c, model, rooms);
  object.finish();
  return c;
}

nlohmann::ordered_json write_training_config(const TrainingConfig& c, const RoomsConfig& rooms) {
  auto stages = nlohmann::ordered_json::array();
  for (const TrainingStage& stage : c.stages) stages.push_back(write_stage(stage, c.accumulate, rooms));
  nlohmann::ordered_json result{{"batch", c.batch},
                                {"learning_rate", c.learning_rate},
                                {"betas", c.betas},
                                {"epsilon", c.epsilon},
                                {"clip",
                                 {{"depth", c.clip.depth},
                                  {"object", c.clip.object},
                                  {"imagination", c.clip.imagination},
                                  {"motion", c.clip.motion}}}};
  // Left out where it is the default: checkpoints of float32 stay as they were before there was a choice.
  if (c.precision != Precision::kFloat32)
    result["precision"] = kPrecisionNames[static_cast<std::size_t>(c.precision)];
  if (c.accumulate != 1) result["accumulate"] = c.accumulate;
  if (c.sync_batch_norm) result["sync_batch_norm"] = true;
  result["reverse_probability"] = c.reverse_probability;
  result["stages"] = stages;
  return result;
}

}  // namespace vkopple
