#include "train/rooms/generate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "train/atomic_file.h"
#include "train/data/open_source.h"
#include "train/image_io.h"
#include "train/json_io.h"
#include "train/rooms/room_source.h"
#include "train/shards.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

const Lens kLens(12, 16, 1.4);

GenerateOptions options(const std::filesystem::path& folder, uint64_t scenes) {
  GenerateOptions o{.folder = folder, .scenes = scenes, .seed = 5, .lens = kLens};
  o.rooms.frames = 5;
  o.scenes_per_shard = 4;
  return o;
}

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  return read_file(path, std::size_t{1} << 24);
}

TEST(Generate, TheSameBytesForTheSameSeed) {
  const TempFolder folder;
  std::vector<uint64_t> told;
  generate_rooms(test_device(), options(folder / "a", 10), [&](uint64_t done) { told.push_back(done); });
  generate_rooms(test_device(), options(folder / "b", 10));
  EXPECT_EQ(told.size(), 10U);
  EXPECT_EQ(told.back(), 10U);
  for (const char* name : {"rooms-000000.tar", "rooms-000001.tar", "rooms-000002.tar"}) {
    EXPECT_EQ(bytes_of(folder / "a" / name), bytes_of(folder / "b" / name)) << name;
  }
  // The first scenes are the same however many follow.
  generate_rooms(test_device(), options(folder / "c", 4));
  EXPECT_EQ(bytes_of(folder / "a" / "rooms-000000.tar"), bytes_of(folder / "c" / "rooms-000000.tar"));
  GenerateOptions other = options(folder / "d", 4);
  other.seed = 6;
  generate_rooms(test_device(), other);
  EXPECT_NE(bytes_of(folder / "c" / "rooms-000000.tar"), bytes_of(folder / "d" / "rooms-000000.tar"));
  expect_error([&] { generate_rooms(test_device(), options(folder / "a", 1)); }, {"holds rooms-00000"});
}

TEST(Generate, ASampleHoldsTheScene) {
  const TempFolder folder;
  const GenerateOptions o = options(folder / "a", 3);
  generate_rooms(test_device(), o);
  ShardReader reader(o.folder);
  for (uint64_t index = 0; index < 3; ++index) {
    const auto sample = reader.next();
    ASSERT_TRUE(sample);
    EXPECT_EQ(sample->key, fmt::format("{:06}", index));
    EXPECT_EQ(sample->parts.size(), 11U);
    const Scene scene = sample_scene(o.rooms, kLens.half_view(), o.seed, index);
    const auto& text = sample->part("json");
    const Json json = parse_json({reinterpret_cast<const char*>(text.data()), text.size()}, "scene");
    ASSERT_EQ(json["frames"].size(), 5U);
    ASSERT_EQ(json["objects"].size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& now = json["frames"][3]["objects"][i]["location"];
      const auto& next = json["frames"][4]["objects"][i]["location"];
      const auto& velocity = json["objects"][i]["velocity"];
      EXPECT_EQ(now.get<Vec3>(), scene.objects[i].position(3));
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(now[k].get<double>() + velocity[k].get<double>(), next[k].get<double>(), 1e-12);
      }
      EXPECT_EQ(json["objects"][i]["shape"], kRoomShapeNames[static_cast<std::size_t>(scene.objects[i].shape)]);
    }
    EXPECT_EQ(json["frames"][2]["camera"][3], scene.cameras[2].yaw);
    const DepthAndIds layers = decode_exr(sample->part("4.exr"), "exr");
    EXPECT_EQ(layers.ids.height, 12);
    EXPECT_EQ(layers.ids.width, 16);
    uint64_t shown = 0;
    for (const uint32_t id : layers.ids.pixels) shown += id == 1;
    EXPECT_EQ(json["frames"][4]["objects"][0]["pixels"], shown);
  }
}

TEST(Generate, TheSameInGroupsOfAnySize) {
  const TempFolder folder;
  generate_rooms(test_device(), options(folder / "a", 4));
  for (const uint64_t views : {1, 2, 7, 11}) {
    GenerateOptions o = options(folder / fmt::format("{}", views), 4);
    o.pixels_at_once = views * kLens.pixels();
    generate_rooms(test_device(), o);
    EXPECT_EQ(bytes_of(o.folder / "rooms-000000.tar"), bytes_of(folder / "a" / "rooms-000000.tar")) << views;
  }
}

TEST(Generate, ReadBackItIsWhatWasDrawn) {
  const TempFolder folder;
  GenerateOptions o = options(folder / "a", 4);
  o.rooms.frames = 3;  // one triplet a scene: both sources must choose the same
  generate_rooms(test_device(), o);
  const auto drawn = open_triplets(test_device(), "rooms:5", kLens, o.rooms, 4, {});
  const auto stored =
      open_triplets(test_device(), o.folder, kLens, o.rooms, 4, {.reading = Reading::kEvaluation});
  const TripletBatch a = drawn->read(0), b = stored->read(0);
  for (std::size_t frame = 0; frame < 3; ++frame) {
    ASSERT_EQ(a.images[frame].size(), b.images[frame].size());
    for (std::size_t i = 0; i < a.images[frame].size(); ++i)
      EXPECT_NEAR(a.images[frame][i], b.images[frame][i], 0.502 / 255);
  }
  EXPECT_EQ(a.poses, b.poses);
  EXPECT_EQ(a.depth, b.depth);
  EXPECT_EQ(a.label, b.label);
  ASSERT_EQ(b.objects.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(b.objects[i].size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(a.objects[i][k].location, b.objects[i][k].location);
      EXPECT_EQ(a.objects[i][k].pixels, b.objects[i][k].pixels);
    }
  }
}

TEST(OpenTriplets, RefusesASeedThatIsNone) {
  for (const char* data : {"rooms:", "rooms:x", "rooms:-1", "rooms:1x", "rooms:99999999999999999999"}) {
    EXPECT_THROW(open_triplets(test_device(), data, kLens, RoomsConfig{}, 1, {}), UsageError) << data;
  }
  expect_error([] { open_triplets(test_device(), "/nowhere", kLens, RoomsConfig{}, 1, {}); }, {"/nowhere"});
}

}  // namespace
}  // namespace vkopple
