// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/report/number_text.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(NumberText, HasThreeSignificantDigitsAndNoPowerOfTen) {
  EXPECT_EQ(readable(0.01234), "0.0123");
  EXPECT_EQ(readable(1.234), "1.23");
  EXPECT_EQ(readable(123.4), "123");
  EXPECT_EQ(readable(-12345.6), "-12346");
  EXPECT_EQ(readable(1e-5), "0");
  EXPECT_EQ(readable(std::numeric_limits<double>::quiet_NaN()), "-");
}

TEST(NumberText, HasNoNegativeZero) {
  EXPECT_EQ(fixed(-0.001, 2), "0.00");
  EXPECT_EQ(fixed(-0.01, 2), "-0.01");
}

}  // namespace
}  // namespace pcavr
