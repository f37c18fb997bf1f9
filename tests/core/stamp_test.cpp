// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/stamp.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

TEST(ParseStamp, ReadsDecimalSecondsExactly) {
  EXPECT_EQ(parse_stamp("1305031480.050000")->nanoseconds, 1'305'031'480'050'000'000);
  EXPECT_EQ(parse_stamp("0.000000001")->nanoseconds, 1);
  EXPECT_EQ(parse_stamp("-0.5")->nanoseconds, -500'000'000);
  EXPECT_EQ(parse_stamp("12")->nanoseconds, 12'000'000'000);
  EXPECT_EQ(parse_stamp("12.")->nanoseconds, 12'000'000'000);
}

TEST(ParseStamp, RefusesTextThatIsNotATime) {
  for (const char* text : {"", "-", ".5", "1e9", "nan", "1.2.3", "1 ", "+1", "0.0000000001",
                           "9999999999999999999999", "4611686019"}) {
    EXPECT_FALSE(parse_stamp(text)) << text;
  }
}

TEST(FormatStamp, RoundsToItsDecimals) {
  EXPECT_EQ(format_stamp({1'999'999'999}, 3), "2.000");
  EXPECT_EQ(format_stamp({1'234'567'890}, 6), "1.234568");
  EXPECT_EQ(format_stamp({-1'500'000'000}, 1), "-1.5");
  // The ends of 64 bits, also where they are rounded away from zero.
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(format_stamp({kMin}, 9), "-9223372036.854775808");
  EXPECT_EQ(format_stamp({kMin}, 0), "-9223372037");
  EXPECT_EQ(format_stamp({kMax}, 9), "9223372036.854775807");
  EXPECT_EQ(format_stamp({kMax}, 0), "9223372037");
  EXPECT_EQ(format_stamp({-400}, 6), "0.000000");
  EXPECT_EQ(format_stamp({1'500'000'000}, 0), "2");
}

TEST(FormatStamp, IsReadBackExactly) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Stamp stamp{static_cast<std::int64_t>(random.bits()) / 4};
    EXPECT_EQ(parse_stamp(format_stamp(stamp, 9)).value(), stamp);
  }
}

TEST(Stamp, FromSecondsRoundsToTheNearestNanosecond) {
  EXPECT_EQ(Stamp::from_seconds(-0.25).nanoseconds, -250'000'000);
  EXPECT_EQ(Stamp::from_seconds(1e-9).nanoseconds, 1);
  EXPECT_EQ(Stamp::from_seconds(1305031480.25).nanoseconds, 1'305'031'480'250'000'000);
  EXPECT_THROW((void)Stamp::from_seconds(std::nan("")), ContractError);
  EXPECT_THROW((void)Stamp::from_seconds(1e10), ContractError);
}

}  // namespace
}  // namespace pcavr
