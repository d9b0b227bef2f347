#include "train/tensor_checksums.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/expect_error.h"
#include "train/crc32c.h"

namespace vkopple {
namespace {

using test::expect_error;
using Metadata = std::map<std::string, std::string>;

const std::map<std::string, StoredTensor> kTensors{
    {"a", StoredTensor::of({2, 3}, std::vector<float>{1, 2, 3, 4, 5, 6})},
    {"b", StoredTensor::of({}, std::vector<std::int64_t>{7})}};

void check_all(const Metadata& metadata, const std::map<std::string, StoredTensor>& tensors) {
  const TensorChecksums checksums(metadata, "file");
  for (const auto& [name, tensor] : tensors) checksums.check(name, tensor);
}

TEST(TensorChecksums, AreOfTypeShapeAndBytes) {
  const Metadata metadata = with_checksums({{"step", "3"}}, kTensors);
  ASSERT_EQ(metadata.size(), 3U);
  const std::string text = "F32 [2, 3]";
  std::vector<std::byte> all;
  for (const char c : text) all.push_back(static_cast<std::byte>(c));
  all.insert(all.end(), kTensors.at("a").bytes.begin(), kTensors.at("a").bytes.end());
  char digits[9];
  std::snprintf(digits, sizeof digits, "%08x", crc32c(all));
  EXPECT_NE(metadata.at("crc32c").find("\"a\":\"" + std::string(digits) + "\""), std::string::npos)
      << metadata.at("crc32c");
  check_all(metadata, kTensors);
  EXPECT_EQ(without_checksums(metadata), (Metadata{{"step", "3"}}));
}

TEST(TensorChecksums, NameTheTensorThatIsDamaged) {
  const Metadata metadata = with_checksums({}, kTensors);
  auto bytes = kTensors;
  bytes.at("a").bytes[5] ^= std::byte{1};
  expect_error([&] { check_all(metadata, bytes); }, {"file", "'a'", "damaged"});
  auto type = kTensors;
  type.at("a").dtype = StoredType::kI32;
  expect_error([&] { check_all(metadata, type); }, {"file", "'a'", "damaged"});
  auto shape = kTensors;
  shape.at("a").shape = {3, 2};
  expect_error([&] { check_all(metadata, shape); }, {"file", "'a'", "damaged"});
  auto more = kTensors;
  more.emplace("c", kTensors.at("b"));
  expect_error([&] { check_all(metadata, more); }, {"file", "'c'", "none"});
}

TEST(TensorChecksums, WatchOverMetadata) {
  const Metadata whole = with_checksums({{"step", "3"}, {"data", ""}}, kTensors);
  for (const std::string key : {"step", "data", "crc32c", "metadata_crc32c"}) {
    Metadata metadata = whole;
    metadata[key] += "1";
    expect_error([&] { check_all(metadata, kTensors); }, {"file", "metadata are damaged"});
  }
  Metadata moved = whole;
  moved.erase("data");
  expect_error([&] { check_all(moved, kTensors); }, {"metadata are damaged"});
}

TEST(TensorChecksums, OlderFilesHaveNone) { check_all({{"step", "3"}}, kTensors); }

}  // namespace
}  // namespace vkopple
