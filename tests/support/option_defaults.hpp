// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include "pcavr/base/core/options.hpp"

namespace pcavr::test {

/// Expects every field of a new object to have its documented default, which lies inside its range,
/// and each row to set the field that it gets.
template <typename Options>
void expect_documented_defaults() {
  Options options;
  OptionSection section = section_of(options);
  EXPECT_FALSE(section.rows.empty()) << section.name;
  for (const OptionRow& row : section.rows) {
    SCOPED_TRACE(section.name + "." + std::string(row.name));
    EXPECT_EQ(row.get(), row.default_value);
    EXPECT_GE(row.default_value, row.min);
    EXPECT_LE(row.default_value, row.max);
    for (const double end : {row.min, row.max}) {
      row.set(end);
      EXPECT_EQ(row.get(), end);
    }
    row.set(row.default_value);
  }
}

}  // namespace pcavr::test
