#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "models/perception.h"
#include "tests/support/film.h"
#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/checkpoint.h"
#include "train/image_io.h"
#include "train/pictures.h"
#include "train/random.h"
#include "train/seen_image.h"

namespace vkopple {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

/// Two pictures of each kind tell the model below the same object, of other kinds other ones.
enum Kind : uint64_t { kFirst = 1, kSecond = 2 };

/// Of one colour with some noise, coarse enough that the overlay shows more than outlines.
RgbImage picture(uint64_t seed) {
  Random random(seed, 1);
  RgbImage image(16, 16);
  for (size_t c = 0; c < 3; ++c) {
    const double base = random.uniform();
    for (size_t i = 0; i < 256; ++i)
      image.pixels[256 * c + i] = static_cast<float>(0.75 * base + 0.25 * random.uniform());
  }
  return enlarge(image, 4);
}

/// A model of drawn weights gives all slots of all pictures nearly one code. This one leaves a single number of
/// the identity code, which is positive for pictures of the first kind and negative for those of the second.
class CodesOfKinds {
 public:
  explicit CodesOfKinds(const LoadedModel& model)
      : store_(*model.store), config_(model.config.model), last_(static_cast<size_t>(config_.identity) - 1) {
    clear("lin.1.weight");
    clear("lin.1.bias");
    const float middle = (code_of(kFirst) + code_of(kSecond)) / 2;
    const auto& entry = find("lin.1.bias");
    auto bias = store_.read(entry);
    bias.at(row(last_)) -= middle;
    store_.write(entry, bias);
  }

 private:
  size_t row(size_t number) const { return 3 + static_cast<size_t>(config_.bins) + number; }

  const LayoutEntry& find(const std::string& name) const {
    for (const LayoutEntry& entry : store_.layout().weights())
      if (entry.name.ends_with("seg_net." + name)) return entry;
    throw std::runtime_error("there is no " + name);
  }

  /// All of the identity code but its last number.
  void clear(const std::string& name) {
    const auto& entry = find(name);
    auto values = store_.read(entry);
    const size_t columns = values.size() / (row(0) + static_cast<size_t>(config_.code));
    for (size_t i = row(0) * columns; i < row(last_) * columns; ++i) values[i] = 0;
    store_.write(entry, values);
  }

  float code_of(uint64_t seed) const {
    Perception perception(test_device(), config_, store_.groups());
    return see_image(perception, resize(picture(seed), 16, 16)).objects.at(0).identity.at(last_);
  }

  ModelStore& store_;
  const ModelConfig& config_;
  size_t last_;
};

class InferSequence : public testing::Test {
 protected:
  InferSequence() {
    test::write_tiny_model(model());
    const LoadedModel drawn = load_model(test_device(), model());
    const CodesOfKinds made(drawn);
    save_checkpoint(model(), *drawn.store, drawn.config, drawn.position);
  }

  std::string model() const { return folder_ / "model.safetensors"; }
  std::filesystem::path out() const { return folder_ / "out"; }
  std::string film(const std::string& name, const std::vector<uint64_t>& seeds) const {
    std::vector<RgbImage> frames;
    for (const uint64_t seed : seeds) frames.push_back(picture(seed));
    test::write_film(folder_ / name, frames);
    return folder_ / name;
  }
  std::string image(const std::string& name, uint64_t seed) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    write_png(folder_ / name, picture(seed));
    return folder_ / name;
  }

  Outcome infer(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"infer", model(), "--out", out()};
    words.insert(words.end(), more.begin(), more.end());
    return run_vkopple(words);
  }
  json said(const std::string& name) const {
    return json::parse(read_text_file(out() / (name + ".json"), size_t{1} << 20));
  }
  /// Of what the first slot shows.
  json id(const std::string& name) const { return said(name).at("objects").at(0).at("id"); }
  json frame(const std::string& name) const { return said(name).at("frame"); }
  bool wrote(const std::string& name) const { return std::filesystem::exists(out() / (name + ".json")); }

  TempFolder folder_;
};

TEST_F(InferSequence, AFilmIsARecording) {
  for (const std::string ending : {"gif", "tif"}) {
    const std::string path = film(ending + "." + ending, {kFirst, kSecond, kFirst});
    const auto outcome = infer({path});
    expect_success(outcome);
    EXPECT_NE(outcome.output.find("slot   id"), std::string::npos) << outcome.output;
    const std::vector<int> ids{0, 1, 0};
    for (int i = 0; i < 3; ++i) {
      const std::string name = fmt::format("{}.{:06}", ending, i);
      EXPECT_EQ(id(name), ids[static_cast<size_t>(i)]) << name;
      EXPECT_EQ(frame(name), i);
      EXPECT_EQ(said(name).at("image"), path);
      EXPECT_EQ(said(name).at("name"), name);
      EXPECT_EQ(said(name).at("height"), 64);
    }
    EXPECT_FALSE(wrote(ending)) << "as if it were one image";
  }
}

TEST_F(InferSequence, PicturesShowIdsInTheirColours) {
  const std::vector<uint64_t> seeds{kFirst, kSecond};
  expect_success(infer({film("film.tif", seeds), "--grid", folder_ / "grid.png"}));
  for (size_t i = 0; i < 2; ++i) {
    const std::string name = fmt::format("film.{:06}", i);
    const RgbImage mask = read_rgb(out() / (name + ".mask.png"));
    std::vector<int32_t> labels;
    for (size_t p = 0; p < 64 * 64; ++p) {
      const auto slot = static_cast<size_t>(std::lround(255 * mask.pixels[p]));
      labels.push_back(slot == 2 ? -1 : said(name).at("objects").at(slot).at("id").get<int32_t>());
    }
    EXPECT_GT(std::count(labels.begin(), labels.end(), static_cast<int32_t>(i)), 0) << "nothing to see";
    const RgbImage expected = overlay(picture(seeds[i]), labels, -1);
    const RgbImage drawn = read_rgb(out() / (name + ".overlay.png"));
    for (size_t p = 0; p < expected.pixels.size(); ++p)
      ASSERT_NEAR(drawn.pixels.at(p), expected.pixels[p], 0.01) << name << " " << p;
  }
  EXPECT_EQ(read_rgb(folder_ / "grid.png").height, 2 * (128 + 4) + 4);
}

TEST_F(InferSequence, AFolderIsARecordingWhereAsked) {
  image("frames/frame10.png", kSecond);
  image("frames/frame2.png", kSecond);
  image("frames/frame1.png", kFirst);
  expect_success(infer({folder_ / "frames"}));
  EXPECT_FALSE(said("frame1").contains("frame"));
  EXPECT_FALSE(said("frame1").at("objects").at(0).contains("id"));
  const auto outcome = infer({folder_ / "frames", "--sequence", "--json"});
  expect_success(outcome);
  std::vector<std::string> names;
  for (const json& one : json::parse(outcome.output)) names.push_back(one.at("name"));
  EXPECT_EQ(names, (std::vector<std::string>{"frame1", "frame2", "frame10"}));
  EXPECT_EQ(frame("frame10"), 2);
  EXPECT_EQ(id("frame1"), 0);
  EXPECT_EQ(id("frame2"), 1);
  EXPECT_EQ(id("frame10"), 1);
  EXPECT_TRUE(said("frame1").at("objects").at(1).at("id").is_null()) << "a slot without a pixel";
}

TEST_F(InferSequence, OneOfAllOrOneOfEach) {
  const std::vector<std::string> images{film("a.gif", {kSecond, kFirst}), image("b.png", kSecond),
                                        film("c.tif", {kFirst, kSecond})};
  expect_success(infer(images));
  EXPECT_EQ(id("a.000000"), 0);
  EXPECT_EQ(id("a.000001"), 1);
  EXPECT_FALSE(said("b").contains("frame"));
  EXPECT_EQ(id("c.000000"), 0);
  EXPECT_EQ(frame("c.000001"), 1);
  expect_success(infer({"--sequence", images[0], images[1], images[2]}));
  EXPECT_EQ(id("b"), 0);
  EXPECT_EQ(frame("b"), 2);
  EXPECT_EQ(id("c.000000"), 1);
  EXPECT_EQ(frame("c.000001"), 4);
}

TEST_F(InferSequence, NamesNeverCollide) {
  image("film.000001.png", kFirst);
  const std::string one = film("film.gif", {kFirst, kFirst}), other = film("film.tif", {kFirst, kFirst});
  expect_success(infer({folder_ / "film.000001.png", one, other}));
  EXPECT_EQ(said("film.000001").at("image"), (folder_ / "film.000001.png").string());
  EXPECT_EQ(said("film.000001-2").at("image"), one);
  EXPECT_EQ(said("film-2.000001").at("image"), other);
}

TEST_F(InferSequence, WhatCannotBeReadIsLeftOut) {
  image("frames/1.png", kFirst);
  write_file(folder_ / "frames" / "2.png", "text");
  image("frames/3.png", kSecond);
  expect_failure(infer({"--sequence", folder_ / "frames"}), 1, {"2.png"});
  EXPECT_EQ(id("3"), 1);
  const std::string whole = film("film.gif", {kFirst, kSecond, kFirst});
  auto bytes = read_file(whole, size_t{1} << 20);
  bytes.resize(bytes.size() / 2);
  write_file(whole, bytes);
  expect_failure(infer({whole, folder_ / "frames" / "1.png"}), 1, {"film.gif", "cut off after 1 images"});
  EXPECT_TRUE(wrote("film.000000"));
  EXPECT_FALSE(wrote("film.000001"));
  std::filesystem::create_directory(folder_ / "empty");
  expect_failure(infer({folder_ / "empty"}), 1, {"empty", "no pictures"});
}

TEST_F(InferSequence, AModelOfDepthAloneHasNoIds) {
  test::write_tiny_model(model(), 0);
  expect_success(infer({film("film.gif", {kFirst, kSecond})}));
  EXPECT_TRUE(said("film.000001").at("objects").empty());
  EXPECT_EQ(frame("film.000001"), 1);
}

}  // namespace
}  // namespace vkopple
