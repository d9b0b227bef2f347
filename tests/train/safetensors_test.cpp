#include "train/safetensors.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "tests/support/expect_error.h"
#include "tests/support/fixture.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

std::string with_length(std::uint64_t length, const std::string& rest) {
  std::string text(8, '\0');
  std::memcpy(text.data(), &length, 8);
  return text + rest;
}

std::string file_of(const std::string& header, std::size_t data_bytes) {
  return with_length(header.size(), header + std::string(data_bytes, '\0'));
}

class Safetensors : public testing::Test {
 protected:
  /// The file `bad.safetensors` with this content must be refused with these words.
  void refuse(const std::string& content, std::initializer_list<std::string> parts) {
    write_file(folder_ / "bad.safetensors", content);
    expect_error([&] { SafetensorsFile file(folder_ / "bad.safetensors"); }, {"bad.safetensors"});
    expect_error([&] { SafetensorsFile file(folder_ / "bad.safetensors"); }, parts);
  }
  /// The same for a header with one or more tensors and so many bytes of data.
  void refuse_header(const std::string& header, std::size_t data_bytes,
                     std::initializer_list<std::string> parts) {
    refuse(file_of(header, data_bytes), parts);
  }

  TempFolder folder_;
};

const std::vector<float> kSix{1, -2, 3.5f, 0, 1e-40f, 6};

TEST_F(Safetensors, RoundTrip) {
  const std::vector<std::int64_t> longs{-5, INT64_MAX};
  const std::vector<std::int32_t> ints{7};
  const std::vector<double> doubles{0.1};
  const auto path = folder_ / "a.safetensors";
  write_safetensors(
      path, {{"config", "{\"a\": \"\xc3\xa9\\n\"}"}},
      std::map<std::string, StoredTensor>{{"w", StoredTensor::of({2, 3}, kSix)},
                                          {"long", StoredTensor::of({2}, longs)},
                                          {"scalar", StoredTensor::of({}, ints)},
                                          {"d", StoredTensor::of({1, 1}, doubles)},
                                          {"empty", StoredTensor::of({0, 4}, std::span<const float>())},
                                          {"bytes", {StoredType::kU8, {3}, std::vector<std::byte>(3)}}});
  const SafetensorsFile file(path);
  EXPECT_EQ(file.metadata().at("config"), "{\"a\": \"\xc3\xa9\\n\"}");
  EXPECT_EQ(file.names(), (std::vector<std::string>{"bytes", "d", "empty", "long", "scalar", "w"}));
  EXPECT_EQ(file.shape("w"), (StoredShape{2, 3}));
  EXPECT_EQ(file.read_floats("w"), kSix);
  EXPECT_EQ(file.read_floats("w", {2, 3}), kSix);
  EXPECT_EQ(file.read_ints("long"), longs);
  EXPECT_EQ(file.read_ints("scalar"), (std::vector<std::int64_t>{7}));
  EXPECT_TRUE(file.shape("scalar").empty());
  EXPECT_EQ(file.read_doubles("d"), doubles);
  EXPECT_TRUE(file.read_floats("empty").empty());
  EXPECT_EQ(file.dtype("bytes"), StoredType::kU8);
}

TEST_F(Safetensors, BytesAreDeterminedAlignedAndKnown) {
  const auto path = folder_ / "a.safetensors";
  const std::vector<double> d{1.0};
  const std::vector<float> f{1.0f};
  write_safetensors(
      path, {{"k", "v"}},
      std::map<std::string, StoredTensor>{{"a", StoredTensor::of({1}, f)}, {"b", StoredTensor::of({1}, d)}});
  std::string header = R"({"__metadata__":{"k":"v"},"b":{"dtype":"F64","shape":[1],"data_offsets":[0,8]},)"
                       R"("a":{"dtype":"F32","shape":[1],"data_offsets":[8,12]}})";
  header.resize((header.size() + 7) / 8 * 8, ' ');
  const std::string data("\0\0\0\0\0\0\xf0\x3f\0\0\x80\x3f", 12);
  EXPECT_EQ(read_text_file(path, 1000), with_length(header.size(), header + data));
}

TEST_F(Safetensors, EmptyFileOfTensors) {
  write_safetensors(folder_ / "a", {}, std::map<std::string, StoredTensor>{});
  EXPECT_EQ(read_text_file(folder_ / "a", 100), with_length(8, "{}      "));
  EXPECT_TRUE(SafetensorsFile(folder_ / "a").names().empty());
}

TEST_F(Safetensors, ReadsTheFixtureAndWritesItAgain) {
  const SafetensorsFile file(test::fixture("rigid.safetensors"));
  EXPECT_EQ(file.metadata().at("mode"), "eval");
  EXPECT_GT(file.names().size(), 100u);
  EXPECT_EQ(file.shape("input/image1")[1], 3);
  std::map<std::string, StoredTensor> tensors;
  for (const std::string& name : file.names()) tensors.emplace(name, file.read(name));
  write_safetensors(folder_ / "again", file.metadata(), tensors);
  const SafetensorsFile again(folder_ / "again");
  ASSERT_EQ(again.names(), file.names());
  for (const std::string& name : file.names()) {
    EXPECT_EQ(again.shape(name), file.shape(name)) << name;
    EXPECT_EQ(again.read(name).bytes, file.read(name).bytes) << name;
  }
}

TEST_F(Safetensors, ConvertsEveryType) {
  const auto tensor = [](StoredType dtype, auto... values) {
    StoredTensor t{dtype, {static_cast<std::int64_t>(sizeof...(values))}, {}};
    (t.bytes.insert(t.bytes.end(), reinterpret_cast<const std::byte*>(&values),
                    reinterpret_cast<const std::byte*>(&values) + sizeof(values)),
     ...);
    return t;
  };
  using U16 = std::uint16_t;
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(to_floats(tensor(StoredType::kF16, U16{0x3c00}, U16{0xc000}, U16{0x3555}, U16{0x0001}, U16{0x03ff},
                             U16{0x7bff})),
            (std::vector<float>{1, -2, 0.333251953125f, 0x1p-24f, 1023 * 0x1p-24f, 65504}));
  EXPECT_EQ(to_floats(tensor(StoredType::kF16, U16{0x7c00}, U16{0xfc00})), (std::vector<float>{inf, -inf}));
  EXPECT_TRUE(std::isnan(to_floats(tensor(StoredType::kF16, U16{0x7e00})).at(0)));
  EXPECT_TRUE(std::signbit(to_floats(tensor(StoredType::kF16, U16{0x8000})).at(0)));
  EXPECT_EQ(to_floats(tensor(StoredType::kBF16, U16{0x3f80}, U16{0xc040})), (std::vector<float>{1, -3}));
  EXPECT_EQ(to_doubles(tensor(StoredType::kF64, 0.1)), (std::vector<double>{0.1}));
  EXPECT_EQ(to_doubles(tensor(StoredType::kF32, 0.1f)), (std::vector<double>{0.1f}));
  EXPECT_EQ(to_floats(tensor(StoredType::kI32, -3)), (std::vector<float>{-3}));
  EXPECT_EQ(to_floats(tensor(StoredType::kI64, std::int64_t{-3})), (std::vector<float>{-3}));
  EXPECT_EQ(to_floats(tensor(StoredType::kU8, std::uint8_t{255})), (std::vector<float>{255}));
  const auto ints = [](const StoredTensor& t) { return to_ints(t, "n", "f"); };
  EXPECT_EQ(ints(tensor(StoredType::kI8, std::int8_t{-1})), (std::vector<std::int64_t>{-1}));
  EXPECT_EQ(ints(tensor(StoredType::kU32, ~0u)), (std::vector<std::int64_t>{4294967295}));
  EXPECT_EQ(ints(tensor(StoredType::kBool, std::uint8_t{1})), (std::vector<std::int64_t>{1}));
  expect_error([&] { ints(tensor(StoredType::kF32, 1.0f)); }, {"f: tensor 'n' holds F32"});
  for (int i = 0; i < 13; ++i)
    EXPECT_EQ(dtype_from_name(dtype_name(static_cast<StoredType>(i))), static_cast<StoredType>(i));
}

TEST_F(Safetensors, UnsortedHeaderIsFine) {
  write_file(
      folder_ / "a",
      file_of(
          R"({"b":{"dtype":"U8","shape":[2],"data_offsets":[4,6]},"a":{"dtype":"F32","shape":[],"data_offsets":[0,4]},)"
          R"("z":{"dtype":"I64","shape":[0],"data_offsets":[4,4]}})",
          6));
  EXPECT_EQ(SafetensorsFile(folder_ / "a").read_floats("b"), (std::vector<float>{0, 0}));
}

TEST_F(Safetensors, RefusesBrokenFraming) {
  refuse("", {"too short"});
  refuse("1234567", {"too short"});
  refuse(with_length(2, "{"), {"too short"});
  refuse(with_length(1000, "{}      "), {"1000", "cut off"});
  refuse(with_length(UINT64_MAX, "{}"), {"above the format's limit"});
  refuse(with_length(100'000'001, "{}"), {"above the format's limit"});
  refuse(with_length(0, "{}"), {"does not start with '{'"});
  refuse(with_length(3, " {}"), {"does not start with '{'"});
  refuse(with_length(4, "[{}]"), {"does not start with '{'"});
  refuse(with_length(8, "{} x    "), {"(header)", "not usable JSON"});
  refuse(with_length(8, "{\"a\":   "), {"(header)", "not usable JSON"});
  expect_error([&] { SafetensorsFile file(folder_ / "none"); }, {"none", "No such file"});
  expect_error([&] { SafetensorsFile file(folder_.path()); }, {"not a regular file"});
}

TEST_F(Safetensors, RefusesEveryTruncation) {
  write_safetensors(folder_ / "a", {{"k", "v"}},
                    std::map<std::string, StoredTensor>{{"w", StoredTensor::of({6}, kSix)}});
  const std::string whole = read_text_file(folder_ / "a", 1000);
  for (std::size_t n = 0; n < whole.size(); ++n) refuse(whole.substr(0, n), {});
  refuse(whole + "x", {"1 bytes beyond the last tensor"});
}

TEST_F(Safetensors, RefusesBadEntries) {
  const auto entry = [](const std::string& dtype, const std::string& shape, const std::string& offsets) {
    return R"({"w":{"dtype":)" + dtype + R"(,"shape":)" + shape + R"(,"data_offsets":)" + offsets + "}}";
  };
  refuse_header(entry("\"F31\"", "[1]", "[0,4]"), 4, {"tensor 'w'", "unknown dtype 'F31'"});
  refuse_header(entry("32", "[1]", "[0,4]"), 4, {"tensor 'w'", "dtype is not a string"});
  refuse_header(entry("\"F32\"", "[2]", "[0,4]"), 4, {"tensor 'w'", "takes 8 bytes", "give it 4"});
  refuse_header(entry("\"F32\"", "[-1]", "[0,4]"), 4, {"tensor 'w'", "shape", "whole numbers"});
  refuse_header(entry("\"F32\"", "[1.0]", "[0,4]"), 4, {"tensor 'w'", "shape", "whole numbers"});
  refuse_header(entry("\"F32\"", "[18446744073709551615]", "[0,4]"), 4,
                {"tensor 'w'", "shape", "whole numbers"});
  refuse_header(entry("\"F32\"", "[4294967296,4294967296]", "[0,4]"), 4, {"tensor 'w'", "too large"});
  refuse_header(entry("\"F32\"", "[4611686018427387905]", "[0,4]"), 4, {"tensor 'w'", "too large"});
  refuse_header(entry("\"F32\"", "[1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1]", "[0,4]"), 4,
                {"tensor 'w'", "at most 16"});
  refuse_header(entry("\"F32\"", "1", "[0,4]"), 4, {"tensor 'w'", "shape is not an array"});
  refuse_header(entry("\"F32\"", "[1]", "[4,0]"), 4, {"tensor 'w'", "begin <= end"});
  refuse_header(entry("\"F32\"", "[1]", "[4]"), 4, {"tensor 'w'", "begin"});
  refuse_header(entry("\"F32\"", "[1]", "[0,4,8]"), 4, {"tensor 'w'", "data_offsets"});
  refuse_header(entry("\"F32\"", "[2]", "[0,8]"), 4, {"tensor 'w'", "ends at byte 8", "holds 4"});
  refuse_header(entry("\"F32\"", "[1]", "[9223372036854775804,9223372036854775808]"), 4,
                {"tensor 'w'", "data_offsets"});
  refuse_header(R"({"w":{"dtype":"F32","shape":[1]}})", 4, {"tensor 'w'", "needs exactly"});
  refuse_header(R"({"w":[]})", 4, {"tensor 'w'", "needs exactly"});
  refuse_header(R"({"a\nb":7})", 0, {"tensor 'a?b'"});
}

TEST_F(Safetensors, RefusesBadLayouts) {
  const std::string a = R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]})";
  refuse_header("{" + a + R"(,"b":{"dtype":"F32","shape":[1],"data_offsets":[2,6]}})", 6, {"'b'", "overlaps"});
  refuse_header("{" + a + R"(,"b":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 4, {"'b'", "overlaps"});
  refuse_header("{" + a + R"(,"b":{"dtype":"F32","shape":[1],"data_offsets":[8,12]}})", 12,
                {"'b'", "unused bytes"});
  refuse_header("{" + a + "}", 5, {"1 bytes beyond"});
  refuse_header("{}", 1, {"1 bytes beyond"});
  refuse_header("{" + a + "," + a + "}", 4, {"'a'", "twice"});
  refuse_header(R"({"__metadata__":{"a":"b","a":"c"}})", 0, {"'a'", "twice"});
  refuse_header(R"({"__metadata__":{"a":1}})", 0, {"__metadata__", "'a'", "not a string"});
  refuse_header(R"({"__metadata__":[]})", 0, {"__metadata__"});
}

TEST_F(Safetensors, WrongUseNamesFileAndTensor) {
  std::vector<float> values = kSix;
  values[4] = std::nanf("");
  write_safetensors(folder_ / "a", {},
                    std::map<std::string, StoredTensor>{{"w", StoredTensor::of({6}, values)}});
  const SafetensorsFile file(folder_ / "a");
  expect_error([&] { file.read_floats("v"); }, {"/a", "no tensor 'v'", "another model"});
  expect_error([&] { file.read_floats("w", {2, 3}); }, {"/a", "'w'", "[6]", "[2, 3]", "another configuration"});
  expect_error([&] { file.read_floats("w", {6}); }, {"/a", "'w'", "nan at element 4"});
  expect_error([&] { file.read_ints("w"); }, {"/a", "'w'", "F32"});
  const std::vector<float> infinite{1, -std::numeric_limits<float>::infinity()};
  expect_error([&] { require_finite("w", infinite, "p"); }, {"p", "'w'", "-inf at element 1"});
  EXPECT_NO_THROW(require_finite("w", kSix, "p"));
}

TEST_F(Safetensors, WriterRefusesNonsenseAndLeavesNothing) {
  const auto write = [&](const std::string& name, StoredTensor tensor, const std::string& meta = "v") {
    write_safetensors(folder_ / "a", {{"k", meta}},
                      std::map<std::string, StoredTensor>{{name, std::move(tensor)}});
  };
  expect_error([&] { write("w", StoredTensor::of({5}, kSix)); }, {"/a", "'w'", "[5]"});
  expect_error([&] { write("__metadata__", StoredTensor::of({6}, kSix)); }, {"__metadata__"});
  expect_error([&] { write("\xff", StoredTensor::of({6}, kSix)); }, {"not UTF-8"});
  expect_error([&] { write("w", StoredTensor::of({6}, kSix), "\xff"); }, {"not UTF-8"});
  EXPECT_EQ(folder_.entries(), 0u);
}

TEST_F(Safetensors, FileThatShrinksWhileRead) {
  write_safetensors(folder_ / "a", {}, std::map<std::string, StoredTensor>{{"w", StoredTensor::of({6}, kSix)}});
  const SafetensorsFile file(folder_ / "a");
  std::filesystem::resize_file(folder_ / "a", 10);
  expect_error([&] { file.read("w"); }, {"/a", "became shorter"});
}

}  // namespace
}  // namespace vkopple
