#include "train/exchange/model_weights.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/support/exchange_model.h"
#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "tests/support/tiny_model.h"
#include "train/atomic_file.h"
#include "train/exchange/open_tensor_file.h"
#include "train/exchange/torch_file.h"
#include "train/model_layout.h"
#include "train/safetensors.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;
using Tensors = std::map<std::string, StoredTensor>;

constexpr const char* kWeight = "depth_model.depth_net.inc.conv.0.weight";
constexpr const char* kVariance = "depth_model.depth_net.down1.conv.2.running_var";
constexpr const char* kCounter = "depth_model.depth_net.down1.conv.2.num_batches_tracked";

void expect_equal(const Tensors& actual, const Tensors& wanted) {
  ASSERT_EQ(actual.size(), wanted.size());
  for (const auto& [name, tensor] : wanted) {
    ASSERT_TRUE(actual.contains(name)) << name;
    EXPECT_EQ(actual.at(name).dtype, tensor.dtype) << name;
    EXPECT_EQ(actual.at(name).shape, tensor.shape) << name;
    EXPECT_EQ(actual.at(name).bytes, tensor.bytes) << name;
  }
}

class ModelWeightsTest : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  ModelWeights imported(const std::string& name, const ImportOptions& options = {}) const {
    return import_weights(*open_tensor_file(file(name)), options);
  }
  /// A foreign file of these weights, after a change.
  void write_foreign(const std::function<void(Tensors&)>& change = [](Tensors&) {}) const {
    Tensors tensors = weights_.tensors;
    change(tensors);
    write_torch(file("foreign.pt"), {}, tensors);
  }
  void expect_refused(const std::function<void(Tensors&)>& change,
                      std::initializer_list<std::string> parts) const {
    write_foreign(change);
    expect_error([&] { imported("foreign.pt", foreign_); }, parts);
  }

  TempFolder folder_;
  ModelWeights weights_ = test::drawn_weights();
  ImportOptions foreign_{.config = test::tiny_config()};
};

TEST_F(ModelWeightsTest, ARoundTripChangesNoBit) {
  for (const std::string name : {"a.pt", "a.pth", "a.safetensors"}) {
    for (const bool bgr : {false, true}) {
      SCOPED_TRACE(name + (bgr ? " BGR" : ""));
      export_weights(file(name), weights_, bgr);
      const ModelWeights back = imported(name);
      expect_equal(back.tensors, weights_.tensors);
      EXPECT_EQ(back.header.config, weights_.header.config);
      EXPECT_EQ(back.header.position, weights_.header.position);
      write_model_checkpoint(file("checkpoint.safetensors"), back);
      expect_equal(read_model_weights(file("checkpoint.safetensors")).tensors, weights_.tensors);
    }
  }
}

TEST_F(ModelWeightsTest, ExportedColoursAreWhatIsAskedFor) {
  export_weights(file("rgb.pt"), weights_, false);
  EXPECT_EQ(TorchFile(file("rgb.pt")).read(kWeight).bytes, weights_.tensors.at(kWeight).bytes);
  export_weights(file("bgr.pt"), weights_, true);
  EXPECT_NE(TorchFile(file("bgr.pt")).read(kWeight).bytes, weights_.tensors.at(kWeight).bytes);
  expect_error([&] { imported("rgb.pt", {.bgr = true}); }, {"rgb.pt", "leave --bgr out"});
  expect_equal(imported("bgr.pt", {.bgr = true}).tensors, weights_.tensors);
  // In blue, green, red they are no checkpoint.
  export_weights(file("bgr.safetensors"), weights_, true);
  expect_error([&] { read_model_weights(file("bgr.safetensors")); }, {"bgr.safetensors", "BGR"});
}

TEST_F(ModelWeightsTest, ACheckpointIsCompleteAndStartsAdamAnew) {
  write_model_checkpoint(file("c.safetensors"), weights_);
  const SafetensorsFile checkpoint(file("c.safetensors"));
  const ModelLayout layout(weights_.header.config.model);
  EXPECT_EQ(checkpoint.names().size(),
            layout.weights().size() + layout.optimiser().size() + layout.batch_counters().size());
  for (const LayoutEntry& entry : layout.optimiser())
    for (const float value : checkpoint.read_floats(entry.name, entry.stored_shape()))
      EXPECT_EQ(value, 0) << entry.name;
}

TEST_F(ModelWeightsTest, ForeignFilesNeedAConfiguration) {
  write_foreign();
  expect_error([&] { imported("foreign.pt"); }, {"foreign.pt", "--config"});
  const ModelWeights back = imported("foreign.pt", foreign_);
  expect_equal(back.tensors, weights_.tensors);
  EXPECT_EQ(back.header.config, test::tiny_config());
  export_weights(file("own.pt"), weights_, false);
  expect_error([&] { imported("own.pt", foreign_); }, {"own.pt", "leave --config out"});
}

/// Of others' files too the metadata may have a "format", and say its version.
TEST_F(ModelWeightsTest, AFileIsOursByItsFormat) {
  write_safetensors(file("other.safetensors"), {{"format", "pt"}, {"format_version", "1"}}, weights_.tensors);
  expect_equal(imported("other.safetensors", foreign_).tensors, weights_.tensors);
  for (const char* format : {"vkopple checkpoint", "vkopple weights in BGR"}) {
    write_safetensors(file("own.safetensors"), {{"format", format}}, weights_.tensors);
    expect_error([&] { imported("own.safetensors"); }, {"own.safetensors", "format_version"});
  }
}

TEST_F(ModelWeightsTest, ForeignWeightsAreWhereTheLastStageBegins) {
  write_foreign();
  EXPECT_EQ(imported("foreign.pt", foreign_).header.position,
            (TrainingPosition{.step = 5, .stage = 1, .stage_step = 0, .data = "imported"}));
  foreign_.config->training.stages.resize(1);
  EXPECT_EQ(imported("foreign.pt", foreign_).header.position, (TrainingPosition{.data = "imported"}));
}

TEST_F(ModelWeightsTest, ForeignNamesAndTypes) {
  write_foreign([](Tensors& tensors) {
    Tensors parallel;
    for (auto& [name, tensor] : tensors) parallel.emplace("module." + name, tensor);
    const std::vector<float> floats = to_floats(parallel.at(std::string("module.") + kWeight));
    const std::vector<double> doubles(floats.begin(), floats.end());
    parallel.at(std::string("module.") + kWeight) = StoredTensor::of({2, 3, 3, 3}, std::span(doubles));
    parallel.erase(std::string("module.") + kCounter);
    tensors = parallel;
  });
  Tensors wanted = weights_.tensors;
  const std::int64_t none = 0;
  wanted.at(kCounter) = StoredTensor::of({}, std::span(&none, 1));
  expect_equal(imported("foreign.pt", foreign_).tensors, wanted);
}

TEST_F(ModelWeightsTest, BgrIsSwappedInForeignFiles) {
  write_foreign();
  foreign_.bgr = true;
  const auto swapped = imported("foreign.pt", foreign_).tensors;
  EXPECT_NE(swapped.at(kWeight).bytes, weights_.tensors.at(kWeight).bytes);
  EXPECT_EQ(swapped.at(kVariance).bytes, weights_.tensors.at(kVariance).bytes);
}

TEST_F(ModelWeightsTest, RefusesWhatDoesNotFit) {
  expect_refused([](Tensors& t) { t.erase(kWeight); }, {"foreign.pt", "lacks the tensor", kWeight});
  expect_refused(
      [](Tensors& t) {
        t.at(kWeight).shape = {3, 2, 3, 3};
      },
      {"foreign.pt", kWeight, "[3, 2, 3, 3]", "[2, 3, 3, 3]"});
  expect_refused([](Tensors& t) { t.at(kCounter).shape = {1}; }, {kCounter, "[1]", "[]"});
  expect_refused(
      [](Tensors& t) {
        t.emplace("grid", StoredTensor{StoredType::kU8, {1}, {std::byte{}}});
      },
      {"foreign.pt", "'grid'", "--without"});
  foreign_.left_out = {"gr"};
  EXPECT_NO_THROW(imported("foreign.pt", foreign_));
  const std::int64_t negative = -1;
  expect_refused([&](Tensors& t) { t.at(kCounter) = StoredTensor::of({}, std::span(&negative, 1)); },
                 {kCounter, "negative"});
  const auto with_value = [](const char* name, float value) {
    return [=](Tensors& t) {
      std::vector<float> values = to_floats(t.at(name));
      values.back() = value;
      t.at(name) = StoredTensor::of(t.at(name).shape, std::span<const float>(values));
    };
  };
  expect_refused(with_value(kWeight, std::numeric_limits<float>::quiet_NaN()), {kWeight, "nan"});
  expect_refused(with_value(kVariance, -1), {kVariance, "negative"});
}

TEST_F(ModelWeightsTest, OnlyCheckpointsAreExported) {
  write_safetensors(file("other.safetensors"), {{"format", "pt"}}, weights_.tensors);
  expect_error([&] { read_model_weights(file("other.safetensors")); }, {"other.safetensors"});
  expect_equal(imported("other.safetensors", foreign_).tensors, weights_.tensors);
}

}  // namespace
}  // namespace vkopple
