#include "tests/support/tiny_model.h"

#include "tests/support/test_device.h"
#include "train/checkpoint.h"

namespace vkopple::test {

Config tiny_config() {
  return Config::parse(R"({
    "model": {"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
              "imagine_width": 1, "lstm": 4},
    "training": {"stages": [{"name": "depth", "networks": ["depth"], "hypotheses": "background", "steps": 5},
                            {"name": "all"}]},
    "rooms": {"frames": 3}})",
                       "tiny");
}

void write_model(const std::filesystem::path& path, const Config& config, uint64_t stage) {
  ModelStore store(test_device(), config.model);
  store.initialise(3);
  save_checkpoint(path, store, config,
                  {.step = 4 + 5 * stage, .stage = stage, .stage_step = 4, .seed = 3, .data = "rooms:7"});
}

void write_tiny_model(const std::filesystem::path& path, uint64_t stage) {
  write_model(path, tiny_config(), stage);
}

}  // namespace vkopple::test
