#include "train/pickle/pickle_writer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "train/pickle/pickle.h"

namespace vkopple {
namespace {

using namespace std::string_literals;

TEST(PickleWriter, WhatItWritesReadsTheSame) {
  PickleWriter out;
  out.dict([&] {
    out.text("texts");
    out.list([&] {
      out.text("");
      out.text("a\u00e9\n");
      out.text(std::string(300, 'y'));
    });
    out.text("wholes");
    out.tuple([&] {
      for (const std::int64_t value :
           {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1} << 40, std::numeric_limits<std::int64_t>::min()})
        out.whole(value);
    });
    out.text("numbers");
    out.list([&] {
      for (const double value : {0.1, -0.0, 1e300}) out.number(value);
    });
    out.text("truths");
    out.tuple([&] {
      out.truth(true);
      out.truth(false);
    });
  });
  const std::string bytes = out.finish();
  const Pickle pickle(std::as_bytes(std::span(bytes)), "p");
  const PickleView view = pickle.view();
  EXPECT_EQ(view["texts"].size(), 3U);
  EXPECT_EQ(view["texts"][0].string(), "");
  EXPECT_EQ(view["texts"][1].string(), "a\u00e9\n");
  EXPECT_EQ(view["texts"][2].string(), std::string(300, 'y'));
  EXPECT_TRUE(view["wholes"].value().is(PickleKind::kTuple));
  EXPECT_EQ(view["wholes"].size(), 4U);
  EXPECT_EQ(view["wholes"][0].value().integer(), 0);
  EXPECT_EQ(view["wholes"][1].value().integer(), -1);
  EXPECT_EQ(view["wholes"][2].value().integer(), std::int64_t{1} << 40);
  EXPECT_EQ(view["wholes"][3].value().integer(), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(view["numbers"][0].value().real(), 0.1);
  EXPECT_TRUE(std::signbit(view["numbers"][1].value().real()));
  EXPECT_EQ(view["numbers"][2].value().real(), 1e300);
  EXPECT_TRUE(view["truths"][0].value().boolean());
  EXPECT_FALSE(view["truths"][1].value().boolean());
}

TEST(PickleWriter, CallsAndWhatIsKeptElsewhere) {
  PickleWriter out;
  out.global("collections", "OrderedDict");
  out.empty_tuple();
  out.call();
  out.entries([&] {
    out.text("k");
    out.global("m", "make");
    out.tuple([&] {
      out.text("id");
      out.persistent();
    });
    out.call();
  });
  const std::string bytes = out.finish();
  const Pickle pickle(std::as_bytes(std::span(bytes)), "p", {"m.make"});
  const PickleView made = pickle.view()["k"];
  ASSERT_TRUE(made.value().is_call("m.make"));
  ASSERT_EQ(made.value().arguments().size(), 1U);
  const PickleValue kept = made.value().arguments()[0];
  ASSERT_TRUE(kept.is(PickleKind::kPersistent));
  EXPECT_EQ(kept.items()[0].text(), "id");
}

/// pickle.dumps([0.5, True], 2) of Python, without what it remembers for later.
TEST(PickleWriter, HasPythonsBytes) {
  PickleWriter out;
  out.list([&] {
    out.number(0.5);
    out.truth(true);
  });
  EXPECT_EQ(out.finish(), "\x80\x02](G\x3f\xe0\0\0\0\0\0\0\x88"s + "e.");
}

}  // namespace
}  // namespace vkopple
