#include "train/pickle/pickle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/support/expect_error.h"
#include "tests/support/unhex.h"
#include "tests/train/pickle/samples.h"
#include "train/pickle/numpy_array.h"

namespace vkopple {
namespace {

using test::expect_error;
using test::unhex;
using testing::ElementsAre;

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

/// Expects the pickle to be refused with a place and each of `parts`.
void expect_refused(std::string_view pickle, std::initializer_list<std::string> parts,
                    PickleLimits limits = {}) {
  expect_error([&] { Pickle(bytes_of(pickle), "p.pickle", {"allowed.f"}, limits); }, parts);
}

constexpr std::array kProtocols{test::kProtocol0, test::kProtocol1, test::kProtocol2,
                                test::kProtocol3, test::kProtocol4, test::kProtocol5};

TEST(Pickle, ReadsPlainDataOfEveryProtocol) {
  for (size_t protocol = 0; protocol < kProtocols.size(); ++protocol) {
    SCOPED_TRACE(protocol);
    const Pickle pickle(unhex(kProtocols[protocol]), "p.pickle");
    const PickleView view = pickle.view();
    EXPECT_EQ(view["text"].string(), "a\xC3\xA9'\n\\\xF0\x9F\x99\x82");
    const PickleView rows = view["rows"];
    EXPECT_EQ(rows.size(), 2U);
    EXPECT_EQ(rows[0][0].value().real(), 0.1);
    EXPECT_EQ(rows[0][2].value().real(), 1e300);
    EXPECT_TRUE(std::isinf(rows[0][3].value().real()));
    EXPECT_THAT(rows[1].numbers({4}), ElementsAre(3, -4, 70000, 255));
    EXPECT_TRUE(view["none"].value().is(PickleKind::kNone));
    EXPECT_TRUE(view["flags"][0].value().boolean());
    EXPECT_FALSE(view["flags"][1].value().boolean());
    EXPECT_EQ(view["big"].value().integer(), int64_t{1} << 40);
    EXPECT_EQ(view["least"].value().integer(), INT64_MIN);
    EXPECT_EQ(view["bytes"].value().text(), std::string("\0\xFF'", 3));
    EXPECT_TRUE(view["bytes"].value().is(PickleKind::kBytes));
    EXPECT_EQ(view["array"].value().text(), "\x80");
    EXPECT_EQ(view["set"].value().items()[0].integer(), 7);
    EXPECT_EQ(view["frozen"].value().items()[0].integer(), 8);
    EXPECT_THAT(view["four"].numbers({4}), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(view["three"].numbers({3}), ElementsAre(1, 2, 3));
    EXPECT_THAT(view["two"].numbers({2}), ElementsAre(1, 2));
    EXPECT_EQ(view["shared"][1][0].string(), "x");
    EXPECT_EQ(view["ordered"]["l"].integer(0, 9), 2);
    EXPECT_EQ(view["ordered"].value().items()[0].text(), "k");
    EXPECT_EQ(view["ordered"].value().items()[2].text(), "l");
    EXPECT_EQ(view["long"].string(), std::string(300, 'y'));
  }
}

TEST(Pickle, ReadsEmptyThings) {
  using enum PickleKind;
  for (const char* sample : kProtocols) {
    const Pickle pickle(unhex(sample), "p.pickle");
    const PickleView nothing = pickle.view()["nothing"];
    const std::array kinds{kList, kTuple, kDict, kSet, kBytes, kString};
    ASSERT_EQ(nothing.size(), kinds.size());
    for (size_t i = 0; i < kinds.size(); ++i) EXPECT_EQ(nothing[i].value().kind(), kinds[i]) << i;
    for (size_t i = 0; i < 4; ++i) EXPECT_TRUE(nothing[i].value().items().empty());
  }
}

TEST(Pickle, ReadsArraysOfNumpy) {
  for (const char* sample : {test::kNumpyProtocol0, test::kNumpyProtocol4, test::kNumpyProtocol5}) {
    const Pickle pickle(unhex(sample), "n.pickle", numpy_globals());
    const PickleView view = pickle.view();
    EXPECT_THAT(view["matrix"].numbers({2, 3}), ElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_THAT(view["columns"].numbers({2, 3}), ElementsAre(0, 1, 2, 3, 4, 5));
    EXPECT_EQ(numpy_array(view["columns"].value())->dtype, StoredType::kI16);
    EXPECT_THAT(view["float"].numbers({}), ElementsAre(1.5));
    EXPECT_EQ(view["int"].integer(-8, 0), -7);
    EXPECT_EQ(numpy_array(view["bools"].value())->dtype, StoredType::kBool);
    EXPECT_THAT(view["rows"].numbers({2, 2}), ElementsAre(1, 2, 3, 4));
    EXPECT_FALSE(numpy_array(view["big"].value()));
    EXPECT_FALSE(numpy_array(view["words"].value()));
    expect_error([&] { view["matrix"].numbers({3, 2}); }, {"n.pickle: 'matrix'", "3 x 2 numbers"});
    expect_error([&] { view["bools"].numbers({2}); }, {"'bools'", "2 numbers"});
    expect_error([&] { view["float"].integer(0, 9); }, {"'float'", "whole number from 0 to 9"});
  }
  expect_error([] { Pickle(unhex(test::kNumpyProtocol4), "n.pickle"); },
               {"n.pickle: byte", "numpy", "refused"});
}

/// The bytes of an array must be as many as its shape says, whatever the shape claims.
TEST(Pickle, RefusesArraysOfAnotherSize) {
  const auto array = [](const std::string& shape) {
    return "cnumpy.core.numeric\n_frombuffer\n(C\x08" + std::string(8, 'x') +
           "cnumpy\ndtype\n(U\x02"
           "f4tR(K\x03U\x01<tb(" +
           shape +
           "tU\x01"
           "CtR.";
  };
  const auto read = [&](const std::string& shape) {
    const std::string text = array(shape);
    return numpy_array(Pickle(bytes_of(text), "n", numpy_globals()).root());
  };
  EXPECT_TRUE(read("K\x02"));
  EXPECT_FALSE(read("K\x03"));
  EXPECT_FALSE(read("I-2\n"));
  EXPECT_FALSE(read("I4611686018427387904\nK\x04K\x02"));
  EXPECT_FALSE(read("N"));
}

TEST(Pickle, ReadsStringsOfPython2) {
  const Pickle pickle(bytes_of("(S'a\\x01\\'\\n\\101\\\\'\nS\"it's\"\nU\x02\xE9yI7\nL8L\nF1.5\nt."), "p");
  const auto items = pickle.root().items();
  EXPECT_EQ(items[0].text(), "a\x01'\nA\\");
  EXPECT_EQ(items[1].text(), "it's");
  EXPECT_EQ(items[2].text(), "\xE9y");
  EXPECT_EQ(items[3].integer(), 7);
  EXPECT_EQ(items[4].integer(), 8);
  EXPECT_EQ(items[5].real(), 1.5);
}

TEST(Pickle, CallsNothing) {
  const Pickle pickle(bytes_of("callowed\nf\n(I1\nI2\ntR(dS'a'\nI3\nsb."), "p", {"allowed.f"});
  const PickleValue root = pickle.root();
  EXPECT_TRUE(root.is_call("allowed.f"));
  EXPECT_EQ(root.arguments()[1].integer(), 2);
  EXPECT_EQ(root.state().find("a")->integer(), 3);
  const Pickle persistent(bytes_of("(S'storage'\nS'0'\ntQ."), "p");
  ASSERT_TRUE(persistent.root().is(PickleKind::kPersistent));
  EXPECT_EQ(persistent.root().items()[0].items()[1].text(), "0");
}

TEST(Pickle, RefusesWhatIsNotPlainByName) {
  expect_refused("cos\nsystem\n(S'true'\ntR.", {"p.pickle: byte 0: refers to 'os.system', which is refused"});
  expect_refused("(dcpandas.core.frame\nDataFrame\n.",
                 {"byte 2", "pandas.core.frame.DataFrame", "to_dict('list')"});
  expect_refused("cpandas\nDataFrame\n.", {"byte 0", "'pandas.DataFrame'", "to_dict('list')"});
  expect_refused("\x80\x04\x8c\x02os\x8c\x06system\x93.", {"byte 14", "'os.system'"});
  expect_refused("callowed\ng\n.", {"'allowed.g'"});
  expect_refused("callowed.f\nx\n.", {"'allowed.f.x'"});
  expect_refused("cbuiltins\neval\n.", {"'builtins.eval'"});
  expect_refused("c__builtin__\nset\n(I1\ntR.", {"'__builtin__.set'", "arguments"});
  expect_refused("c_codecs\nencode\n(Va\nVutf8\ntR.", {"'_codecs.encode'", "arguments"});
  expect_refused("c_codecs\nencode\n(V\\u0100\nVlatin1\ntR.", {"'_codecs.encode'", "arguments"});
  expect_refused("ccollections\nOrderedDict\n(I1\ntR.", {"OrderedDict", "arguments"});
  expect_refused("ccollections\nOrderedDict\n((I1\nltR.", {"OrderedDict", "arguments"});
  expect_refused("(iallowed\nf\n.", {"byte 1", "0x69 ('i')", "not one of plain data"});
  expect_refused("P1\n.", {"byte 0", "0x50 ('P')"});
  expect_refused("\x82\x01.", {"0x82"});
  expect_refused("\x97.", {"0x97"});
}

TEST(Pickle, RefusesDamage) {
  expect_refused("", {"p.pickle: byte 0", "cut off"});
  expect_refused("(I1\n", {"byte 4", "cut off"});
  expect_refused("I12", {"byte 0", "line without an end"});
  expect_refused("Ix\n.", {"'x' is not a whole number of 64 bits"});
  expect_refused("I9223372036854775808\n.", {"'9223372036854775808' is not a whole number of 64 bits"});
  expect_refused("Fx\n.", {"'x' is not a number"});
  expect_refused("Sx\n.", {"'x' is not a string of Python"});
  expect_refused("S'a\n.", {"not a string of Python"});
  expect_refused("S'a'b'\n.", {"not a string of Python"});
  expect_refused("S'\\q'\n.", {"not a string of Python"});
  expect_refused("S'\\x0'\n.", {"not a string of Python"});
  expect_refused("S'\\777'\n.", {"not a string of Python"});
  expect_refused("V\\u12\n.", {"not a string of Python"});
  expect_refused("V\\U00110000\n.", {"not a string of Python"});
  expect_refused(".", {"byte 0", "leaves 0 values"});
  expect_refused("I1\nI2\n.", {"leaves 2 values"});
  expect_refused("(I1\n.", {"leaves 1 values"});
  expect_refused("I1\n.junk", {"4 bytes follow its end"});
  expect_refused("0.", {"takes a value that it has not given"});
  expect_refused("I1\n(s.", {"takes a value that it has not given"});
  expect_refused("t.", {"ends a group that it has not begun"});
  expect_refused("(I1\nd.", {"a key that has no value"});
  expect_refused("I1\nI2\na.", {"adds items to a whole number instead of a list"});
  expect_refused("]I1\nI2\ns.", {"adds items to a list instead of a dict"});
  expect_refused("](I1\n\x90.", {"adds items to a list instead of a set"});
  expect_refused("g0\n.", {"recalls value 0"});
  expect_refused("h\x07.", {"recalls value 7"});
  expect_refused("I1\np-1\n.", {"-1 is not a place"});
  expect_refused("I1\nI2\nb.", {"gives a state to a whole number"});
  expect_refused("I1\n)R.", {"a whole number where a global was expected"});
  expect_refused("callowed\nf\nI1\nR.", {"a whole number where a tuple was expected"});
  expect_refused("\x80\x06.", {"protocol 6", "up to 5"});
  expect_refused(
      "\x8a\x09"
      "123456789.",
      {"a whole number of 9 bytes"});
}

/// Lengths are held against what is left before anything of their size is taken.
TEST(Pickle, RefusesLengthsBeyondTheEnd) {
  for (const char op : {'X', 'T', 'B', '\x8b'})
    expect_refused(std::string(1, op) +
                       "\xFF\xFF\xFF\x7F"
                       "abc",
                   {"byte 0: 2147483647 bytes are announced, 3 are left"});
  for (const char op : {'\x8d', '\x8e', '\x96'})
    expect_refused(std::string(1, op) + std::string(8, '\xFF') + "abc",
                   {"18446744073709551615 bytes are announced, 3 are left"});
  expect_refused("J\x01.", {"4 bytes are announced, 2 are left"});
  expect_refused("G\x01.", {"8 bytes are announced"});
}

TEST(Pickle, Limits) {
  const auto nested = [](size_t depth) { return std::string(depth, ']') + std::string(depth - 1, 'a') + "."; };
  EXPECT_NO_THROW(Pickle(bytes_of(nested(64)), "p"));
  expect_refused(nested(65), {"p.pickle: it is nested deeper than 64 levels"});
  expect_refused(nested(100'000), {"nested deeper than 64 levels"});
  // What is shared is as deep as at its deepest place.
  const auto wrapped = [&](size_t depth) {
    const std::string shared = nested(40);
    return "(" + shared.substr(0, shared.size() - 1) + "p0\n" + std::string(depth, ']') + "g0\n" +
           std::string(depth, 'a') + "t.";
  };
  EXPECT_NO_THROW(Pickle(bytes_of(wrapped(23)), "p"));
  expect_refused(wrapped(24), {"nested deeper than 64 levels"});
  expect_refused("]p0\ng0\na.", {"contains itself"});
  expect_refused("callowed\nf\n)Rp0\ng0\nb.", {"contains itself"});
  expect_refused("(I1\nI2\nI3\nt.", {"byte 7", "more values than are allowed"}, {.max_values = 2});
  EXPECT_NO_THROW(Pickle(bytes_of("(I1\nI2\nI3\nt."), "p", {}, {.max_values = 4}));
  // Each level holds the one below twice: 2^60 leaves, walked once each.
  std::string doubled = "]";
  for (int i = 0; i < 60; ++i) doubled += "2\x86";
  EXPECT_NO_THROW(Pickle(bytes_of(doubled + "."), "p"));
}

/// A builtin copies its argument, which a pickle need not repeat to have it copied again.
TEST(Pickle, CountsWhatBuiltinsCopy) {
  struct Case {
    std::string global, argument, more;
    int most;  ///< copies within 1000 values
  };
  std::string ones = "(", pairs = "I1\nI2\n\x86p2\n0(";
  for (int i = 0; i < 100; ++i) ones += "I1\n";
  for (int i = 0; i < 50; ++i) pairs += "g2\n";
  const std::string text = std::string("X\x40\x06\0\0", 5) + std::string(1600, 'a');
  const std::array cases{
      Case{"c_codecs\nencode\n", text, "Vlatin1\n", 9}, Case{"c__builtin__\nbytes\n", text, "Vlatin1\n", 9},
      Case{"c__builtin__\nset\n", ones + "l", "", 8}, Case{"ccollections\nOrderedDict\n", pairs + "l", "", 9}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.global);
    const auto copied = [&](int times) {
      std::string pickle = "(" + c.global + "p0\n0" + c.argument + "p1\n0";
      for (int i = 0; i < times; ++i) pickle += "g0\n(g1\n" + c.more + "tR";
      return pickle + "t.";
    };
    EXPECT_NO_THROW(Pickle(bytes_of(copied(c.most)), "p", {}, {.max_values = 1000}));
    expect_refused(copied(c.most + 1), {"more values than are allowed"}, {.max_values = 1000});
  }
}

/// Whatever is done to a byte, it is read or refused.
TEST(Pickle, SurvivesEveryDamagedByte) {
  size_t refused = 0;
  for (const char* sample : {test::kProtocol0, test::kProtocol4, test::kNumpyProtocol5}) {
    std::vector<std::byte> bytes = unhex(sample);
    for (std::byte& byte : bytes) {
      const std::byte good = byte;
      for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
        byte = good ^ static_cast<std::byte>(flip);
        try {
          const Pickle pickle(bytes, "p", numpy_globals());
        } catch (const Error&) {
          ++refused;
        }
      }
      byte = good;
    }
    for (size_t length = 0; length < bytes.size(); ++length)
      EXPECT_THROW(Pickle(std::span(bytes).first(length), "p", numpy_globals()), Error) << length;
  }
  EXPECT_GT(refused, 1000U);
}

TEST(PickleView, NamesThePlace) {
  const Pickle pickle(bytes_of("(dS'rows'\n(lI1\naS'x'\naFinf\nas."), "map.pickle");
  const PickleView view = pickle.view();
  EXPECT_TRUE(view.contains("rows"));
  EXPECT_FALSE(view.contains("row"));
  expect_error([&] { view["row"]; }, {"map.pickle has no 'row'"});
  expect_error([&] { view["rows"][3]; }, {"map.pickle: 'rows' has 3 items, no [3]"});
  expect_error([&] { view["rows"][0].string(); },
               {"map.pickle: 'rows'[0] must be a string, not a whole number"});
  expect_error([&] { view["rows"][0].integer(2, 3); }, {"'rows'[0] must be a whole number from 2 to 3, not 1"});
  expect_error([&] { view["rows"]["x"]; }, {"'rows' must be a dict, not a list"});
  expect_error([&] { view[size_t{0}]; }, {"map.pickle must be a list, not a dict"});
  expect_error([&] { view["rows"].numbers({3}); }, {"'rows' must be 3 numbers"});
  expect_error([&] { view["rows"][2].numbers({}); }, {"'rows'[2] must be finite, not inf"});
}

}  // namespace
}  // namespace vkopple
