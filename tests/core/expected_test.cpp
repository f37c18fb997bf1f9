// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/expected.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

TEST(Error, IsOneLineWithoutItsEmptyParts) {
  const Error full{.message = "is 0", .file = "a.yaml", .line = 7, .place = "size", .hint = "fix"};
  EXPECT_EQ(full.to_string(), "a.yaml:7: size: is 0; fix");
  EXPECT_EQ(Error{.message = "is 0"}.to_string(), "is 0");
  EXPECT_EQ((Error{.message = "is 0", .place = "size"}.to_string()), "size: is 0");
  EXPECT_EQ(Error{.message = "two\nlines"}.to_string(), "two lines");
}

TEST(Error, IsPrintableAndShortWhateverItQuotes) {
  const Error hostile{.message = "'\x1b[2J\x07\xc2\x9b\xe2\x80\xae\x7f\xff' is no number"};
  EXPECT_EQ(hostile.to_string(), "'\\x1b[2J\\x07\\x9b\\u202e\\x7f\\xff' is no number");
  EXPECT_EQ((Error{.message = std::string("a\0b", 3)}.to_string()), "a\\x00b");
  const Error long_one{.message = "'" + std::string(40'000'000, 'x') + "' is no number",
                       .file = "Würfel.yaml"};
  EXPECT_LT(long_one.to_string().size(), 2000U);
  EXPECT_TRUE(long_one.to_string().starts_with("Würfel.yaml: 'xxx"));
  EXPECT_TRUE(long_one.to_string().ends_with("xxx' is no number"));
}

TEST(Expected, HoldsAValueOrAnError) {
  const Expected<int> value = 3;
  const Expected<int> error = Error{.message = "none"};
  EXPECT_EQ(*value, 3);
  EXPECT_FALSE(error);
  EXPECT_EQ(error.error().message, "none");
}

TEST(Expected, ThrowsOnAccessToWhatItDoesNotHold) {
  const Expected<int> value = 3;
  const Expected<int> error = Error{.message = "none"};
  EXPECT_THROW((void)value.error(), ContractError);
  EXPECT_THROW((void)error.value(), ContractError);
  EXPECT_THROW((void)Expected<void>().error(), ContractError);
}

TEST(Expected, MovesItsValueOut) {
  Expected<std::unique_ptr<int>> value = std::make_unique<int>(3);
  const std::unique_ptr<int> moved = *std::move(value);  // would not compile as a copy
  EXPECT_EQ(*moved, 3);
}

TEST(Require, NamesTheConditionAndTheValues) {
  try {
    PCAVR_REQUIRE(1 > 2, "seen", 42);
    FAIL();
  } catch (const ContractError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("1 > 2"), text.npos);
    EXPECT_NE(text.find("seen 42"), text.npos);
  }
}

}  // namespace
}  // namespace pcavr
