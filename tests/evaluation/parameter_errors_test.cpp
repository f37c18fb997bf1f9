// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/parameter_errors.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "pcavr/physics/contact/damping.hpp"

namespace pcavr {
namespace {

constexpr double kRounding = 1e-12;

ParameterError find(const std::vector<ParameterError>& errors, const std::string& name) {
  const auto found = std::find_if(errors.begin(), errors.end(),
                                  [&](const ParameterError& error) { return error.name == name; });
  return found == errors.end() ? ParameterError() : *found;
}

ObjectParameters a_true_box() {
  ObjectParameters box;
  box.mass = ParameterValue{3.0};
  box.limiting_static_friction = ParameterValue{8.0};
  box.contact_stiffness = ParameterValue{1000.0};
  box.contact_exponent = ParameterValue{1.5};
  return box;
}

TEST(ParameterErrors, AreRelativeAndInStd) {
  ObjectParameters estimate;
  estimate.mass = ParameterValue{3.3, 0.1};
  const ParameterError mass =
      find(parameter_errors({{"box", a_true_box()}}, {{"box", estimate}}), "mass");
  EXPECT_EQ(mass.unit, "kg");
  EXPECT_EQ(mass.truth, 3.0);
  ASSERT_TRUE(mass.relative.has_value() && mass.error_in_std.has_value());
  EXPECT_NEAR(*mass.relative, 0.1, kRounding);
  EXPECT_NEAR(*mass.error_in_std, 3.0, kRounding);
}

TEST(ParameterErrors, DoNotIncludeThatOfAGivenMass) {
  ObjectParameters estimate;
  estimate.mass = ParameterValue{3.0};
  const ParameterError given =
      find(parameter_errors({{"box", a_true_box()}}, {{"box", estimate}}), "mass");
  EXPECT_TRUE(given.is_given);
  EXPECT_FALSE(given.relative.has_value());
  estimate.mass->std = 0.1;
  const ParameterError identified =
      find(parameter_errors({{"box", a_true_box()}}, {{"box", estimate}}), "mass");
  EXPECT_FALSE(identified.is_given);
  EXPECT_EQ(identified.relative, 0.0);
}

TEST(ParameterErrors, IncludeTheRestitutionOfTheTrueLaw) {
  ObjectParameters truth = a_true_box();
  // This damping is that of a restitution of 0.6 at 0.1 m/s, by the exact relation.
  truth.contact_damping =
      ParameterValue{hunt_crossley_damping(DampingLaw::exact, 1000.0, 0.6, 0.1)};
  ObjectParameters estimate;
  estimate.contact_restitution = ParameterValue{0.63, 0.02};
  estimate.contact_impact_speed = ParameterValue{0.1};
  const ParameterError error =
      find(parameter_errors({{"box", truth}}, {{"box", estimate}}), "contact.restitution");
  ASSERT_TRUE(error.truth.has_value() && error.relative.has_value());
  EXPECT_NEAR(*error.truth, 0.6, 1e-3);
  EXPECT_NEAR(*error.relative, 0.05, 2e-3);
}

TEST(ParameterErrors, IncludeUnknownParameters) {
  const auto errors = parameter_errors({{"box", a_true_box()}}, {{"box", ObjectParameters()}});
  const ParameterError mass = find(errors, "mass");
  EXPECT_FALSE(mass.estimate.has_value());
  EXPECT_EQ(mass.truth, 3.0);
  EXPECT_FALSE(mass.relative.has_value());
  EXPECT_TRUE(find(errors, "viscous_friction").name.empty());  // in neither
}

TEST(ParameterErrors, DoNotCompareStiffnessesOfDifferentExponents) {
  // 220 N/m give 8.8 N at the penetration where the true contact's force is 8 N, (8 / 1000)^(2/3) =
  // 0.04 m.
  ObjectParameters estimate;
  estimate.contact_stiffness = ParameterValue{220.0, 2.0};
  estimate.contact_exponent = ParameterValue{1.0};
  const auto errors = parameter_errors({{"box", a_true_box()}}, {{"box", estimate}});
  EXPECT_FALSE(find(errors, "contact.stiffness").relative.has_value());
  const ParameterError force = find(errors, "contact.force");
  ASSERT_TRUE(force.relative.has_value());
  EXPECT_NEAR(force.estimate->value, 8.8, 1e-9);
  EXPECT_NEAR(*force.relative, 0.1, 1e-9);

  estimate.contact_exponent = ParameterValue{1.5};
  estimate.contact_stiffness = ParameterValue{900.0};
  const auto same = parameter_errors({{"box", a_true_box()}}, {{"box", estimate}});
  EXPECT_NEAR(*find(same, "contact.stiffness").relative, -0.1, kRounding);
}

TEST(ParameterErrors, OfAnObjectMissingInTheTruthAreItsValues) {
  ObjectParameters estimate;
  estimate.mass = ParameterValue{3.3, 0.1};
  const auto errors = parameter_errors({{"box", a_true_box()}}, {{"ball", estimate}});
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].object, "ball");
  EXPECT_EQ(errors[0].estimate->value, 3.3);
  EXPECT_FALSE(errors[0].truth.has_value());
  EXPECT_TRUE(parameter_errors({{"box", a_true_box()}}, {}).empty());
}

TEST(ParameterErrors, HaveNoRelativeErrorOfATrueZero) {
  ObjectParameters truth;
  truth.viscous_friction = ParameterValue{0.0};
  ObjectParameters estimate;
  estimate.viscous_friction = ParameterValue{0.5, 0.25};
  const ParameterError error =
      find(parameter_errors({{"box", truth}}, {{"box", estimate}}), "viscous_friction");
  EXPECT_FALSE(error.relative.has_value());
  EXPECT_EQ(error.error_in_std, 2.0);
}

}  // namespace
}  // namespace pcavr
