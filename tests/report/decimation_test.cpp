// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/report/decimation.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr int kColumns = 100;

PlotSeries sine(int points) {
  PlotSeries series{.label = "sine", .color = 2, .dashed = true};
  for (int i = 0; i < points; ++i) {
    const double t = 10.0 * i / points;
    series.x.push_back(t);
    series.y.push_back(std::sin(t));
  }
  return series;
}

std::size_t count_breaks(const PlotSeries& series) {
  return static_cast<std::size_t>(
      std::count_if(series.y.begin(), series.y.end(), [](double y) { return std::isnan(y); }));
}

TEST(Decimation, LeavesAShortSeriesAsItIs) {
  const PlotSeries full = sine(3 * kColumns);
  EXPECT_EQ(decimated(full, kColumns).y, full.y);
}

TEST(Decimation, KeepsAPeakOfASingleSampleInAMillion) {
  PlotSeries full = sine(1'000'000);
  full.y[123'456] = 7.0;
  full.y[654'321] = -7.0;
  const PlotSeries few = decimated(full, kColumns);
  EXPECT_LE(few.x.size(), 2U * kColumns + 2U);
  EXPECT_GE(few.x.size(), 2U * kColumns - 2U);
  const auto high = std::max_element(few.y.begin(), few.y.end()) - few.y.begin();
  const auto low = std::min_element(few.y.begin(), few.y.end()) - few.y.begin();
  EXPECT_EQ(few.y[static_cast<std::size_t>(high)], 7.0);
  EXPECT_EQ(few.x[static_cast<std::size_t>(high)], full.x[123'456]);
  EXPECT_EQ(few.y[static_cast<std::size_t>(low)], -7.0);
  EXPECT_EQ(few.label, "sine");
  EXPECT_EQ(few.color, 2);
  EXPECT_TRUE(few.dashed);
}

TEST(Decimation, KeepsTheOrderOfTheValues) {
  const PlotSeries few = decimated(sine(100'000), kColumns);
  EXPECT_TRUE(std::is_sorted(few.x.begin(), few.x.end()));
}

TEST(Decimation, KeepsBreaks) {
  PlotSeries full = sine(10'000);
  full.y[5'000] = kLineBreak;  // a gap of one sample
  full.x[7'000] = full.y[7'000] = kLineBreak;
  EXPECT_EQ(count_breaks(decimated(full, kColumns)), 2U);
}

TEST(Decimation, DrawsSeveralPassesOverTheAxis) {
  PlotSeries full = sine(5'000);
  const PlotSeries back = sine(5'000);
  full.x.push_back(kLineBreak);
  full.y.push_back(kLineBreak);
  for (std::size_t i = 0; i < back.x.size(); ++i) {
    full.x.push_back(back.x[i]);
    full.y.push_back(back.y[i] + 5.0);
  }
  const PlotSeries few = decimated(full, kColumns);
  EXPECT_LE(few.x.size(), 4U * kColumns + 5U);
  EXPECT_EQ(count_breaks(few), 1U);
  EXPECT_NEAR(*std::max_element(few.y.begin(), few.y.begin() + 2 * kColumns - 10), 1.0, 1e-4);
  EXPECT_NEAR(few.y.back(), back.y.back() + 5.0, 1e-2);
}

TEST(Decimation, RoundsToAHundredThousandthOfTheRange) {
  const std::vector<double> rounded = rounded_to_range({0.123456789, 20.0, kLineBreak, -1e-9});
  EXPECT_EQ(rounded[0], 0.1235);
  EXPECT_EQ(rounded[1], 20.0);
  EXPECT_TRUE(std::isnan(rounded[2]));
  EXPECT_FALSE(std::signbit(rounded[3]));
  EXPECT_EQ(rounded_to_range({1234.56789, 1234.56799})[0], 1234.56789);
  EXPECT_TRUE(rounded_to_range({}).empty());
  EXPECT_EQ(rounded_to_range({40.62, 40.62}).front(), 40.62);
}

}  // namespace
}  // namespace pcavr
