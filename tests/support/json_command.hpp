// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/command.hpp"

/// Runs the command with --json, and expects it to succeed.
inline nlohmann::json run_json(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const CommandOutcome outcome = run_pcavr(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << arguments[0] << ' ' << arguments[1] << ": "
                                  << outcome.standard_error;
  return nlohmann::json::parse(outcome.standard_output, nullptr, false);
}

/// Expects |report[key]| <= bound. Prints the measured value next to it.
inline void expect_within(const nlohmann::json& report, const std::string& key, double bound) {
  ASSERT_TRUE(report.contains(key)) << key;
  const double value = report[key].get<double>();
  std::printf("  %-62s %.6g (at most %.6g)\n", key.c_str(), value, bound);
  EXPECT_LE(std::abs(value), bound) << key;
}

/// Name and content of every file below a folder.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[std::filesystem::relative(entry.path(), folder).string()] =
        pcavr::read_file(entry.path()).value();
  }
  return files;
}
