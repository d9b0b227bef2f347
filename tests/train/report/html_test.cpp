#include "train/report/html.h"

#include <gtest/gtest.h>

#include "train/image_io.h"

namespace vkopple {
namespace {

std::string encoded(const std::string& text) { return base64(std::as_bytes(std::span(text))); }

TEST(EscapeHtml, NothingIsAnElementOrEndsAnAttribute) {
  EXPECT_EQ(escape_html(R"(<a href="x" id='y'>&amp;)"), "&lt;a href=&quot;x&quot; id=&#39;y&#39;&gt;&amp;amp;");
  EXPECT_EQ(escape_html("plain text, ÄÖ 你 🂡"), "plain text, ÄÖ 你 🂡");
  EXPECT_EQ(escape_html(""), "");
}

TEST(EscapeHtml, WhatIsNoTextIsReplaced) {
  EXPECT_EQ(escape_html(std::string("a\0b\x1b\x7f", 5)), "a?b??");
  EXPECT_EQ(escape_html("a\tb\nc"), "a\tb\nc");
  EXPECT_EQ(escape_html("\xff\xc0\x80\x80x"), "????x");  // never UTF-8, longer than needed, a part
  EXPECT_EQ(escape_html("\xe4\xbd"), "??");              // cut off
  EXPECT_EQ(escape_html("\xed\xa0\x80"), "???");         // half of a pair of UTF-16
  EXPECT_EQ(escape_html("\xf4\x90\x80\x80"), "????");    // beyond the last character
  EXPECT_EQ(escape_html("\xc3<"), "?&lt;");
}

TEST(Base64, AsInTheStandard) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("\xfb\xff\xfe"), "+//+");
}

TEST(PictureHtml, HoldsThePngItself) {
  const RgbImage picture(2, 3);
  const std::string html = picture_html(picture, "a \"b\"");
  EXPECT_NE(html.find("src=\"data:image/png;base64," + base64(encode_png(picture)) + "\""), std::string::npos);
  EXPECT_NE(html.find(R"(width="3" height="2" alt="a &quot;b&quot;")"), std::string::npos) << html;
}

}  // namespace
}  // namespace vkopple
