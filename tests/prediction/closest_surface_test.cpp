// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/prediction/closest_surface.hpp"

#include <array>
#include <numbers>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "prediction/worlds.hpp"

namespace pcavr {
namespace {

using detail::ClosestSurface;

const Eigen::Vector3d kHalf(0.5, 0.25, 0.125);  // exact in single precision

/// Distance to a box about the origin, in closed form [Quilez].
double distance_to_box(const Eigen::Vector3d& p) {
  const Eigen::Vector3d q = p.cwiseAbs() - kHalf;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

ClosestSurface box() {
  TriangleMesh mesh;
  test::add_box(mesh, -kHalf, kHalf);
  return {mesh, Pose()};
}

TEST(ClosestSurface, IsExactForABox) {
  const ClosestSurface surface = box();
  Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d p(random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7),
                            random.uniform(-0.5, 0.5));
    const double expected = distance_to_box(p);
    const auto closest = surface.closest(p, 2.0);
    ASSERT_TRUE(closest);
    ASSERT_NEAR(closest->distance, expected, 1e-14) << p.transpose();
    ASSERT_NEAR(closest->normal.norm(), 1.0, 1e-12);
    // The closest point lies at that distance back along the outward normal.
    ASSERT_NEAR((closest->point + expected * closest->normal - p).norm(), 0.0, 1e-12);
  }
}

TEST(ClosestSurface, InsideKeepsTheFaceThroughWhichThePointCame) {
  const ClosestSurface surface = box();
  const Eigen::Vector3d entry_normal = -Eigen::Vector3d::UnitX();
  // 30 mm behind that face, 10 mm from the next one.
  const Eigen::Vector3d p(-0.47, 0.24, 0.0);
  EXPECT_NEAR(surface.closest(p, 1.0)->distance, -0.01, 1e-12);
  const auto kept = surface.closest(p, 1.0, entry_normal);
  ASSERT_TRUE(kept);
  EXPECT_NEAR(kept->distance, -0.03, 1e-12);
  EXPECT_LT((kept->normal - entry_normal).norm(), 1e-12);
  EXPECT_LT((kept->point - Eigen::Vector3d(-0.5, 0.24, 0.0)).norm(), 1e-12);
  // The nearest face counts for a point outside, and without an entry face.
  EXPECT_NEAR(surface.closest({-0.47, 0.26, 0.0}, 1.0, entry_normal)->distance, 0.01, 1e-12);
  EXPECT_NEAR(surface.closest(p, 1.0, Eigen::Vector3d::Zero())->distance, -0.01, 1e-12);
}

/// A prism of regular hexagons of that radius [m] about the z axis.
TriangleMesh hexagonal_prism(float radius) {
  TriangleMesh mesh;
  for (int i = 0; i < 6; ++i) {
    const float angle = static_cast<float>(i) * std::numbers::pi_v<float> / 3.0F;
    for (const float z : {-0.25F, 0.25F}) {
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t a = 2 * i;
    const std::uint32_t b = 2 * ((i + 1) % 6);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    if (i == 0 || i == 5) continue;
    mesh.triangles.push_back({0, b, a});
    mesh.triangles.push_back({1, a + 1, b + 1});
  }
  return mesh;
}

TEST(ClosestSurface, InsideSlidesAroundAnObtuseEdgeWhereTheFaceEnds) {
  const ClosestSurface surface(hexagonal_prism(0.5F), Pose());
  const double angle = std::numbers::pi / 6.0;  // of the first face's normal
  const Eigen::Vector3d entry_normal(std::cos(angle), std::sin(angle), 0.0);
  const Eigen::Vector3d next_normal(std::cos(angle), -std::sin(angle), 0.0);
  const Eigen::Vector3d along(-entry_normal.y(), entry_normal.x(), 0.0);  // away from the edge
  const Eigen::Vector3d edge(0.5, 0.0, 0.0);
  for (const double beside : {0.01, 0.001, -0.001, -0.01}) {
    // The next face is closer for all of these: half as far where the first one ends.
    const Eigen::Vector3d p = edge + beside * along - 0.05 * entry_normal;
    const auto nearest = surface.closest(p, 1.0);
    EXPECT_LT((nearest->normal - next_normal).norm(), 1e-6) << beside;
    const auto kept = surface.closest(p, 1.0, entry_normal);
    EXPECT_LT((kept->normal - (beside > 0.0 ? entry_normal : next_normal)).norm(), 1e-6) << beside;
    EXPECT_NEAR(kept->distance, beside > 0.0 ? -0.05 : nearest->distance, 1e-6) << beside;
  }
}

// A tip that starts before a face and goes anywhere but around its edge: the face's distance.
TEST(ClosestSurface, DistanceIsThatOfTheEnteredFaceOnAnyPathBehindIt) {
  const ClosestSurface surface = box();
  Random random(9);
  for (int path = 0; path < 200; ++path) {
    Eigen::Vector3d p(-kHalf.x() - 0.01, random.uniform(-0.24, 0.24), random.uniform(-0.12, 0.12));
    Eigen::Vector3d entry_normal = surface.closest(p, 1.0)->normal;
    double before = surface.closest(p, 1.0)->distance;
    int inside = 0;
    for (int step = 0; step < 500; ++step) {
      const Eigen::Vector3d last = p;
      p += 0.002 * Eigen::Vector3d(random.normal() + 0.3, random.normal(), random.normal());
      p = p.cwiseMax(-0.999 * kHalf - Eigen::Vector3d(0.05, 0.0, 0.0)).cwiseMin(0.999 * kHalf);
      const auto closest = surface.closest(p, 1.0, entry_normal);
      ASSERT_TRUE(closest);
      ASSERT_LT((closest->normal + Eigen::Vector3d::UnitX()).norm(), 1e-12) << p.transpose();
      ASSERT_NEAR(closest->distance, -kHalf.x() - p.x(), 1e-12) << p.transpose();
      ASSERT_LE(std::abs(closest->distance - before), (p - last).norm() + 1e-12);
      if (surface.closest(p, 1.0)->normal != closest->normal) ++inside;
      before = closest->distance;
      entry_normal = closest->normal;
    }
    ASSERT_GT(inside, 0);
  }
}

TEST(ClosestSurface, HasOneLocalMinimumOutsideABoxAndThreeInACorner) {
  std::array<ClosestSurface::Result, 4> found;
  const ClosestSurface convex = box();
  Random random(8);
  for (int i = 0; i < 5000; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.7, 0.7), random.uniform(-0.4, 0.4),
                            random.uniform(-0.3, 0.3));
    const double distance = distance_to_box(p);
    if (distance <= 0.0) continue;
    ASSERT_EQ(convex.local_minima(p, distance + 0.2, *convex.closest(p, 2.0), found), 1U)
        << p.transpose();
    ASSERT_NEAR(found[0].distance, distance, 1e-14);
  }
  // A floor and two walls, as in the corner of a hole.
  TriangleMesh mesh;
  test::add_box(mesh, {-1.0, -1.0, -0.5}, {1.0, 1.0, 0.0});
  test::add_box(mesh, {0.25, -1.0, 0.0}, {1.0, 1.0, 0.5});
  test::add_box(mesh, {-1.0, 0.5, 0.0}, {0.25, 1.0, 0.5});
  const ClosestSurface corner(mesh, Pose());
  const Eigen::Vector3d p(0.125, 0.25, 0.0625);
  const ClosestSurface::Result closest = *corner.closest(p, 0.375);
  ASSERT_EQ(corner.local_minima(p, 0.375, closest, found), 3U);
  EXPECT_TRUE(found[0].normal.isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_TRUE(found[1].normal.isApprox(-Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(found[2].normal.isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_EQ(found[2].distance, 0.25);
  EXPECT_EQ(corner.local_minima(p, 0.2, closest, found), 2U);
}

TEST(ClosestSurface, HasAnOutwardNormalEvenOnTheSurface) {
  const ClosestSurface surface = box();
  const auto on_face = surface.closest({0.5, 0.1, 0.05}, 0.1);
  EXPECT_TRUE(on_face->normal.isApprox(Eigen::Vector3d::UnitX()));
  const auto on_corner = surface.closest(kHalf, 0.1);
  EXPECT_GE(on_corner->normal.minCoeff(), 0.0);
  EXPECT_NEAR(on_corner->distance, 0.0, 1e-15);
}

TEST(ClosestSurface, IsEmptyBeyondItsReachButNotInside) {
  const ClosestSurface surface = box();
  EXPECT_FALSE(surface.closest({0.62, 0.0, 0.0}, 0.1));
  EXPECT_TRUE(surface.closest({0.58, 0.0, 0.0}, 0.1));
  EXPECT_FALSE(surface.closest({0.58, 0.33, 0.0}, 0.1));
  EXPECT_NEAR(surface.closest({0.0, 0.0, 0.0}, 0.01)->distance, -0.125, 1e-15);
}

TEST(ClosestSurface, OfManyTrianglesEqualsBruteForce) {
  // A bumpy sphere.
  TriangleMesh mesh;
  constexpr std::uint32_t kRings = 24;
  constexpr std::uint32_t kSides = 40;
  const auto at = [](double ring, double side) {
    const double theta = M_PI * ring / kRings;
    const double phi = 2.0 * M_PI * side / kSides;
    const double r = 0.1 + 0.02 * std::sin(5.0 * phi) * std::sin(theta) * std::sin(4.0 * theta);
    return Eigen::Vector3d(r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi),
                           r * std::cos(theta));
  };
  mesh.vertices.emplace_back(at(0, 0).cast<float>());
  for (std::uint32_t i = 1; i < kRings; ++i) {
    for (std::uint32_t j = 0; j < kSides; ++j) mesh.vertices.emplace_back(at(i, j).cast<float>());
  }
  mesh.vertices.emplace_back(at(kRings, 0).cast<float>());
  const std::uint32_t last = static_cast<std::uint32_t>(mesh.vertices.size()) - 1;
  for (std::uint32_t j = 0; j < kSides; ++j) {
    const std::uint32_t k = (j + 1) % kSides;
    mesh.triangles.push_back({0, 1 + j, 1 + k});
    for (std::uint32_t i = 0; i + 2 < kRings; ++i) {
      const std::uint32_t a = 1 + i * kSides;
      const std::uint32_t b = a + kSides;
      mesh.triangles.push_back({a + j, b + j, b + k});
      mesh.triangles.push_back({a + j, b + k, a + k});
    }
    mesh.triangles.push_back({last - kSides + j, last, last - kSides + k});
  }
  const ClosestSurface surface(mesh, Pose());
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p(random.uniform(-0.15, 0.15), random.uniform(-0.15, 0.15),
                            random.uniform(-0.15, 0.15));
    double min_distance = 1.0;
    double winding = 0.0;  // solid angle over 4 pi [van Oosterom & Strackee 1983]
    for (const auto& t : mesh.triangles) {
      TriangleMesh one;
      for (const std::uint32_t v : t) one.vertices.push_back(mesh.vertices[v]);
      one.triangles.push_back({0, 1, 2});
      min_distance =
          std::min(min_distance, std::abs(ClosestSurface(one, Pose()).closest(p, 1.0)->distance));
      const Eigen::Vector3d a = one.vertices[0].cast<double>() - p;
      const Eigen::Vector3d b = one.vertices[1].cast<double>() - p;
      const Eigen::Vector3d c = one.vertices[2].cast<double>() - p;
      winding +=
          std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                            b.dot(c) * a.norm() + c.dot(a) * b.norm()) /
          (2.0 * M_PI);
    }
    const double expected = winding > 0.5 ? -min_distance : min_distance;
    ASSERT_NEAR(surface.closest(p, 1.0)->distance, expected, 1e-14) << p.transpose();
  }
}

}  // namespace
}  // namespace pcavr
