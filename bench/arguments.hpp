// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// What the comparisons that are run by hand do with their arguments: an error ends the program.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/options.hpp"

namespace pcavr::bench {

[[noreturn]] inline void fail(const std::string& line) {
  std::fprintf(stderr, "%s\n", line.c_str());
  std::exit(1);
}

template <typename T>
T value_or_exit(Expected<T> expected) {
  if (!expected) fail(expected.error().to_string());
  return std::move(expected).value();
}

/// `assignment`: SECTION.KEY=VALUE, in the option's unit.
inline void set_option(const std::vector<OptionSection>& sections, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) fail("no SECTION.KEY=VALUE: " + assignment);
  for (const OptionSection& section : sections) {
    for (const OptionRow& row : section.rows) {
      if (section.name + "." + std::string(row.name) != assignment.substr(0, equals)) continue;
      row.set(std::stod(assignment.substr(equals + 1)));
      return;
    }
  }
  fail("unknown option " + assignment);
}

}  // namespace pcavr::bench
