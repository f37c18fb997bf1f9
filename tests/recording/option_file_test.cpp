// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/option_file.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/options.hpp"
#include "pcavr/base/geometry/depth_noise.hpp"

namespace pcavr {
namespace {

struct Filter {
  double width = 0.3;
  int passes = 2;
  bool is_robust = true;
};

constexpr auto kFilterFields = std::to_array<OptionField<Filter>>({
    {"width", &Filter::width, 0.3, 0.001, 1.5, "m", "a width", "lower: noisy; higher: blurred"},
    {"passes", &Filter::passes, 2, 1, 8, "", "a count", "lower: noisy; higher: slow"},
    {"is_robust", &Filter::is_robust, 1, 0, 1, "", "a flag", "false: outliers count"},
});

class OptionFile : public testing::Test {
 protected:
  Expected<void> parse(const std::string& text) {
    return parse_options(text, "options.yaml", sections_);
  }
  std::string error_of(const std::string& text) {
    const Expected<void> parsed = parse(text);
    return parsed ? "no error" : parsed.error().to_string();
  }

  Filter filter_;
  DepthNoise noise_;
  std::vector<OptionSection> sections_{make_section("filter", filter_, kFilterFields),
                                       section_of(noise_)};
};

TEST_F(OptionFile, SetsTheKeysThatItNames) {
  ASSERT_TRUE(parse("depth_noise: {max_depth: 1.5}\nfilter:\n  passes: 4\n  is_robust: false\n"));
  EXPECT_EQ(noise_.max_depth, 1.5);
  EXPECT_EQ(noise_.min_depth, DepthNoise().min_depth);
  EXPECT_EQ(filter_.passes, 4);
  EXPECT_FALSE(filter_.is_robust);
  EXPECT_EQ(filter_.width, 0.3);
}

TEST_F(OptionFile, NamesTheNearestSectionAndKey) {
  EXPECT_EQ(error_of("filters:\n  width: 1\n"),
            "options.yaml:1: unknown section 'filters'; the nearest known section is "
            "'filter'");
  EXPECT_EQ(error_of("depth_noise:\n  max_dept: 1\n"),
            "options.yaml:2: depth_noise: unknown key 'max_dept'; the nearest known key is "
            "'max_depth'");
}

TEST_F(OptionFile, RejectsValuesOutOfRangeWithTheirUnit) {
  const std::string hint = "; write a number from 0.001 to 1.5 m";
  const std::string place = "options.yaml:2: filter.width: ";
  EXPECT_EQ(error_of("filter:\n  width: 2\n"), place + "2 is out of range" + hint);
  EXPECT_EQ(error_of("filter:\n  width: nan\n"), place + "'nan' is not a finite number" + hint);
  EXPECT_EQ(error_of("filter:\n  width: .inf\n"), place + "'.inf' is not a finite number" + hint);
  EXPECT_EQ(error_of("filter:\n  width: wide\n"), place + "'wide' is not a finite number" + hint);
  EXPECT_EQ(error_of("filter:\n  passes: 2.5\n"),
            "options.yaml:2: filter.passes: '2.5' is not an integer; write an integer from 1 to 8");
  EXPECT_EQ(error_of("filter:\n  is_robust: 1\n"),
            "options.yaml:2: filter.is_robust: is '1'; write true or false");
  EXPECT_EQ(filter_.width, 0.3);
}

TEST_F(OptionFile, RejectsFieldsThatContradictEachOther) {
  EXPECT_NE(
      error_of("depth_noise: {min_depth: 3, max_depth: 2}\n").find("max_depth is not greater"),
      std::string::npos);
}

TEST_F(OptionFile, RejectsWhatIsNoMapOfSections) {
  for (const std::string text : {"", "7", "[1, 2]", "filter: 3", "filter:", "filter: {width: [1]}",
                                 "filter: {width: 1, width: 1}", "filter: {width: }", "a: b: c"}) {
    EXPECT_NE(error_of(text), "no error") << text;
  }
}

TEST_F(OptionFile, PrintedOptionsAreReadBackExactly) {
  filter_ = {.width = 0.1 + 0.2, .passes = 5, .is_robust = false};
  noise_.grazing = std::nextafter(0.0001, 1.0);
  noise_.offset = -0.25;
  const std::string printed = print_options(sections_);
  const DepthNoise noise = noise_;
  filter_ = {};
  noise_ = {};
  ASSERT_TRUE(parse(printed)) << printed;
  EXPECT_EQ(filter_.width, 0.1 + 0.2);
  EXPECT_EQ(filter_.passes, 5);
  EXPECT_FALSE(filter_.is_robust);
  EXPECT_EQ(noise_.grazing, noise.grazing);
  EXPECT_EQ(noise_.offset, -0.25);
  EXPECT_EQ(print_options(sections_), printed);
}

TEST_F(OptionFile, PrintsMeaningRangeAndEffects) {
  EXPECT_NE(print_options(sections_).find("filter:\n"
                                          "  # a width; a number from 0.001 to 1.5 m, default 0.3\n"
                                          "  # lower: noisy; higher: blurred\n"
                                          "  width: 0.3\n"),
            std::string::npos)
      << print_options(sections_);
}

TEST_F(OptionFile, ListsWhatDiffersFromTheDefaults) {
  EXPECT_TRUE(changed_options(sections_).empty());
  filter_.is_robust = false;
  noise_.max_depth = 2.5;
  const std::vector<std::pair<std::string, std::string>> expected{{"filter.is_robust", "false"},
                                                                  {"depth_noise.max_depth", "2.5"}};
  EXPECT_EQ(changed_options(sections_), expected);
}

TEST(OptionFileOnDisk, ThatIsMissingIsAnError) {
  const Expected<void> read = read_options("/nowhere/options.yaml", {});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().file, "/nowhere/options.yaml");
}

}  // namespace
}  // namespace pcavr
