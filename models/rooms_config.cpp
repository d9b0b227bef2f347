#include "models/rooms_config.h"

namespace vkopple {

std::vector<RoomShape> RoomsConfig::every_shape() {
  std::vector<RoomShape> shapes;
  for (std::size_t i = 0; i < kRoomShapeNames.size(); ++i) shapes.push_back(static_cast<RoomShape>(i));
  return shapes;
}

RoomsConfig read_rooms_config(JsonObject object, const RoomsConfig& base) {
  RoomsConfig c = base;
  object.integer("objects", c.objects, 1, 8);
  object.numbers("size", c.size, 0.05, 1.0);
  object.number("speed", c.speed, 0, 1);
  object.number("spin", c.spin, 0, 3);
  object.number("camera_step", c.camera_step, 0, 1);
  object.number("pan", c.pan, 0, 3);
  object.choice("textures", c.textures, kRoomTexturesNames);
  object.number("room_contrast", c.room_contrast, 0, 1);
  object.boolean("sectors", c.sectors);
  object.choices("shapes", c.shapes, kRoomShapeNames);
  object.integer("frames", c.frames, 3, 100);
  object.integer("supersample", c.supersample, 1, 8);
  object.finish();
  if (c.size[0] > c.size[1])
    object.refuse("size", "has its smallest over its largest; give [smallest, largest]");
  return c;
}

nlohmann::ordered_json write_rooms_config(const RoomsConfig& c) {
  auto shapes = nlohmann::ordered_json::array();
  for (const RoomShape shape : c.shapes) shapes.push_back(kRoomShapeNames[static_cast<std::size_t>(shape)]);
  return {{"objects", c.objects},
          {"size", c.size},
          {"speed", c.speed},
          {"spin", c.spin},
          {"camera_step", c.camera_step},
          {"pan", c.pan},
          {"textures", kRoomTexturesNames[static_cast<std::size_t>(c.textures)]},
          {"room_contrast", c.room_contrast},
          {"sectors", c.sectors},
          {"shapes", shapes},
          {"frames", c.frames},
          {"supersample", c.supersample}};
}

}  // namespace vkopple
