// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kTop = 0.05;  // [m] of the box, and the radius of the cylinder that it is
constexpr double kTissueStiffness = 500.0;  // [N/m]

/// A tip travels over an object that is a cylinder where its CAD model is flat, its normal tilted
/// by 20 degrees to either side, and presses it along z at 2 Hz.
IdentificationInput travel_over_cylinder() {
  IdentificationInput input;
  input.tool_radius = 0.003;
  input.objects.push_back(
      {.name = "tissue",
       .model = make_cad_model(test::box_mesh(Eigen::Vector3f::Constant(0.1F)), "tissue", "tissue")
                    .value(),
       .T_base_object = Pose(),
       .is_movable = false});
  const double reach = kTop * std::sin(20.0 * std::numbers::pi / 180.0);
  Random random(13);
  const auto noise = [&](double std) {
    return Eigen::Vector3d(std * random.normal(), std * random.normal(), std * random.normal());
  };
  for (int i = 0; i < 2640; ++i) {
    const double t = i / 66.0;
    const bool is_near = t > 2.0 && t < 38.0;
    const double depth = is_near ? 0.003 + 0.001 * std::sin(4.0 * std::numbers::pi * t) : -0.005;
    const double x = reach * std::sin(0.125 * std::numbers::pi * (t - 2.0));
    const Eigen::Vector3d p(x, 0.0, std::sqrt(kTop * kTop - x * x) - depth);
    const double penetration = std::max(0.0, kTop - p.norm());
    input.t_tool.push_back(t);
    input.t_force.push_back(t);
    input.p_base_tip.emplace_back(p + Eigen::Vector3d(0.0, 0.0, input.tool_radius) + noise(1e-5));
    input.force_base.emplace_back(-kTissueStiffness * penetration * p.normalized() + noise(0.01));
  }
  return input;
}

TEST(TravellingTip, GivesTheStiffnessAlongTheNormalThatChangesUnderIt) {
  const auto found = identify(travel_over_cylinder(), IdentificationGoal::contact);
  ASSERT_TRUE(found.has_value()) << found.error().to_string();
  const ObjectParameters& parameters = found->objects[0].parameters;
  ASSERT_TRUE(parameters.contact_stiffness.has_value());
  EXPECT_NEAR(parameters.contact_stiffness->value, kTissueStiffness, 0.03 * kTissueStiffness);
  EXPECT_LT(parameters.contact_stiffness->std, 0.1 * kTissueStiffness);
}

}  // namespace
}  // namespace pcavr
