// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/report/report_command.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/report/report_page.hpp"

namespace pcavr {
namespace {

TEST(ReportCommand, IsAsAShellTakesItWithoutItsOutput) {
  std::vector<std::string> given{"/a/pcavr",   "eval",   "it's mine", "-o",        "there",
                                 "--force",    "--seed", "3",         "--threads", "2",
                                 "--output=x", "-ox",    "--report=y"};
  std::vector<char*> words;
  for (std::string& word : given) words.push_back(word.data());
  EXPECT_EQ(command_of(words), "pcavr eval 'it'\\''s mine' --seed 3");
}

TEST(ReportCommand, IsInReportsOnceItIsSet) {
  const ReportPage page{.title = "A", .heading = "A"};
  EXPECT_FALSE(nlohmann::json::parse(format_report_data(page)).contains("command"));
  set_report_command("pcavr <b>");
  const nlohmann::json json = nlohmann::json::parse(format_report_data(page));
  set_report_command({});
  EXPECT_EQ(json["command"], "pcavr <b>");
}

}  // namespace
}  // namespace pcavr
