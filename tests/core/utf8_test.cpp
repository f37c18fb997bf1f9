// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/utf8.hpp"

#include <string>

#include <gtest/gtest.h>

#include "pcavr/physics/object/parameters_file.hpp"

namespace pcavr {
namespace {

TEST(Utf8, AcceptsTextOfAnyLanguage) {
  for (const char* text : {"", "box", "Würfel", "箱", "коробка", "\xf0\x9f\x93\xa6"}) {
    EXPECT_TRUE(is_utf8_text(text)) << text;
  }
}

TEST(Utf8, ReplacesInvalidBytes) {
  EXPECT_EQ(as_utf8_text("Würfel"), "Würfel");
  EXPECT_EQ(as_utf8_text("rec\xff/a"), "rec\xEF\xBF\xBD/a");
  EXPECT_TRUE(is_utf8_text(as_utf8_text("W\xfcrfel \xc3")));
  // A comment that names such a path leaves the table readable.
  const std::string text = format_parameters({{"box", {}}}, "from rec\xff");
  EXPECT_TRUE(parse_parameters(text, "p.yaml").has_value());
}

TEST(Utf8, PrintsWhatTerminalsActOnAsText) {
  EXPECT_EQ(printable("Würfel\tbox 箱"), "Würfel\tbox 箱");
  EXPECT_EQ(printable("\x1b]0;title\x07"), "\\x1b]0;title\\x07");
  EXPECT_EQ(printable("gnp\xe2\x80\xaeexe\xe2\x81\xa6"), "gnp\\u202eexe\\u2066");
  EXPECT_EQ(printable("two\nlines\r"), "two\\x0alines\\x0d");
  EXPECT_EQ(printable_lines("two\nlines\x1b\n"), "two\nlines\\x1b\n");
  EXPECT_EQ(printable("\xf3\xa0\x80\xa1"), "\\U000e0021");  // an invisible tag
  EXPECT_EQ(printable("0123456789", 8), "012345 ... (10 bytes) ... 89");
  EXPECT_TRUE(is_utf8_text(printable(std::string(9999, 'x') + "ü", 9)));
  EXPECT_TRUE(has_controls("a\x1b") && has_controls("a\xff") && has_controls("\xc2\x85"));
  EXPECT_FALSE(has_controls("Würfel 箱\t"));
}

TEST(Utf8, RefusesInvalidEncodings) {
  for (const char* bytes : {
           "W\xfcrfel",             // Latin-1
           "\xc3",                  // truncated
           "\x80",                  // continuation byte without a lead byte
           "\xc0\xaf",              // '/' in two bytes (overlong)
           "\xe0\x80\xaf",          // and in three
           "\xed\xa0\x80",          // lone surrogate
           "\xf4\x90\x80\x80",      // beyond U+10FFFF
           "\xef\xbf\xbe",          // U+FFFE
           "\xef\xb7\x90",          // U+FDD0
           "\xf8\x88\x80\x80\x80",  // five bytes
           "\xff",
       }) {
    EXPECT_FALSE(is_utf8_text(bytes)) << bytes;
  }
}

TEST(Utf8, IsRequiredOfEveryNameInAFile) {
  const auto latin = parse_parameters("W\xfcrfel: {mass: 2}\n", "p.yaml");
  ASSERT_FALSE(latin.has_value());
  EXPECT_EQ(latin.error().message, "is not UTF-8 text");
  EXPECT_EQ(latin.error().line, 1);
  EXPECT_FALSE(parse_parameters("\"\\uFFFE\": {mass: 2}\n", "p.yaml").has_value());
  EXPECT_TRUE(parse_parameters("Würfel: {mass: 2}\n", "p.yaml").has_value());
}

}  // namespace
}  // namespace pcavr
