#include "train/formats/example.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/tfrecord.h"

namespace vkopple {
namespace {

using test::expect_error;

TfRecord record(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {{bytes.begin(), bytes.end()}, "a.tfrecord", 3};
}

Example some() {
  records::Example example;
  test::set_bytes(example, "names", {"cube", std::string("\0\xff", 2)});
  test::set_floats(example, "depth", {1.5f, -2, 0});
  test::set_integers(example, "count", {-1, 1'000'000'000'000});
  (*example.mutable_features()->mutable_feature())["nothing"];
  return Example(record(example.SerializeAsString()));
}

template <class T>
std::vector<T> copied(std::span<const T> values) {
  return {values.begin(), values.end()};
}

TEST(ExampleRecord, FeaturesOfEachKind) {
  const Example example = some();
  EXPECT_EQ(example.bytes("names"), (std::vector<std::string_view>{"cube", std::string_view("\0\xff", 2)}));
  EXPECT_EQ(copied(example.floats("depth")), (std::vector<float>{1.5f, -2, 0}));
  EXPECT_EQ(copied(example.integers("count")), (std::vector<std::int64_t>{-1, 1'000'000'000'000}));
  EXPECT_EQ(example.joined("names", 6), (std::vector<std::uint8_t>{'c', 'u', 'b', 'e', 0, 0xff}));
  EXPECT_EQ(example.listed(),
            "count (2 integers), depth (3 floats), names (2 byte strings), nothing (0 values)");
  EXPECT_TRUE(example.floats("nothing").empty());
  EXPECT_TRUE(example.contains("depth"));
  EXPECT_FALSE(example.contains("Depth"));
}

TEST(ExampleRecord, ErrorsNameFileRecordAndFeature) {
  const Example example = some();
  const std::string place = "a.tfrecord: record 3: ";
  expect_error([&] { example.floats("mask"); }, {place + "mask is missing"});
  expect_error([&] { example.floats("names"); }, {place + "names holds byte strings, not floats"});
  expect_error([&] { example.integers("depth"); }, {place + "depth holds floats, not integers"});
  expect_error([&] { example.floats("depth", 4); }, {place + "depth has 3 values, not 4"});
  expect_error([&] { example.bytes("names", 1); }, {place + "names has 2 values, not 1"});
  expect_error([&] { example.joined("names", 5); }, {place + "names has more bytes than 5"});
  expect_error([&] { example.joined("names", 7); }, {place + "names has 6 values, not 7"});
  expect_error([&] { example.joined("depth", 3); }, {place + "depth holds floats"});
}

TEST(ExampleRecord, ASequenceExampleReadsLikeOne) {
  records::SequenceExample sequence;
  (*sequence.mutable_context()->mutable_feature())["key"].mutable_bytes_list()->add_value("k");
  auto& steps = (*sequence.mutable_feature_lists()->mutable_feature_list())["camera"];
  for (const float x : {1.0f, 2.0f}) {
    auto& values = *steps.add_feature()->mutable_float_list();
    values.add_value(x);
    values.add_value(x + 10);
  }
  const Example example(record(sequence.SerializeAsString()));
  EXPECT_EQ(copied(example.floats("camera")), (std::vector<float>{1, 11, 2, 12}));
  EXPECT_EQ(example.bytes("key"), std::vector<std::string_view>{"k"});
  steps.add_feature()->mutable_int64_list()->add_value(1);
  expect_error([&] { Example(record(sequence.SerializeAsString())); }, {"camera has both floats and integers"});
}

TEST(ExampleRecord, RefusesOtherBytes) {
  expect_error([] { Example(record("not a message")); }, {"a.tfrecord: record 3 holds no tf.train.Example"});
  EXPECT_EQ(Example(record("")).listed(), "no features");
}

TEST(ExampleRecord, LongListsOfNamesAreCutShort) {
  records::Example example;
  for (int i = 0; i < 100; ++i) test::set_floats(example, "f" + std::to_string(i), {});
  const std::string listed = Example(record(example.SerializeAsString())).listed();
  EXPECT_TRUE(listed.ends_with(", ...")) << listed;
}

}  // namespace
}  // namespace vkopple
