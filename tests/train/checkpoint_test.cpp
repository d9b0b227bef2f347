#include "train/checkpoint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <map>

#include "tests/support/expect_error.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/temp_folder.h"
#include "tests/support/test_device.h"
#include "train/atomic_file.h"
#include "train/safetensors.h"
#include "train/tensor_checksums.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

constexpr size_t kLargestFile = size_t{64} << 20;
constexpr const char* kCounter = "depth_model.depth_net.down1.conv.2.num_batches_tracked";
constexpr const char* kWeight = "depth_model.depth_net.inc.conv.0.weight";

Config small_config() {
  return Config::parse(R"({"model": {"height": 16, "width": 16, "depth_width": 2, "object_width": 4,
                                     "imagine_width": 1, "lstm": 4, "code": 12}})",
                       "test");
}

const TrainingPosition kPosition{
    .step = 12, .stage = 0, .stage_step = 12, .seed = UINT64_MAX, .data = "rooms:3"};

/// A file with everything of its own number, and the store that it was written from.
class CheckpointFile : public testing::Test {
 protected:
  CheckpointFile() : store_(test_device(), small_config().model) {
    store_.initialise(5);
    float next = 0;
    for (const LayoutEntry& entry : store_.layout().optimiser())
      store_.write(entry, std::vector<float>(static_cast<size_t>(entry.shape.elements()), next += 0.25F));
    int64_t calls = 0;
    for (auto& [name, count] : store_.batch_counters()) count = ++calls;
    save_checkpoint(path(), store_, small_config(), kPosition);
  }

  std::filesystem::path path() const { return folder_ / "a.safetensors"; }

  /// Writes the file again, changed.
  void change(const std::function<void(std::map<std::string, std::string>&,
                                       std::map<std::string, StoredTensor>&)>& edit) {
    std::map<std::string, StoredTensor> tensors;
    std::map<std::string, std::string> metadata;
    {
      const SafetensorsFile file(path());
      metadata = without_checksums(file.metadata());
      for (const auto& name : file.names()) tensors.emplace(name, file.read(name));
    }
    edit(metadata, tensors);
    write_safetensors(path(), metadata, tensors);
  }
  void change_tensors(const std::function<void(std::map<std::string, StoredTensor>&)>& edit) {
    change([&](auto&, auto& tensors) { edit(tensors); });
  }

  void load() {
    ModelStore other(test_device(), small_config().model);
    load_checkpoint(path(), other, small_config());
  }

  TempFolder folder_;
  ModelStore store_;
};

TEST_F(CheckpointFile, WeightsServeAModelOfTheSameSizesAlone) {
  Config other = small_config();
  other.model.reg = 0.5;
  ModelStore store(test_device(), other.model, Precision::kMixed);
  load_weights(path(), store);
  for (const LayoutEntry& entry : store_.layout().weights())
    EXPECT_TRUE(store.read(entry) == store_.read(entry)) << entry.name;
  EXPECT_EQ(store.batch_counters(), store_.batch_counters());
  for (const LayoutEntry& entry : store.layout().optimiser())
    EXPECT_TRUE(store.read(entry) == std::vector<float>(static_cast<size_t>(entry.shape.elements()), 0))
        << entry.name;

  other.model.depth_width = 4;
  ModelStore wider(test_device(), other.model);
  expect_error([&] { load_weights(path(), wider); },
               {"a.safetensors", "sizes", "depth_net", "has the shape [2], here it has the shape [4]"});
  other = small_config();
  other.model.relaxed = true;
  ModelStore relaxed(test_device(), other.model);
  expect_error([&] { load_weights(path(), relaxed); }, {"is absent, here it has the shape"});
}

TEST_F(CheckpointFile, GivesBackEveryBit) {
  ModelStore other(test_device(), small_config().model);
  EXPECT_EQ(load_checkpoint(path(), other, small_config()), kPosition);
  EXPECT_EQ(other.batch_counters(), store_.batch_counters());
  save_checkpoint(folder_ / "b.safetensors", other, small_config(), kPosition);
  EXPECT_EQ(read_file(path(), kLargestFile), read_file(folder_ / "b.safetensors", kLargestFile));
}

TEST_F(CheckpointFile, HoldsWhatItsDescriptionSays) {
  const SafetensorsFile file(path());
  EXPECT_EQ(file.shape(kWeight), (StoredShape{2, 3, 3, 3}));
  EXPECT_EQ(file.shape("adam/depth/m/" + std::string(kWeight)), (StoredShape{2, 3, 3, 3}));
  EXPECT_EQ(file.shape("adam/object/v/segmentation_model.seg_net.seg_net.outc_att.conv.bias"), StoredShape{1});
  EXPECT_TRUE(file.contains("adam/imagination/correction"));
  EXPECT_EQ(file.dtype(kCounter), StoredType::kI64);
  EXPECT_EQ(file.metadata().at("step"), "12");
  EXPECT_EQ(Config::parse(file.metadata().at("config"), "file"), small_config());
}

TEST_F(CheckpointFile, AModelNeedsNoOptimiser) {
  change_tensors([](auto& tensors) {
    std::erase_if(tensors, [](const auto& item) { return item.first.starts_with("adam/"); });
  });
  const LoadedModel model = load_model(test_device(), path());
  EXPECT_EQ(model.config, small_config());
  EXPECT_EQ(model.position, kPosition);
  for (const LayoutEntry& entry : store_.layout().weights())
    EXPECT_EQ(model.store->read(entry), store_.read(entry));
  expect_error([&] { load(); }, {"a.safetensors", "lacks", "adam/"});
}

TEST_F(CheckpointFile, AnotherConfigurationIsNamed) {
  Config other = small_config();
  other.training.batch = 7;
  ModelStore store(test_device(), other.model);
  expect_error([&] { load_checkpoint(path(), store, other); },
               {"a.safetensors", "training.batch is 20 there and 7 here"});
}

TEST_F(CheckpointFile, RefusesOtherTensors) {
  change_tensors([](auto& tensors) { tensors.emplace("extra", StoredTensor::of({1}, std::vector<float>{1})); });
  expect_error([&] { load(); }, {"a.safetensors", "extra"});
  expect_error([&] { load_model(test_device(), path()); }, {"a.safetensors", "extra"});
}

TEST_F(CheckpointFile, RefusesAbsentTensors) {
  change_tensors([](auto& tensors) { tensors.erase(kWeight); });
  expect_error([&] { load(); }, {"a.safetensors", kWeight});
  expect_error([&] { load_model(test_device(), path()); }, {"a.safetensors", kWeight});
}

TEST_F(CheckpointFile, RefusesOtherShapes) {
  change_tensors([](auto& tensors) { tensors.at(kWeight).shape = {2, 27}; });
  expect_error([&] { load(); }, {"a.safetensors", kWeight, "[2, 27]", "[2, 3, 3, 3]"});
}

TEST_F(CheckpointFile, RefusesNumbersThatAreNone) {
  change_tensors([](auto& tensors) {
    std::vector<float> values(54, 0.5F);
    values[3] = std::numeric_limits<float>::quiet_NaN();
    tensors.at(kWeight) = StoredTensor::of({2, 3, 3, 3}, values);
  });
  expect_error([&] { load(); }, {"a.safetensors", kWeight});
  expect_error([&] { load_model(test_device(), path()); }, {"a.safetensors", kWeight});
}

TEST_F(CheckpointFile, RefusesNegativeVariancesAndCounts) {
  const std::string variance = "depth_model.depth_net.down1.conv.2.running_var";
  change_tensors([&](auto& tensors) {
    tensors.at(variance) = StoredTensor::of(tensors.at(variance).shape, std::vector<float>(2, -1.0F));
  });
  expect_error([&] { load(); }, {"a.safetensors", variance, "negative"});
  save_checkpoint(path(), store_, small_config(), kPosition);
  change_tensors([&](auto& tensors) { tensors.at(kCounter) = StoredTensor::of({}, std::vector<int64_t>{-1}); });
  expect_error([&] { load(); }, {"a.safetensors", kCounter, "negative"});
}

TEST_F(CheckpointFile, RefusesOtherMetadata) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {"format", "other"}, {"format_version", "2"}, {"step", "-1"},  {"step", "1x"},
      {"seed", ""},        {"stage", "1"},          {"config", "{"}, {"config", "{\"model\": {\"slots\": 0}}"}};
  for (const auto& [key, value] : wrong) {
    save_checkpoint(path(), store_, small_config(), kPosition);
    change([&, k = key, v = value](auto& metadata, auto&) { metadata[k] = v; });
    expect_error([&] { load(); }, {"a.safetensors"});
    change([&, k = key](auto& metadata, auto&) { metadata.erase(k); });
    expect_error([&] { load(); }, {"a.safetensors", key});
  }
}

TEST_F(CheckpointFile, RefusesWhatIsCutShort) {
  auto bytes = read_file(path(), kLargestFile);
  bytes.resize(bytes.size() / 2);
  write_file(path(), bytes);
  expect_error([&] { load(); }, {"a.safetensors"});
  expect_error([&] { load_model(test_device(), folder_ / "absent"); }, {"absent"});
}

TEST_F(CheckpointFile, NamesTheTensorThatIsDamaged) {
  auto bytes = read_file(path(), kLargestFile);
  bytes[bytes.size() - 3] ^= std::byte{4};  // of the last in the order of element sizes and names
  write_file(path(), bytes);
  const std::string last = SafetensorsFile(path()).names().back();
  expect_error([&] { load(); }, {"a.safetensors", last, "damaged"});
  expect_error([&] { load_model(test_device(), path()); }, {"a.safetensors", last, "damaged"});
}

TEST_F(CheckpointFile, WithoutChecksumsItIsTakenAsItIs) {
  change([](auto&, auto&) {});
  EXPECT_FALSE(SafetensorsFile(path()).metadata().contains("crc32c"));
  load();
}

/// A bit anywhere in the file, turned over: it is refused, or nothing that it says has changed.
TEST_F(CheckpointFile, NoBitIsLostUnseen) {
  const auto whole = [&] {
    std::map<std::string, StoredTensor> tensors;
    const SafetensorsFile file(path());
    for (const auto& name : file.names()) tensors.emplace(name, file.read(name));
    return std::pair(checkpoint_metadata(read_checkpoint_header(path())), tensors);
  };
  const auto before = whole();
  const auto same = [&](const auto& now) {
    return now.first == before.first &&
           std::equal(now.second.begin(), now.second.end(), before.second.begin(), before.second.end(),
                      [](const auto& a, const auto& b) {
                        return a.first == b.first && a.second.dtype == b.second.dtype &&
                               a.second.shape == b.second.shape && a.second.bytes == b.second.bytes;
                      });
  };
  const auto bytes = read_file(path(), kLargestFile);
  std::fstream file(path(), std::ios::binary | std::ios::in | std::ios::out);
  const auto put = [&](size_t at, std::byte byte) {
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(byte)).flush();
  };
  constexpr size_t kFlips = 120;
  size_t refused = 0;
  for (size_t i = 0; i < kFlips; ++i) {
    const size_t at = i * bytes.size() / kFlips;
    put(at, bytes[at] ^ std::byte{1} << (i % 8));
    try {
      EXPECT_TRUE(same(whole())) << "byte " << at;
    } catch (const Error&) {
      ++refused;
    }
    put(at, bytes[at]);
  }
  EXPECT_GT(refused, kFlips * 9 / 10);
  EXPECT_TRUE(same(whole()));
}

TEST_F(CheckpointFile, WhatCouldNotBeLoadedIsNotWritten) {
  const auto before = read_file(path(), kLargestFile);
  const auto expect_refusal = [&](const LayoutEntry& entry, float value) {
    const std::vector<float> kept = store_.read(entry);
    store_.write(entry, std::vector<float>(kept.size(), value));
    expect_error([&] { save_checkpoint(path(), store_, small_config(), kPosition); },
                 {"a.safetensors", entry.name});
    store_.write(entry, kept);
  };
  const auto& weights = store_.layout().weights();
  expect_refusal(weights.front(), std::numeric_limits<float>::infinity());
  const auto variance = std::find_if(weights.begin(), weights.end(),
                                     [](const LayoutEntry& e) { return e.name.ends_with(".running_var"); });
  ASSERT_NE(variance, weights.end());
  expect_refusal(*variance, -1);
  EXPECT_EQ(read_file(path(), kLargestFile), before);
}

TEST_F(CheckpointFile, AFullDiskLeavesTheOneBefore) {
  const auto before = read_file(path(), kLargestFile);
  {
    const test::FileSizeLimit limit(before.size() / 2);
    expect_error([&] { save_checkpoint(path(), store_, small_config(), kPosition); }, {"a.safetensors"});
  }
  EXPECT_EQ(read_file(path(), kLargestFile), before);
  EXPECT_EQ(folder_.entries(), 1U);
}

}  // namespace
}  // namespace vkopple
