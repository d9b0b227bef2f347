#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/support/program.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/image_io.h"
#include "train/safetensors.h"
#include "train/tensor_checksums.h"

namespace vkopple {
namespace {

using test::expect_failure;
using test::Outcome;
using test::run_vkopple;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{16} << 20;
constexpr const char* kWeight = "depth_model.depth_net.inc.conv.0.weight";

/// A checkpoint to damage, and the commands that read one.
class ModelFile : public testing::Test {
 protected:
  ModelFile() {
    test::write_tiny_model(model());
    write_png(folder_ / "image.png", RgbImage(16, 16));
    write_file(folder_ / "poses.json", R"({"poses": [[0,0,0,0,0,0],[0,0,0,0,0,0],[0,0,0,0,0,0]]})");
  }

  std::filesystem::path model() const { return folder_ / "model.safetensors"; }
  std::string out() const { return folder_ / "out"; }

  Outcome infer() const { return run_vkopple({"infer", model(), folder_ / "image.png", "--out", out()}); }

  /// One line that names the file, and nothing written.
  void expect_refusal(const Outcome& outcome, std::vector<std::string> parts) const {
    parts.emplace_back("model.safetensors");
    expect_failure(outcome, 1, parts);
    EXPECT_TRUE(outcome.output.empty()) << outcome.output;
    EXPECT_FALSE(std::filesystem::exists(out()));
  }

  using Tensors = std::map<std::string, StoredTensor>;
  using Metadata = std::map<std::string, std::string>;
  void change(const std::function<void(Metadata&, Tensors&)>& edit) const {
    Tensors tensors;
    Metadata metadata;
    {
      const SafetensorsFile file(model());
      metadata = without_checksums(file.metadata());
      for (const auto& name : file.names()) tensors.emplace(name, file.read(name));
    }
    edit(metadata, tensors);
    write_safetensors(model(), metadata, tensors);
  }

  TempFolder folder_;
};

TEST_F(ModelFile, AnAbsentOneIsNamedByEveryCommand) {
  std::filesystem::remove(model());
  const std::string image = folder_ / "image.png";
  expect_refusal(infer(), {});
  expect_refusal(run_vkopple({"eval", model(), "--data", "rooms:1"}), {});
  expect_refusal(
      run_vkopple({"predict", model(), image, image, "--poses", folder_ / "poses.json", "--out", out()}), {});
}

TEST_F(ModelFile, TruncatedAnywhere) {
  const auto bytes = read_file(model(), kLargestFile);
  for (const size_t size : {size_t{0}, size_t{5}, size_t{200}, bytes.size() - 1}) {
    SCOPED_TRACE(size);
    write_file(model(), std::span(bytes).first(size));
    expect_refusal(infer(), {});
  }
}

TEST_F(ModelFile, NoSafetensors) {
  write_file(model(), "a text that is no model, longer than a header");
  expect_refusal(infer(), {});
  std::filesystem::remove(model());
  std::filesystem::create_directory(model());
  expect_refusal(infer(), {});
}

TEST_F(ModelFile, NumbersThatAreNone) {
  change([](auto&, auto& tensors) {
    std::vector<float> values(54, 0.5F);
    values[7] = std::numeric_limits<float>::quiet_NaN();
    tensors.at(kWeight) = StoredTensor::of({2, 3, 3, 3}, values);
  });
  expect_refusal(infer(), {kWeight});
}

TEST_F(ModelFile, AnotherConfigurationThanItsTensors) {
  change([](auto& metadata, auto&) {
    Config other = test::tiny_config();
    other.model.depth_width = 3;
    metadata.at("config") = other.to_json();
  });
  expect_refusal(infer(), {"shape"});
}

TEST_F(ModelFile, AnImpossibleConfiguration) {
  change([](auto& metadata, auto&) { metadata.at("config") = R"({"model": {"height": 1000000}})"; });
  expect_refusal(infer(), {"model.height"});
}

TEST_F(ModelFile, AFileOfAnotherProgram) {
  change([](auto& metadata, auto&) { metadata.clear(); });
  expect_refusal(infer(), {"format"});
}

}  // namespace
}  // namespace vkopple
