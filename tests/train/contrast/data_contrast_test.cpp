#include "train/contrast/data_contrast.h"

#include <gtest/gtest.h>

#include "graph/executor.h"
#include "graph/ops/back_project.h"
#include "graph/ops/blend.h"
#include "graph/ops/image_loss.h"
#include "graph/ops/move_background.h"
#include "graph/ops/move_pixels.h"
#include "graph/ops/project.h"
#include "graph/ops/splat.h"
#include "graph/ops/warp_share.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_device.h"
#include "train/contrast/room_motion.h"

namespace vkopple {
namespace {

const Lens kLens(24, 32, 1.3);
constexpr double kBeta = 1.0;

/// One triplet of rooms with everything that is known of it.
struct Seen {
  TripletBatch batch;
  RoomTriplet room;

  KnownTriplet known() const {
    return {batch.images[1], batch.images[2], batch.depth, batch.label, room_motion(room)};
  }
};

Seen see(const RoomsConfig& rooms, uint64_t step) {
  RoomSource source(test_device(), kLens, rooms, 1, 42);
  return {source.read(step), source.scenes(step)[0]};
}

DataContrast measured(const RoomsConfig& rooms, uint64_t triplets = 2) {
  DataContrast contrast(kLens, kBeta);
  for (uint64_t step = 0; step < triplets; ++step) contrast.add(see(rooms, step).known());
  return contrast;
}

std::vector<float> floats(const Vec3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

/// An object's place, velocity and turn from the middle frame to the last as §4 of the model has them.
struct ObjectNumbers {
  std::vector<float> location, velocity, turn;
};

ObjectNumbers object_numbers(const RoomTriplet& room) {
  ObjectNumbers all;
  const auto append = [](std::vector<float>& to, const Vec3& v) {
    for (const float x : floats(v)) to.push_back(x);
  };
  const RoomCamera& camera = room.scene.cameras[static_cast<std::size_t>(room.frames[1])];
  for (const RoomObject& object : room.scene.objects) {
    const Vec3 before = camera.see(object.position(room.frames[1])),
               after = camera.see(object.position(room.frames[2]));
    append(all.location, before);
    append(all.velocity, {after[0] - before[0], after[1] - before[1], after[2] - before[2]});
    all.turn.push_back(static_cast<float>(object.yaw(room.frames[2]) - object.yaw(room.frames[1])));
  }
  return all;
}

std::vector<float> masks(const std::vector<uint32_t>& label, std::size_t objects) {
  std::vector<float> all((objects + 1) * label.size());
  for (std::size_t p = 0; p < label.size(); ++p)
    all[(label[p] == 0 ? objects : label[p] - 1) * label.size() + p] = 1;
  return all;
}

/// The loss by the model's own ops on the device.
double loss_by_ops(const Seen& seen, const std::vector<float>& depth, bool objects_move) {
  const auto objects = static_cast<int64_t>(seen.room.scene.objects.size());
  const int64_t entities = objects_move ? objects + 1 : 1;
  const auto fov = static_cast<float>(kLens.fov);
  Graph g;
  const Value image = g.input("image", row_major({1, 3, kLens.height, kLens.width}));
  const Value next = g.input("next", row_major({1, 3, kLens.height, kLens.width}));
  const Value far = g.input("depth", row_major({1, 1, kLens.height, kLens.width}));
  const Value mask = g.input("mask", row_major({1, entities, kLens.height, kLens.width}));
  const Value location = g.input("location", row_major({1, objects, 3}));
  const Value velocity = g.input("velocity", row_major({1, objects, 3}));
  const Value turn = g.input("turn", row_major({1, objects}));
  const Value m23 = g.input("m23", row_major({1, 4, 4}));
  const Value points = back_project(far, fov);
  const Value moved =
      objects_move ? move_pixels(points, location, velocity, turn, m23) : move_background(points, m23);
  const auto warp = splat(image, project(moved, fov), mask, static_cast<float>(kBeta));
  const Value loss = image_loss(blend(warp_share(warp[2], true), warp[0], image), next);
  g.keep("loss", loss);
  Executor executor(test_device(), g);
  executor.write(image, seen.batch.images[1]);
  executor.write(next, seen.batch.images[2]);
  executor.write(far, depth);
  executor.write(mask, objects_move ? masks(seen.batch.label, static_cast<std::size_t>(objects))
                                    : std::vector<float>(kLens.pixels(), 1.0F));
  if (objects_move) {
    const ObjectNumbers numbers = object_numbers(seen.room);
    executor.write(location, numbers.location);
    executor.write(velocity, numbers.velocity);
    executor.write(turn, numbers.turn);
  }
  std::vector<float> map;
  const auto pose = [&](std::size_t frame) {
    CameraPose p{};
    for (std::size_t i = 0; i < 6; ++i) p[i] = static_cast<double>(seen.batch.poses[frame][i]);
    return p;
  };
  for (const double x : relative(pose(1), pose(2))) map.push_back(static_cast<float>(x));
  executor.write(m23, map);
  executor.forward();
  return static_cast<double>(executor.read(loss)[0]);
}

TEST(DataContrast, LossesAreThoseOfTheModelsOps) {
  RoomsConfig rooms;
  rooms.spin = 0.5;
  for (const uint64_t step : {0, 1, 2}) {
    const Seen seen = see(rooms, step);
    DataContrast contrast(kLens, kBeta);
    contrast.add(seen.known());
    double sum = 0;
    for (const float d : seen.batch.depth) sum += static_cast<double>(d);
    const std::vector<float> flat(kLens.pixels(),
                                  static_cast<float>(sum / static_cast<double>(kLens.pixels())));
    const PredictionLosses losses = contrast.whole();
    EXPECT_NEAR(losses.ideal / loss_by_ops(seen, seen.batch.depth, true), 1, 1e-4);
    EXPECT_NEAR(losses.flat / loss_by_ops(seen, flat, true), 1, 1e-4);
    EXPECT_NEAR(losses.still / loss_by_ops(seen, seen.batch.depth, false), 1, 1e-4);
  }
}

TEST(DataContrast, DepthAndMovingObjectsHaveSomethingToWin) {
  const DataContrast contrast = measured(RoomsConfig{}, 6);
  for (const PredictionLosses& losses : {contrast.whole(), contrast.landed()}) {
    EXPECT_GT(losses.flat, 1.1 * losses.ideal);
    EXPECT_GT(losses.still, 1.1 * losses.ideal);
  }
  EXPECT_LT(contrast.landed().ideal, contrast.whole().ideal);
  EXPECT_GT(contrast.landed_share(), 0.4);
  EXPECT_LT(contrast.landed_share(), 1);
}

TEST(DataContrast, ObjectsThatRestHaveNothingToWin) {
  RoomsConfig rooms;
  rooms.speed = rooms.spin = 0;
  const DataContrast contrast = measured(rooms);
  const PredictionLosses losses = contrast.whole();
  EXPECT_GT(losses.ideal, 1);
  EXPECT_NEAR(contrast.ratio(losses.still, losses.ideal).value(), 1, 1e-9);
  EXPECT_GT(contrast.ratio(losses.flat, losses.ideal).value(), 1.1);
}

TEST(DataContrast, WhereNothingMovesThereIsNoRatio) {
  RoomsConfig rooms;
  rooms.speed = rooms.spin = rooms.camera_step = rooms.pan = 0;
  const DataContrast contrast = measured(rooms);
  EXPECT_NEAR(contrast.whole().ideal, 0, 1e-5);  // the projection's 1e-5 moves pixels that little
  EXPECT_NEAR(contrast.landed_share(), 1, 1e-3);
  const Json json = contrast.to_json();
  EXPECT_TRUE(json.at("ratios").at("flat").is_null());
  EXPECT_TRUE(json.at("landed").at("ratios").at("still").is_null());
  EXPECT_NE(contrast.to_text().find("0.00           -            -\n"), std::string::npos)
      << contrast.to_text();
}

/// 4 x 4 pixels, of which the sixth alone is an object; the camera rests.
struct Small {
  std::vector<float> image = std::vector<float>(48, 0.2F), next = image, depth = std::vector<float>(16, 2.0F);
  std::vector<uint32_t> label = std::vector<uint32_t>(16);
  Matrix4 rest{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, motion = rest;

  Small() {
    label[5] = 1;
    for (std::size_t c = 0; c < 3; ++c) next[16 * c + 5] = 0.7F;
  }
  KnownTriplet known() const { return {image, next, depth, label, {rest, motion}}; }
};
const Lens kSmall(4, 4, 1.5);

TEST(DataContrast, WhatNothingLandsOnIsFilledOrLeftOut) {
  Small small;
  small.motion[7] = -100;  // behind the camera
  DataContrast contrast(kSmall, kBeta);
  contrast.add(small.known());
  EXPECT_NEAR(contrast.whole().ideal, 0.75, 1e-3);
  EXPECT_NEAR(contrast.whole().still, 0.75, 1e-3);
  EXPECT_NEAR(contrast.landed_share(), 15.0 / 16, 1e-3);
  EXPECT_NEAR(contrast.landed().ideal, 0, 1e-3);
  EXPECT_NEAR(contrast.landed().still, 0, 1e-3);
}

TEST(DataContrast, MeansAndRatiosAreTold) {
  Small bright, dark;
  for (float& x : dark.next) x = 0.2F;
  DataContrast contrast(kSmall, kBeta);
  contrast.add(bright.known());
  contrast.add(dark.known());
  EXPECT_EQ(contrast.triplets(), 2);
  const Json json = contrast.to_json();
  EXPECT_EQ(json.at("triplets"), 2);
  EXPECT_NEAR(json.at("losses").at("ideal").get<double>(), 0.375, 1e-3);
  EXPECT_NEAR(json.at("ratios").at("still").get<double>(), 1, 1e-3);
  EXPECT_NEAR(json.at("landed").at("share").get<double>(), 1, 1e-3);
  EXPECT_NE(contrast.to_text().find("whole image                      0.37     0.37     0.37        1.00"),
            std::string::npos)
      << contrast.to_text();
}

TEST(DataContrast, NothingIsZero) {
  const DataContrast contrast(kSmall, kBeta);
  EXPECT_EQ(contrast.whole().flat, 0);
  EXPECT_EQ(contrast.landed_share(), 0);
  EXPECT_EQ(contrast.ratio(0, 0), std::nullopt);
}

TEST(DataContrast, RefusesWhatDoesNotFit) {
  DataContrast contrast(kSmall, kBeta);
  Small small;
  small.label[3] = 2;
  test::expect_error([&] { contrast.add(small.known()); }, {"label 2", "no motion"});
  small.label.pop_back();
  test::expect_error([&] { contrast.add(small.known()); }, {"16 pixels"});
  EXPECT_EQ(contrast.triplets(), 0);
}

}  // namespace
}  // namespace vkopple
