// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/scene/support_plane.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "scene/scene_builder.hpp"

namespace pcavr {
namespace {

const TriangleMesh& unit_box() {
  static const TriangleMesh kBox = a_box({0.1F, 0.2F, 0.08F});
  return kBox;
}

SupportedBody a_body(const std::string& name, const Eigen::Vector3d& foot) {
  return {name, &unit_box(), Pose::from_translation(foot + Eigen::Vector3d(0, 0, 0.04))};
}

/// Vertices with vertical noise of standard deviation `std_z` [m].
TriangleMesh noisy(TriangleMesh mesh, double std_z) {
  Random random(3);
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex.z() += static_cast<float>(std_z * random.normal());
  }
  return mesh;
}

TEST(SupportPlane, LiesUnderTheBodyWithinTheNoise) {
  const double std_z = 0.001;
  const auto planes = find_support_planes(noisy(a_level_square({0.5, 0, 0.7}, 1.0, 100), std_z),
                                          {a_body("box", {0.5, 0.1, 0.7})});
  ASSERT_EQ(planes.size(), 1U);
  // Ten thousand points: the std of the mean is a hundredth; 4 standard deviations.
  EXPECT_NEAR(planes[0].plane_base.signed_distance({0.5, 0.0, 0.7}), 0.0, 4e-2 * std_z);
  EXPECT_GT(planes[0].plane_base.normal.z(), 0.99999);
  EXPECT_NEAR(planes[0].rms, std_z, 0.1 * std_z);
  EXPECT_EQ(planes[0].objects, std::vector<std::string>{"box"});
}

TEST(SupportPlane, HasTheTablesCornersCounterClockwiseAsOutline) {
  const auto planes = find_support_planes(a_level_square({0.5, 0, 0.7}, 1.0, 100),
                                          {a_body("box", {0.5, 0.1, 0.7})});
  ASSERT_EQ(planes.size(), 1U);
  const auto& outline = planes[0].outline_base;
  ASSERT_EQ(outline.size(), 4U);
  double area = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    area += 0.5 * outline[i].cross(outline[(i + 1) % 4]).z();
    EXPECT_NEAR(outline[i].z(), 0.7, 1e-6);
  }
  EXPECT_NEAR(area, 1.0, 1e-5);
}

TEST(SupportPlane, IsSharedByBodiesOnOneTable) {
  const TriangleMesh mesh =
      joined(a_level_square({0.5, 0, 0.7}, 0.8, 80), a_level_square({2.0, 0, 0.3}, 0.8, 80));
  const auto planes = find_support_planes(
      mesh,
      {a_body("a", {0.4, 0.1, 0.7}), a_body("b", {2.0, 0.0, 0.3}), a_body("c", {0.6, -0.2, 0.7})});
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_EQ(planes[0].objects, (std::vector<std::string>{"a", "c"}));
  EXPECT_EQ(planes[1].objects, (std::vector<std::string>{"b"}));
  EXPECT_NEAR(planes[1].plane_base.offset, 0.3, 1e-6);
}

TEST(SupportPlane, EndsAtTheSurfacesBoundary) {
  // A second table at the same height, half a metre away, is not part of the plane.
  const TriangleMesh mesh =
      joined(a_level_square({0.5, 0, 0.7}, 0.8, 80), a_level_square({2.0, 0, 0.7}, 0.8, 80));
  const auto planes = find_support_planes(mesh, {a_body("a", {0.4, 0.1, 0.7})});
  ASSERT_EQ(planes.size(), 1U);
  for (const Eigen::Vector3d& corner : planes[0].outline_base) EXPECT_LT(corner.x(), 0.95);
}

TEST(SupportPlane, AcceptsASlightSlopeAndRejectsASteepOne) {
  const auto tilted = [](double degrees) {
    const Pose tilt(
        Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitX())),
        Eigen::Vector3d::Zero());
    const TriangleMesh table = transformed(tilt, a_level_square({0, 0, 0}, 1.0, 100));
    const SupportedBody body{"box", &unit_box(), tilt * Pose::from_translation({0.0, 0.0, 0.04})};
    return find_support_planes(table, {body});
  };
  const auto slight = tilted(5.0);
  ASSERT_EQ(slight.size(), 1U);
  EXPECT_NEAR(std::acos(slight[0].plane_base.normal.z()) * 180.0 / M_PI, 5.0, 0.01);
  EXPECT_TRUE(tilted(25.0).empty());
}

TEST(SupportPlane, IsNotFoundWithoutASurfaceBelow) {
  const TriangleMesh table = a_level_square({0.5, 0, 0.7}, 1.0, 100);
  EXPECT_TRUE(find_support_planes(table, {a_body("flying", {0.5, 0.1, 1.2})}).empty());
  EXPECT_TRUE(find_support_planes(table, {a_body("distant", {3.5, 0.1, 0.7})}).empty());
  EXPECT_TRUE(find_support_planes(TriangleMesh(), {a_body("box", {0, 0, 0})}).empty());
}

TEST(SupportPlane, IsTheLargestHorizontalPlaneWithoutBodies) {
  const TriangleMesh mesh =
      joined(a_level_square({0.5, 0, 0.7}, 0.5, 50), a_level_square({0.0, 0, 0.0}, 2.0, 200));
  const auto planes = find_support_planes(mesh, {});
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].plane_base.offset, 0.0, 1e-6);
  EXPECT_TRUE(planes[0].objects.empty());
  EXPECT_TRUE(find_support_planes(TriangleMesh(), {}).empty());
}

}  // namespace
}  // namespace pcavr
