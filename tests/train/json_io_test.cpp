#include "train/json_io.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"
#include "tests/support/temp_folder.h"
#include "train/atomic_file.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::TempFolder;

TEST(JsonIo, ReadsWhatItWrote) {
  const TempFolder folder;
  const Json value = {{"a", 1}, {"b", {1.5, "x", nullptr, true}}, {"c", Json::object()}};
  write_json(folder / "a.json", value);
  EXPECT_EQ(read_json(folder / "a.json"), value);
}

TEST(JsonIo, RefusesDuplicateKeysWithPosition) {
  expect_error([] { parse_json("{\"a\": 1,\n \"b\": 2, \"a\": 3}", "x.json"); },
               {"x.json", "line 2, column 12", "'a'", "twice"});
  expect_error([] { parse_json(R"([{"k": {"a": 1, "a": {}}}])", "x"); }, {"'a'", "twice"});
  EXPECT_NO_THROW(parse_json(R"([{"a": {"a": 1}, "b": [{"a": 1}, {"a": 2}]}, {"a": 1}])", "x"));
}

TEST(JsonIo, RefusesBadText) {
  for (const char* text : {"", "{", "{\"a\": }", "[1, 2", "[1] x", "nul", "{\"a\" 1}", "\"\xff\xfe\"",
                           "[1e999]", "{a: 1}", "[1,]"}) {
    expect_error([&] { parse_json(text, "bad.json"); }, {"bad.json: not usable JSON at line 1, column "});
  }
  expect_error([] { parse_json("{\n\n  \"a\": tru\n}", "bad.json"); }, {"line 3, column 11"});
  expect_error([] { parse_json("\"" + std::string(1 << 20, 'x') + "\n", "bad.json"); }, {"bad.json"});
}

TEST(JsonIo, Limits) {
  expect_error([] { parse_json(std::string(1'000'000, '['), "deep.json"); },
               {"deep.json", "nested deeper than 64"});
  expect_error([] { parse_json("[1,2,3,4]", "many.json", {.max_values = 4}); },
               {"many.json", "more than 4 values"});
  EXPECT_NO_THROW(parse_json("[1,2,3]", "many.json", {.max_values = 4}));
  EXPECT_NO_THROW(parse_json(std::string(64, '[') + std::string(64, ']'), "deep.json"));
  const TempFolder folder;
  write_file(folder / "large.json", "[1, 2, 3]");
  expect_error([&] { read_json(folder / "large.json", 5); }, {"large.json", "larger than the 5 bytes"});
  expect_error([&] { read_json(folder / "none.json"); }, {"none.json", "No such file"});
}

TEST(JsonView, NamesThePlace) {
  const Json value =
      parse_json(R"({"objects": [{"size": [1, 2.5], "name": "cube", "hidden": false, "n": 7}]})", "s.json");
  const JsonView root(value, "s.json");
  const JsonView object = root["objects"][0];
  EXPECT_EQ(object.where(), "s.json: objects[0]");
  EXPECT_EQ(object["size"].numbers(2), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(object["name"].string(), "cube");
  EXPECT_FALSE(object["hidden"].boolean());
  EXPECT_EQ(object["n"].integer(0, 7), 7);
  expect_error([&] { object["n"].integer(0, 6); },
               {"s.json: objects[0].n must be a whole number from 0 to 6, not 7"});
  expect_error([&] { object["size"][1].integer(0, 6); }, {"objects[0].size[1] must be", "not 2.5"});
  expect_error([&] { object["size"].numbers(3); },
               {"objects[0].size must be an array of 3 numbers, not [1,2.5]"});
  expect_error([&] { object["colour"]; }, {"objects[0].colour is missing"});
  expect_error([&] { root["objects"][1]; }, {"objects[1] is missing"});
  expect_error([&] { root["objects"]["x"]; }, {"objects must be an object"});
  expect_error([&] { object["name"].number(); }, {"must be a number, not \"cube\""});
  expect_error([&] { object["name"].boolean(); }, {"must be true or false"});
  expect_error([&] { object["n"].string(); }, {"must be a string"});
  expect_error([&] { object["n"].size(); }, {"must be an array"});
}

TEST(JsonView, IntegersBeyond64Bits) {
  const Json value = parse_json("[18446744073709551615, -9223372036854775808]", "x");
  expect_error([&] { JsonView(value, "x")[0].integer(INT64_MIN, INT64_MAX); },
               {"x: [0] must be a whole number"});
  EXPECT_EQ(JsonView(value, "x")[1].integer(INT64_MIN, INT64_MAX), INT64_MIN);
}

}  // namespace
}  // namespace vkopple
