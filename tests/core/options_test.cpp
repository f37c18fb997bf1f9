// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <gtest/gtest.h>

namespace pcavr {
namespace {

struct Sample {
  double speed = -1.0;
  int count = -1;
  bool is_fast = false;
};

using Fields = std::array<OptionField<Sample>, 3>;

constexpr Fields kFields = std::to_array<OptionField<Sample>>({
    {"speed", &Sample::speed, 0.5, 0.1, 2.0, "m/s", "a speed", "lower: slow; higher: fast"},
    {"count", &Sample::count, 3, 1, 9, "", "a count", "lower: few; higher: many"},
    {"is_fast", &Sample::is_fast, 1, 0, 1, "", "a flag", "false: slow"},
});
static_assert(are_valid_fields(kFields));

template <typename Change>
constexpr bool is_valid_after(Change change) {
  Fields fields = kFields;
  change(fields);
  return are_valid_fields(fields);
}

// Each of these tables would compile without the check.
static_assert(!is_valid_after([](Fields& fields) { fields[0].default_value = 3.0; }));
static_assert(!is_valid_after([](Fields& fields) { fields[0].min = 2.0; }));
static_assert(!is_valid_after([](Fields& fields) { fields[1].name = "speed"; }));
static_assert(!is_valid_after([](Fields& fields) { fields[1].effects = ""; }));
static_assert(!is_valid_after([](Fields& fields) { fields[2].max = 2.0; }));
static_assert(!is_valid_after([](Fields& fields) {
  fields[0].max = std::numeric_limits<double>::infinity();
}));

TEST(Options, DefaultsComeFromTheTable) {
  Sample sample;
  set_defaults(sample, kFields);
  EXPECT_EQ(sample.speed, 0.5);
  EXPECT_EQ(sample.count, 3);
  EXPECT_TRUE(sample.is_fast);
}

TEST(Options, SectionReadsAndSetsTheObject) {
  Sample sample;
  set_defaults(sample, kFields);
  const OptionSection section = make_section("test.sample", sample, kFields);
  EXPECT_EQ(section.name, "test.sample");
  ASSERT_EQ(section.rows.size(), 3U);
  EXPECT_EQ(section.rows[0].kind, OptionKind::kNumber);
  EXPECT_EQ(section.rows[1].kind, OptionKind::kInteger);
  EXPECT_EQ(section.rows[2].kind, OptionKind::kBool);
  section.rows[0].set(1.25);
  section.rows[1].set(7.0);
  section.rows[2].set(0.0);
  EXPECT_EQ(sample.speed, 1.25);
  EXPECT_EQ(sample.count, 7);
  EXPECT_FALSE(sample.is_fast);
  sample.speed = 1.5;
  EXPECT_EQ(section.rows[0].get(), 1.5);
}

}  // namespace
}  // namespace pcavr
