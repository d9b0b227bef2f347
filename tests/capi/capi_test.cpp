#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "capi/vkopple.h"
#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/image_io.h"
#include "train/run_folder.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{1} << 20;

struct FreeModel {
  void operator()(vkopple_model* model) const { vkopple_free(model); }
};
struct FreeSeen {
  void operator()(vkopple_seen* seen) const { vkopple_seen_free(seen); }
};
using ModelPointer = std::unique_ptr<vkopple_model, FreeModel>;
using SeenPointer = std::unique_ptr<vkopple_seen, FreeSeen>;

ModelPointer load(const std::string& path, const vkopple_options* options = nullptr) {
  vkopple_model* model = nullptr;
  EXPECT_EQ(vkopple_load(path.c_str(), options, &model), VKOPPLE_OK) << vkopple_last_error();
  return ModelPointer(model);
}

SeenPointer see(vkopple_model* model, const vkopple_image& image) {
  vkopple_seen* seen = nullptr;
  EXPECT_EQ(vkopple_see(model, &image, &seen), VKOPPLE_OK) << vkopple_last_error();
  return SeenPointer(seen);
}

void expect_message(const std::vector<std::string>& parts) {
  const std::string message = vkopple_last_error();
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << "no '" << part << "' in: " << message;
}

/// Bytes of every value, 40 rows of 23 pixels with `gap` bytes between them.
struct Picture {
  static constexpr int32_t kHeight = 40, kWidth = 23;
  static constexpr size_t kRow = 3 * kWidth;

  explicit Picture(size_t gap = 0) : stride(kRow + gap), bytes(stride * kHeight, uint8_t{77}) {
    for (size_t y = 0; y < kHeight; ++y)
      for (size_t i = 0; i < kRow; ++i)
        bytes[y * stride + i] = static_cast<uint8_t>((7 * y * kRow + 5 * i) % 256);
  }
  vkopple_image description() const { return {bytes.data(), kHeight, kWidth, stride, VKOPPLE_RGB8}; }
  RgbImage rgb() const {
    RgbImage image(kHeight, kWidth);
    for (size_t y = 0; y < kHeight; ++y)
      for (size_t i = 0; i < kRow; ++i)
        image.pixels[(i % 3 * kHeight + y) * kWidth + i / 3] =
            static_cast<float>(bytes[y * stride + i]) / 255.0F;
    return image;
  }

  size_t stride;
  std::vector<uint8_t> bytes;
};

constexpr size_t kPixels = size_t{Picture::kHeight} * size_t{Picture::kWidth};

/// All that was seen, for comparing bit by bit.
std::vector<std::byte> all_of(const vkopple_seen* seen) {
  std::vector<std::byte> all;
  const auto add = [&](const void* data, size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(data);
    all.insert(all.end(), begin, begin + bytes);
  };
  add(vkopple_seen_mask(seen), kPixels * sizeof(uint32_t));
  add(vkopple_seen_depth(seen), kPixels * sizeof(float));
  size_t objects = 0, bins = 0;
  const vkopple_object* object = vkopple_seen_objects(seen, &objects);
  add(object, objects * sizeof(vkopple_object));
  for (size_t k = 0; k < objects; ++k) {
    const double* pose = vkopple_seen_pose(seen, k, &bins);
    add(pose, bins * sizeof(double));
  }
  return all;
}

class CInterface : public testing::Test {
 protected:
  CInterface() { test::write_tiny_model(path()); }
  std::string path() const { return folder_ / "model.safetensors"; }
  TempFolder folder_;
};

TEST_F(CInterface, SeesWhatInferSees) {
  const Picture picture(5);
  write_png(folder_ / "room.png", picture.rgb());
  const auto outcome =
      test::run_vkopple({"infer", path(), folder_ / "room.png", "--json", "--out", folder_ / "out"});
  test::expect_success(outcome);
  const json told = json::parse(outcome.output).at(0);

  const ModelPointer model = load(path());
  const SeenPointer seen = see(model.get(), picture.description());
  int32_t height = 0, width = 0;
  vkopple_seen_size(seen.get(), &height, &width);
  EXPECT_EQ(height, 40);
  EXPECT_EQ(width, 23);
  double share = -1;
  EXPECT_EQ(vkopple_seen_background(seen.get(), &share), told.at("background").at("index"));
  EXPECT_EQ(share, told.at("background").at("share"));
  size_t count = 0;
  const vkopple_object* objects = vkopple_seen_objects(seen.get(), &count);
  ASSERT_EQ(count, told.at("objects").size());
  ASSERT_EQ(count, 2U);
  for (size_t k = 0; k < count; ++k) {
    const json& object = told.at("objects").at(k);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(objects[k].location[i], object.at("location").at(i));
    EXPECT_EQ(objects[k].angle, object.at("angle"));
    EXPECT_EQ(objects[k].distance, object.at("distance"));
    EXPECT_EQ(objects[k].yaw, object.at("yaw"));
    EXPECT_EQ(objects[k].yaw_probability, object.at("yaw_probability"));
    EXPECT_EQ(objects[k].share, object.at("share"));
  }
  const auto depth = decode_exr(read_file(folder_ / "out/room.depth.exr", kLargestFile), "depth").depth;
  EXPECT_EQ(0, std::memcmp(depth.pixels.data(), vkopple_seen_depth(seen.get()), kPixels * sizeof(float)));
  const RgbImage mask = read_rgb(folder_ / "out/room.mask.png");
  const uint32_t* indices = vkopple_seen_mask(seen.get());
  for (size_t i = 0; i < kPixels; ++i) ASSERT_EQ(std::lround(255 * mask.pixels[i]), indices[i]) << i;
}

TEST_F(CInterface, FloatsInAnyPlaceGiveTheSame) {
  const ModelPointer model = load(path());
  const Picture tight, wide(5);
  const auto expected = all_of(see(model.get(), tight.description()).get());
  EXPECT_TRUE(all_of(see(model.get(), wide.description()).get()) == expected);
  vkopple_image described = tight.description();
  described.stride = 0;
  EXPECT_TRUE(all_of(see(model.get(), described).get()) == expected);

  // Not even aligned.
  const RgbImage rgb = tight.rgb();
  constexpr size_t kFloatRow = Picture::kRow * sizeof(float) + 3;
  std::vector<std::byte> floats(1 + kFloatRow * Picture::kHeight);
  for (size_t y = 0; y < Picture::kHeight; ++y)
    for (size_t i = 0; i < Picture::kRow; ++i)
      std::memcpy(&floats[1 + y * kFloatRow + i * sizeof(float)],
                  &rgb.pixels[(i % 3 * Picture::kHeight + y) * Picture::kWidth + i / 3], sizeof(float));
  described = {&floats[1], Picture::kHeight, Picture::kWidth, kFloatRow, VKOPPLE_RGB_FLOAT32};
  const SeenPointer seen = see(model.get(), described);
  // 1 / 255 is rounded once more where bytes are scaled.
  const float* depth = vkopple_seen_depth(seen.get());
  std::vector<float> of_bytes(kPixels);
  std::memcpy(of_bytes.data(), expected.data() + kPixels * sizeof(uint32_t), kPixels * sizeof(float));
  for (size_t i = 0; i < kPixels; ++i) ASSERT_NEAR(depth[i], of_bytes[i], 1e-5) << i;
}

TEST_F(CInterface, ProbabilitiesAddUp) {
  const ModelPointer model = load(path());
  const Picture picture;
  const SeenPointer seen = see(model.get(), picture.description());
  size_t count = 0, bins = 0, planes = 0;
  const vkopple_object* objects = vkopple_seen_objects(seen.get(), &count);
  for (size_t k = 0; k < count; ++k) {
    const double* pose = vkopple_seen_pose(seen.get(), k, &bins);
    ASSERT_EQ(bins, 12U);
    double sum = 0;
    for (size_t i = 0; i < bins; ++i) sum += pose[i];
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_EQ(vkopple_seen_rotation(seen.get(), k), nullptr);
    EXPECT_EQ(pose[std::lround(objects[k].yaw / (2 * M_PI / 12))], objects[k].yaw_probability);
  }
  EXPECT_EQ(vkopple_seen_pose(seen.get(), count, &bins), nullptr);
  EXPECT_EQ(bins, 0U);
  int32_t height = 0, width = 0;
  const float* masks = vkopple_seen_soft_masks(seen.get(), &planes, &height, &width);
  ASSERT_EQ(planes, 3U);
  ASSERT_EQ(height, 16);
  ASSERT_EQ(width, 16);
  for (size_t i = 0; i < 256; ++i) EXPECT_NEAR(masks[i] + masks[256 + i] + masks[512 + i], 1, 1e-5) << i;
}

TEST_F(CInterface, TwoThreadsWithAModelEachSeeWhatOneSees) {
  const Picture picture;
  std::vector<std::byte> expected;
  {
    const ModelPointer model = load(path());
    expected = all_of(see(model.get(), picture.description()).get());
  }
  constexpr int kImages = 3;
  bool same[2] = {false, false};
  const auto work = [&](bool& result) {
    const ModelPointer model = load(path());
    bool all = model != nullptr;
    for (int i = 0; all && i < kImages; ++i)
      all = all_of(see(model.get(), picture.description()).get()) == expected;
    result = all;
  };
  std::thread first(work, std::ref(same[0])), second(work, std::ref(same[1]));
  first.join();
  second.join();
  EXPECT_TRUE(same[0]);
  EXPECT_TRUE(same[1]);
}

TEST_F(CInterface, SeenThingsOutliveTheirModel) {
  ModelPointer model = load(path());
  const Picture picture;
  const SeenPointer first = see(model.get(), picture.description());
  const auto before = all_of(first.get());
  Picture other;
  for (uint8_t& byte : other.bytes) byte = static_cast<uint8_t>(255 - byte);
  EXPECT_FALSE(all_of(see(model.get(), other.description()).get()) == before);
  model.reset();
  EXPECT_TRUE(all_of(first.get()) == before);
}

TEST_F(CInterface, ModelsOfDepthAlone) {
  test::write_tiny_model(path(), 0);
  const ModelPointer model = load(path());
  const Picture picture;
  const SeenPointer seen = see(model.get(), picture.description());
  size_t count = 9, planes = 9;
  EXPECT_EQ(vkopple_seen_objects(seen.get(), &count), nullptr);
  EXPECT_EQ(count, 0U);
  EXPECT_EQ(vkopple_seen_soft_masks(seen.get(), &planes, nullptr, nullptr), nullptr);
  EXPECT_EQ(planes, 0U);
  double share = 0;
  EXPECT_EQ(vkopple_seen_background(seen.get(), &share), 2U);
  EXPECT_EQ(share, 1);
  EXPECT_GT(vkopple_seen_depth(seen.get())[0], 0);
}

TEST_F(CInterface, TellsOfTheModelAndOfARunsLatest) {
  const RunFolder run(folder_ / "run");
  run.create();
  test::write_tiny_model(run.latest());
  vkopple_options options{sizeof(vkopple_options), nullptr, VKOPPLE_MIXED};
  const ModelPointer model = load(run.path(), &options);
  vkopple_model_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(vkopple_get_model_info(model.get(), &info), VKOPPLE_OK) << vkopple_last_error();
  EXPECT_EQ(info.height, 16);
  EXPECT_EQ(info.width, 16);
  EXPECT_EQ(info.slots, 2);
  EXPECT_EQ(info.bins, 12);
  EXPECT_EQ(info.sees_objects, 1);
  EXPECT_DOUBLE_EQ(info.fov, M_PI / 2);
  EXPECT_DOUBLE_EQ(info.max_depth, 7.2);
  EXPECT_EQ(info.step, 9U);
  info.struct_size = sizeof info - 1;
  EXPECT_EQ(vkopple_get_model_info(model.get(), &info), VKOPPLE_WRONG_USE);
  expect_message({"vkopple_model_info.struct_size", std::to_string(sizeof info - 1)});
  EXPECT_STREQ(vkopple_version(), "0.1.0");
}

/// What infer tells of a model whose objects turn in space.
TEST_F(CInterface, ModelsOfRotations) {
  Config config = test::tiny_config();
  config.model.orientation = Orientation::kEuler;
  test::write_model(path(), config);
  const Picture picture;
  write_png(folder_ / "room.png", picture.rgb());
  const auto outcome =
      test::run_vkopple({"infer", path(), folder_ / "room.png", "--json", "--out", folder_ / "out"});
  test::expect_success(outcome);
  const json objects_told = json::parse(outcome.output).at(0).at("objects");

  const ModelPointer model = load(path());
  vkopple_model_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(vkopple_get_model_info(model.get(), &info), VKOPPLE_OK) << vkopple_last_error();
  EXPECT_EQ(info.bins, 0);
  const SeenPointer seen = see(model.get(), picture.description());
  size_t count = 0;
  const vkopple_object* objects = vkopple_seen_objects(seen.get(), &count);
  ASSERT_EQ(count, 2U);
  for (size_t k = 0; k < count; ++k) {
    const double* rotation = vkopple_seen_rotation(seen.get(), k);
    ASSERT_NE(rotation, nullptr);
    EXPECT_EQ(std::vector<double>(rotation, rotation + 9), objects_told.at(k).at("rotation"));
    EXPECT_EQ(objects[k].yaw, 0);
    EXPECT_EQ(objects[k].yaw_probability, 0);
    size_t bins = 9;
    EXPECT_EQ(vkopple_seen_pose(seen.get(), k, &bins), nullptr);
    EXPECT_EQ(bins, 0U);
  }
  EXPECT_EQ(vkopple_seen_rotation(seen.get(), count), nullptr);
}

TEST_F(CInterface, LoadingNamesWhatIsWrong) {
  vkopple_model* model = reinterpret_cast<vkopple_model*>(1);
  EXPECT_EQ(vkopple_load("/absent/model", nullptr, &model), VKOPPLE_FAILED);
  expect_message({"/absent/model"});
  EXPECT_EQ(model, nullptr);
  write_file(folder_ / "text", "text");
  EXPECT_EQ(vkopple_load((folder_ / "text").c_str(), nullptr, &model), VKOPPLE_FAILED);
  expect_message({"text"});
  EXPECT_EQ(vkopple_load(folder_.path().c_str(), nullptr, &model), VKOPPLE_FAILED);
  expect_message({"latest.safetensors"});
  EXPECT_EQ(vkopple_load(nullptr, nullptr, &model), VKOPPLE_WRONG_USE);
  expect_message({"path"});
  EXPECT_EQ(vkopple_load(path().c_str(), nullptr, nullptr), VKOPPLE_WRONG_USE);
  expect_message({"model"});
  vkopple_options options{sizeof(vkopple_options), "no such device", VKOPPLE_FLOAT32};
  EXPECT_EQ(vkopple_load(path().c_str(), &options, &model), VKOPPLE_WRONG_USE);
  expect_message({"no such device"});
  options = {3, nullptr, VKOPPLE_FLOAT32};
  EXPECT_EQ(vkopple_load(path().c_str(), &options, &model), VKOPPLE_WRONG_USE);
  expect_message({"struct_size", "3"});
  options = {sizeof(vkopple_options) + 8, nullptr, VKOPPLE_FLOAT32};
  EXPECT_EQ(vkopple_load(path().c_str(), &options, &model), VKOPPLE_WRONG_USE);
  expect_message({"struct_size", "newer library"});
  // The last member's end, without what is padding behind it.
  for (const size_t size : {offsetof(vkopple_options, precision) + sizeof(int32_t), sizeof(vkopple_options)}) {
    options = {size, nullptr, 7};
    EXPECT_EQ(vkopple_load(path().c_str(), &options, &model), VKOPPLE_WRONG_USE);
    expect_message({"precision", "7"});
  }
  vkopple_free(nullptr);
}

TEST_F(CInterface, SeeingNamesWhatIsWrong) {
  const ModelPointer model = load(path());
  const Picture picture;
  const auto expect_refusal = [&](const vkopple_image& image, vkopple_status status,
                                  const std::vector<std::string>& parts) {
    vkopple_seen* seen = reinterpret_cast<vkopple_seen*>(1);
    EXPECT_EQ(vkopple_see(model.get(), &image, &seen), status);
    EXPECT_EQ(seen, nullptr);
    expect_message(parts);
  };
  const vkopple_image good = picture.description();
  const auto changed = [&](auto change) {
    vkopple_image image = good;
    change(image);
    return image;
  };
  expect_refusal(changed([](auto& i) { i.pixels = nullptr; }), VKOPPLE_WRONG_USE, {"pixels"});
  expect_refusal(changed([](auto& i) { i.height = 0; }), VKOPPLE_WRONG_USE, {"23 x 0"});
  expect_refusal(changed([](auto& i) { i.width = -1; }), VKOPPLE_WRONG_USE, {"-1 x 40"});
  expect_refusal(changed([](auto& i) { i.width = i.height = 16384; }), VKOPPLE_WRONG_USE, {"16384 x 16384"});
  expect_refusal(changed([](auto& i) { i.height = 16385; }), VKOPPLE_WRONG_USE, {"16385"});
  expect_refusal(changed([](auto& i) { i.stride = 68; }), VKOPPLE_WRONG_USE, {"stride", "68", "69"});
  expect_refusal(changed([](auto& i) { i.stride = SIZE_MAX; }), VKOPPLE_WRONG_USE, {"stride"});
  expect_refusal(changed([](auto& i) { i.format = 9; }), VKOPPLE_WRONG_USE, {"format", "9"});
  const std::vector<float> nan(3, std::numeric_limits<float>::quiet_NaN());
  expect_refusal({nan.data(), 1, 1, 0, VKOPPLE_RGB_FLOAT32}, VKOPPLE_FAILED, {"not a number"});
  vkopple_seen* seen = nullptr;
  EXPECT_EQ(vkopple_see(nullptr, &good, &seen), VKOPPLE_WRONG_USE);
  EXPECT_EQ(vkopple_see(model.get(), nullptr, &seen), VKOPPLE_WRONG_USE);
  EXPECT_EQ(vkopple_see(model.get(), &good, nullptr), VKOPPLE_WRONG_USE);
  expect_message({"seen", "null"});
  // Another thread has had no error, and this one has none after a success.
  std::thread([] { EXPECT_STREQ(vkopple_last_error(), ""); }).join();
  EXPECT_NE(see(model.get(), good), nullptr);
  EXPECT_STREQ(vkopple_last_error(), "");
}

}  // namespace
}  // namespace vkopple
