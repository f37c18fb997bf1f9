// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/touch.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kHalf = 0.05;    // [m]
constexpr double kRadius = 0.01;  // [m]

class TouchOfABox : public testing::Test {
 protected:
  [[nodiscard]] Touch touch(double x, double y, double z) const {
    return surface_.touch(Pose(), Eigen::Vector3d(x, y, z), kRadius);
  }

 private:
  CadModel model_ = box_model("box", Eigen::Vector3d::Constant(kHalf));
  BodySurface surface_{model_};
};

TEST_F(TouchOfABox, HasTheGapBetweenTheSurfaces) {
  const Touch free = touch(-kHalf - kRadius - 0.002, 0.0, 0.0);
  EXPECT_NEAR(free.gap, 0.002, 1e-7);
  EXPECT_LT((free.inward_base - Eigen::Vector3d::UnitX()).norm(), 1e-5);
  EXPECT_LT((free.normal_object + Eigen::Vector3d::UnitX()).norm(), 1e-5);
}

TEST_F(TouchOfABox, IsNegativeInside) {
  EXPECT_NEAR(touch(-kHalf - kRadius + 0.001, 0.01, 0.0).gap, -0.001, 1e-7);
  const Touch deep = touch(-kHalf + 0.004, 0.0, 0.0);
  EXPECT_NEAR(deep.gap, -kRadius - 0.004, 1e-7);
  EXPECT_LT((deep.inward_base - Eigen::Vector3d::UnitX()).norm(), 1e-5);
}

TEST_F(TouchOfABox, IsBetweenTheNormalsAtAnEdge) {
  const Touch edge = touch(-kHalf - 0.01, -kHalf - 0.01, 0.0);
  EXPECT_NEAR(edge.gap, std::sqrt(2.0) * 0.01 - kRadius, 1e-6);
  EXPECT_LT((edge.inward_base - Eigen::Vector3d(1.0, 1.0, 0.0).normalized()).norm(), 1e-4);
}

TEST_F(TouchOfABox, IsInfiniteFarAway) { EXPECT_TRUE(std::isinf(touch(1.0, 0.0, 0.0).gap)); }

TEST(TouchedBody, IsTheClosestWithinReach) {
  const InputOptions options;
  std::vector<Touch> touches(3);
  EXPECT_FALSE(touched_body(touches, options).has_value());
  EXPECT_FALSE(touched_body({}, options).has_value());
  touches[1].gap = 1.1 * options.max_touch_gap;
  EXPECT_FALSE(touched_body(touches, options).has_value());
  touches[1].gap = 0.9 * options.max_touch_gap;
  ASSERT_TRUE(touched_body(touches, options).has_value());
  EXPECT_EQ(touched_body(touches, options)->body, 1U);
  touches[2].gap = -0.001;
  EXPECT_EQ(touched_body(touches, options)->body, 2U);
  EXPECT_FALSE(touched_body(touches, options)->is_ambiguous);
  touches[0].gap = -0.001 + 0.9 * options.min_gap_difference;
  EXPECT_EQ(touched_body(touches, options)->body, 2U);
  EXPECT_TRUE(touched_body(touches, options)->is_ambiguous);
}

}  // namespace
}  // namespace pcavr
