// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/check.hpp"

#include <cstddef>
#include <cstdint>
#include <string>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

std::string failure_text(double radius, std::size_t count, std::int64_t index,
                         const std::string& name) {
  try {
    PCAVR_REQUIRE(radius > 0.0, radius, count, index, 7, 0.5F, "box", name);
  } catch (const ContractError& error) {
    return error.what();
  }
  return "";
}

TEST(Check, AFailureNamesFunctionConditionAndValues) {
  EXPECT_EQ(failure_text(-0.25, 3, -4, "cup"),
            "failure_text: requires radius > 0.0 -0.25 3 -4 7 0.5 box cup");
}

TEST(Check, AConditionThatHoldsThrowsNothing) { EXPECT_EQ(failure_text(0.25, 3, -4, "cup"), ""); }

TEST(Check, ValuesAreOptional) {
  EXPECT_THROW(PCAVR_REQUIRE(1 + 1 == 3), ContractError);
  EXPECT_NO_THROW(PCAVR_REQUIRE(1 + 1 == 2));
}

}  // namespace
}  // namespace pcavr
