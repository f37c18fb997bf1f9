// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/input_ranges.hpp"

#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "support/source_folder.hpp"

namespace pcavr {
namespace {

TEST(InputRange, ContainsItsLimitsAndNothingThatIsNotFinite) {
  for (const InputRange& range : ranges::kAll) {
    EXPECT_LT(range.min, range.max) << range.quantity;
    EXPECT_TRUE(range.contains(range.min)) << range.quantity;
    EXPECT_TRUE(range.contains(range.max)) << range.quantity;
    for (const double outside :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity(),
          std::nextafter(range.max, std::numeric_limits<double>::infinity())}) {
      EXPECT_FALSE(range.contains(outside)) << range.quantity << ' ' << outside;
    }
    EXPECT_STRNE(range.unit, "") << range.quantity;
    EXPECT_STRNE(range.reason, "") << range.quantity;
  }
}

TEST(InputRange, ReportsTheFaultAndThePermittedRange) {
  EXPECT_FALSE(check_range(ranges::kMass, 3.0).has_value());
  const std::optional<Error> error = check_range(ranges::kMass, 1e300, "1e300");
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(error->to_string(),
            "1e300 is out of range for a mass; write a number from 1e-06 to 10000 kg");
}

/// The row of the documentation's table for one range.
std::string row_of(const InputRange& range) {
  std::ostringstream row;
  row << "| " << range.quantity << " | " << range.min << " to " << range.max << " | " << range.unit
      << " | " << range.reason << " |\n";
  return row.str();
}

TEST(InputRange, IsListedInTheDocumentation) {
  const std::string page = read_file(source_folder() / "docs/files.md").value();
  for (const InputRange& range : ranges::kAll) {
    EXPECT_NE(page.find(row_of(range)), page.npos) << "add to docs/files.md: " << row_of(range);
  }
}

}  // namespace
}  // namespace pcavr
