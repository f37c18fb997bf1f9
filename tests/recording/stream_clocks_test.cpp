// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

StreamSpan span(const char* name, double first, double last) {
  return {name, Stamp::from_seconds(first), Stamp::from_seconds(last)};
}

TEST(CompareClocks, ReportsBothRangesOfStreamsThatDoNotOverlap) {
  const auto conflict =
      compare_clocks(span("wrench.csv", 1000.0, 1012.3), span("tool.csv", 0.0, 12.3));
  ASSERT_TRUE(conflict.has_value());
  EXPECT_TRUE(conflict->is_disjoint);
  EXPECT_EQ(clock_error(*conflict, "push").to_string(),
            "push: wrench.csv covers 1000.0 to 1012.3 s, tool.csv 0.0 to 12.3 s: they do not "
            "overlap; put both on one clock");
}

TEST(CompareClocks, ReportsAnOverlapOfLessThanATenthOfTheShorter) {
  const auto conflict = compare_clocks(span("wrench.csv", 19.5, 39.5), span("tool.csv", 0.0, 20.0));
  ASSERT_TRUE(conflict.has_value());
  EXPECT_FALSE(conflict->is_disjoint);
  EXPECT_NE(conflict->message.find("they overlap for 500 ms, 2 % of the shorter"),
            std::string::npos)
      << conflict->message;
  EXPECT_FALSE(compare_clocks(span("a", 17.0, 37.0), span("b", 0.0, 20.0)).has_value());
}

TEST(CompareClocks, AcceptsAStreamInsideAnother) {
  EXPECT_FALSE(compare_clocks(span("a", 5.0, 6.0), span("b", 0.0, 600.0)).has_value());
  EXPECT_FALSE(compare_clocks(span("a", 5.0, 5.0), span("b", 0.0, 600.0)).has_value());
}

TEST(CompareClocks, KeepsTheDigitsOfStampsSince1970) {
  const auto conflict = compare_clocks(span("wrench.csv", 1.7e9 + 1000.0, 1.7e9 + 1012.3),
                                       span("tool.csv", 1.7e9, 1.7e9 + 12.3));
  ASSERT_TRUE(conflict.has_value());
  EXPECT_NE(conflict->message.find("1700001000.0 to 1700001012.3 s"), std::string::npos)
      << conflict->message;
}

TEST(FindClockConflicts, ComparesEachPairOfStreams) {
  Recording recording;
  EXPECT_EQ(start_of(recording), Stamp{});
  EXPECT_TRUE(find_clock_conflicts(recording).empty());
  for (int i = 0; i < 10; ++i) {
    recording.tool.append(Stamp::from_seconds(5.0 + i), Pose());
    const Eigen::Vector3d none(0.0, 0.0, 0.0);
    recording.wrench.push_back({Stamp::from_seconds(4.0 + i), none, none});
    recording.frames.push_back(
        {Stamp::from_seconds(100.0 + i), "", Stamp::from_seconds(100.0 + i), ""});
  }
  const auto conflicts = find_clock_conflicts(recording);
  ASSERT_EQ(conflicts.size(), 2U);
  for (const ClockConflict& conflict : conflicts) EXPECT_EQ(conflict.second, "depth.txt");
  EXPECT_EQ(start_of(recording), Stamp::from_seconds(4.0));
}

}  // namespace
}  // namespace pcavr
