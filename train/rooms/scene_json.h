#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "train/rooms/renderer.h"

namespace vkopple {

/// A scene as its data set's JSON part has it (docs/data.md). pixels[frame][object]: how many show the object.
nlohmann::ordered_json scene_json(const Scene& scene, const Lens& lens,
                                  const std::vector<std::vector<uint64_t>>& pixels);

}  // namespace vkopple
