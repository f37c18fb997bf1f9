// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/number_text.hpp"

#include <limits>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/report/parameter_title.hpp"

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

TEST(NumberText, HasAsManyDecimalsAsTheStandardDeviationAllows) {
  const auto text = [](double value, std::optional<double> std) {
    const UncertainText both = uncertain(value, std);
    return both.value + " ± " + both.std;
  };
  EXPECT_EQ(text(3.128, 0.207), "3.13 ± 0.21");
  EXPECT_EQ(text(0.22978, 0.0048), "0.2298 ± 0.0048");
  EXPECT_EQ(text(58.04, 27.6), "58 ± 28");
  EXPECT_EQ(text(14989.0, 3208.0), "1.50e+04 ± 0.32e+04");
  EXPECT_EQ(text(2.771e5, 8.6e4), "2.77e+05 ± 0.86e+05");
  EXPECT_EQ(text(-4.5e11, 1e9), "-4.500e+11 ± 0.010e+11");
  EXPECT_EQ(text(1e-12, 1e-13), "1.00e-12 ± 0.10e-12");
}

TEST(NumberText, HasADashForAnUnknownStandardDeviation) {
  EXPECT_EQ(uncertain(1.25, {}).value, "1.25");
  EXPECT_EQ(uncertain(1.25, {}).std, "-");
  EXPECT_EQ(uncertain(1.25, 0.0).std, "-");
  EXPECT_EQ(uncertain(3e6, std::numeric_limits<double>::infinity()).std, "-");
  EXPECT_EQ(uncertain(std::numeric_limits<double>::quiet_NaN(), 1.0).value, "-");
}

TEST(ParameterTitle, IsWordsAndASymbolAndNeverAKey) {
  EXPECT_EQ(parameter_title("limiting_static_friction"), "Limiting friction F_M");
  EXPECT_EQ(parameter_title("contact.stiffness"), "Contact stiffness k");
  EXPECT_EQ(parameter_title("some.new_thing"), "some new thing");
}

}  // namespace
}  // namespace pcavr
