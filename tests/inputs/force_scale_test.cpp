// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/force_scale.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

WeighedObject object(const char* name, double weighed, double mass, double std) {
  return {name, weighed, {.value = mass, .std = std, .is_excited = true}};
}

TEST(ForceScale, IsSoundWithinTheMassesStds) {
  const ScaleFindings found = check_force_scale(
      std::vector{object("box_1", 3.0, 3.15, 0.06), object("box_2", 3.5, 3.6, 0.1)});
  EXPECT_FALSE(found.fault.has_value());
  EXPECT_TRUE(found.warnings.empty());
}

TEST(ForceScale, IsAFaultWhereAllMassesAreOffByOneFactor) {
  const ScaleFindings found = check_force_scale(
      std::vector{object("box_1", 3.0, 6.34, 0.21), object("box_2", 3.5, 6.93, 0.25)});
  ASSERT_TRUE(found.fault.has_value());
  const std::string message = found.fault->error.to_string();
  EXPECT_NE(message.find("wrench.csv: the force is 2.05 +- 0.0"), std::string::npos) << message;
  EXPECT_NE(message.find("box_1 has a mass of 6.34 +- 0.21 kg"), std::string::npos) << message;
  EXPECT_TRUE(found.fault->is_of_force_only());
}

TEST(ForceScale, IsNotBlamedForOneMassThatDiffers) {
  const ScaleFindings found = check_force_scale(
      std::vector{object("box_1", 3.0, 6.34, 0.21), object("box_2", 3.5, 3.55, 0.25)});
  EXPECT_FALSE(found.fault.has_value());
  ASSERT_EQ(found.warnings.size(), 1U);
  EXPECT_NE(found.warnings[0].find("box_1"), std::string::npos);
  EXPECT_NE(found.warnings[0].find("by a factor of 2.11"), std::string::npos) << found.warnings[0];
}

TEST(ForceScale, OfOneObjectIsAWarning) {
  EXPECT_EQ(check_force_scale(std::vector{object("body", 1.25, 1.0, 0.02)}).warnings.size(), 1U);
  EXPECT_EQ(check_force_scale(std::vector{object("body", 1.25, 1.5, 0.03)}).warnings.size(), 1U);
}

TEST(ForceScale, NeedsAMassByAccelerations) {
  WeighedObject unknown = object("body", 3.0, 6.0, 0.1);
  unknown.mass.is_excited = false;
  const ScaleFindings found = check_force_scale(std::vector{unknown});
  EXPECT_TRUE(found.warnings.empty());
  ASSERT_EQ(found.notes.size(), 1U);
  EXPECT_NE(found.notes[0].find("scale is not compared"), std::string::npos) << found.notes[0];
  EXPECT_FALSE(doubt_of_scale(unknown).has_value());
  EXPECT_TRUE(check_force_scale(std::vector{object("body", 1.25, 1.26, 0.02)}).notes.empty());
}

TEST(ForceScale, IsDoubtedByWhatIsNoChance) {
  EXPECT_FALSE(doubt_of_scale(object("body", 1.25, 1.28, 0.02)).has_value());
  const auto partly = doubt_of_scale(object("body", 1.25, 1.32, 0.02));
  ASSERT_TRUE(partly.has_value());
  EXPECT_NEAR(partly->factor, 1.056, 1e-9);
  EXPECT_GT(partly->doubted_factor, 1.01);
  EXPECT_LT(partly->doubted_factor, 1.05);
  const auto all = doubt_of_scale(object("body", 1.25, 1.0, 0.02));
  ASSERT_TRUE(all.has_value());
  EXPECT_NEAR(all->doubted_factor, 0.8, 1e-9);
}

}  // namespace
}  // namespace pcavr
