// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_origin.hpp"

#include <array>
#include <cstdlib>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/report/report_page.hpp"

namespace pcavr {
namespace {

TEST(ReportOrigin, IsTheCommandAsAShellTakesItAndItsDate) {
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "86460", 1), 0);
  std::array<char, 9> program{"/a/pcavr"};
  std::array<char, 5> plain{"eval"};
  std::array<char, 10> spaced{"it's mine"};
  const std::array<char*, 3> words{program.data(), plain.data(), spaced.data()};
  const ReportOrigin origin = origin_of_command(words);
  EXPECT_EQ(origin.command, "pcavr eval 'it'\\''s mine'");
  EXPECT_EQ(origin.date, "1970-01-02 00:01 UTC");
  ASSERT_EQ(setenv("SOURCE_DATE_EPOCH", "yesterday", 1), 0);
  EXPECT_TRUE(origin_of_command(words).date.starts_with("20"));
  ASSERT_EQ(unsetenv("SOURCE_DATE_EPOCH"), 0);
}

TEST(ReportOrigin, IsInReportsOnceItIsSet) {
  const ReportPage page{.title = "A", .heading = "A"};
  EXPECT_FALSE(nlohmann::json::parse(format_report_data(page)).contains("command"));
  set_report_origin({.command = "pcavr <b>", .date = "a day"});
  const nlohmann::json json = nlohmann::json::parse(format_report_data(page));
  set_report_origin({});
  EXPECT_EQ(json["command"], "pcavr <b>");
  EXPECT_EQ(json["date"], "a day");
}

}  // namespace
}  // namespace pcavr
