// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/base/model/triangle.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

using model::closest_point;
using model::Triangle;
using test::box_mesh;
using test::sphere_mesh;
using test::triangle_soup;

constexpr float kFar = 100.0F;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Eigen::Vector3f random_point(Random& random, double low, double high) {
  return Eigen::Vector3d(random.uniform(low, high), random.uniform(low, high),
                         random.uniform(low, high))
      .cast<float>();
}

Triangle corners(const TriangleMesh& mesh, std::size_t i) {
  const auto& [a, b, c] = mesh.triangles[i];
  return {mesh.vertices[a].cast<double>(), mesh.vertices[b].cast<double>(),
          mesh.vertices[c].cast<double>()};
}

double nearest_by_brute_force(const TriangleMesh& mesh, const Eigen::Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    nearest = std::min(nearest, (closest_point(corners(mesh, i), point) - point).norm());
  }
  return nearest;
}

// The minimum over a fine grid of barycentric weights bounds the true one from above.
TEST(ClosestPointOnTriangle, IsNearerThanAnySampleOfTheTriangle) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Triangle triangle{random_point(random, -1, 1).cast<double>(),
                            random_point(random, -1, 1).cast<double>(),
                            random_point(random, -1, 1).cast<double>()};
    const Eigen::Vector3d point = random_point(random, -2, 2).cast<double>();
    const Eigen::Vector3d nearest = closest_point(triangle, point);
    const double distance = (nearest - point).norm();
    double sampled = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 60; ++i) {
      for (int j = 0; i + j <= 60; ++j) {
        const Eigen::Vector3d sample =
            (i * triangle.a + j * triangle.b + (60 - i - j) * triangle.c) / 60.0;
        sampled = std::min(sampled, (sample - point).norm());
      }
    }
    EXPECT_LE(distance, sampled + 1e-12);
    // Neighbouring samples are at most 1/60 of an edge (here < 3.5 m) apart.
    EXPECT_GE(distance, sampled - 3.5 / 60.0);
  }
}

TEST(ClosestPointOnTriangle, TreatsADegenerateTriangleAsItsEdges) {
  const Triangle needle{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_NEAR((closest_point(needle, {1.5, 1.0, 0.0}) - Eigen::Vector3d(1.5, 0, 0)).norm(), 0.0,
              1e-15);
  const Triangle dot{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  EXPECT_EQ(closest_point(dot, {5, 5, 5}), Eigen::Vector3d(1, 1, 1));
}

TEST(SurfaceQuery, FindsTheSameDistanceAsBruteForce) {
  Random random(2);
  const TriangleMesh mesh = triangle_soup(300, random);
  const SurfaceQuery surface(mesh);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector3f point = random_point(random, -0.5, 1.5);
    const auto closest = surface.closest(point, kFar);
    ASSERT_TRUE(closest);
    const double expected = nearest_by_brute_force(mesh, point.cast<double>());
    EXPECT_NEAR(closest->distance, expected, 1e-6 * expected);  // float rounding
    EXPECT_NEAR((closest->point - point).norm(), closest->distance, 1e-6);
  }
}

TEST(SurfaceQuery, FindsTheFirstTriangleHitByARay) {
  Random random(3);
  const TriangleMesh mesh = triangle_soup(300, random);
  const SurfaceQuery surface(mesh);
  int hits = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Vector3f origin = random_point(random, -0.5, 1.5);
    const Eigen::Vector3f direction = random_point(random, -1, 1);
    const auto hit = surface.cast(origin, direction);
    // Moeller and Trumbore's solution in double, for each triangle.
    double nearest = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d unit = direction.cast<double>().normalized();
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = corners(mesh, i);
      Eigen::Matrix3d system;
      system << t.b - t.a, t.c - t.a, -unit;
      const Eigen::Vector3d uvt = system.inverse() * (origin.cast<double>() - t.a);
      const bool is_inside = uvt[0] >= 0 && uvt[1] >= 0 && uvt[0] + uvt[1] <= 1 && uvt[2] >= 0;
      if (is_inside) nearest = std::min(nearest, uvt[2]);
    }
    ASSERT_EQ(hit.has_value(), std::isfinite(nearest));
    if (!hit) continue;
    ++hits;
    EXPECT_NEAR(hit->distance, nearest, 1e-5);  // float rounding, steep triangles included
    const Triangle t = corners(mesh, hit->triangle);
    const Eigen::Vector3d point = t.a + hit->u * (t.b - t.a) + hit->v * (t.c - t.a);
    const Eigen::Vector3d on_ray = origin.cast<double>() + nearest * unit;
    EXPECT_LT((point - on_ray).norm(), 1e-4);
  }
  EXPECT_GT(hits, 100);
}

TEST(SurfaceQuery, IsExactForABox) {
  const SurfaceQuery surface(box_mesh({0.2F, 0.4F, 0.6F}));
  const auto above = surface.closest({0.05F, 0.1F, 0.5F}, kFar);
  ASSERT_TRUE(above);
  EXPECT_NEAR(above->distance, 0.2F, 1e-7F);
  EXPECT_NEAR((above->normal - Eigen::Vector3f::UnitZ()).norm(), 0.0F, 1e-7F);
  // The nearest face is found from inside, too; its normal still points outward.
  const auto inside = surface.closest({0.08F, 0.0F, 0.0F}, kFar);
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->distance, 0.02F, 1e-7F);
  EXPECT_NEAR((inside->normal - Eigen::Vector3f::UnitX()).norm(), 0.0F, 1e-7F);
  const auto hit = surface.cast({0.0F, 2.2F, 0.1F}, {0.0F, -7.0F, 0.0F});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance, 2.0F, 1e-6F);
  EXPECT_NEAR((hit->normal - Eigen::Vector3f::UnitY()).norm(), 0.0F, 1e-7F);
}

TEST(SurfaceQuery, LiesWithinTheSagOfASphere) {
  const int rings = 60;
  const float radius = 0.1F;
  const SurfaceQuery surface(sphere_mesh(radius, rings));
  // A chord over pi / rings lies r (1 - cos(pi / (2 rings))) inside; diagonals a little more.
  const double sag = 2.0 * radius * (1.0 - std::cos(std::numbers::pi / rings));
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3f point = random_point(random, -0.5, 0.5);
    const auto closest = surface.closest(point, kFar);
    ASSERT_TRUE(closest);
    EXPECT_NEAR(closest->distance, std::abs(point.norm() - radius), sag);
  }
}

TEST(SurfaceQuery, FindsNothingBeyondTheRadius) {
  const SurfaceQuery surface(box_mesh({1, 1, 1}));
  EXPECT_FALSE(surface.closest({0, 0, 1}, 0.4999F));
  EXPECT_TRUE(surface.closest({0, 0, 1}, 0.5F));
  EXPECT_TRUE(surface.closest({0, 0, 0.5F}, 0.0F));
  EXPECT_FALSE(surface.cast({0, 0, 1}, {0, 0, 1}));
}

TEST(SurfaceQuery, FindsNothingForNonFiniteInput) {
  const SurfaceQuery surface(box_mesh({1, 1, 1}));
  EXPECT_FALSE(surface.closest({kNaN, 0, 0}, kFar));
  EXPECT_FALSE(surface.cast({0, 0, 3}, {0, kNaN, -1}));
  EXPECT_FALSE(surface.cast({0, 0, 3}, {0, 0, 0}));
  EXPECT_FALSE(surface.cast({kNaN, 0, 3}, {0, 0, -1}));
}

TEST(SurfaceQuery, FindsNothingInAnEmptyMesh) {
  const SurfaceQuery surface(TriangleMesh{});
  EXPECT_FALSE(surface.closest({0, 0, 0}, kFar));
  EXPECT_FALSE(surface.cast({0, 0, 0}, {0, 0, 1}));
  EXPECT_TRUE(surface.bounds().isEmpty());
}

TEST(SurfaceQuery, RejectsInvalidMeshes) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.vertices[2].y() = kNaN;
  EXPECT_THROW(SurfaceQuery{mesh}, ContractError);
  mesh = box_mesh({1, 1, 1});
  mesh.triangles[3][1] = 8;
  EXPECT_THROW(SurfaceQuery{mesh}, ContractError);
}

TEST(SurfaceQuery, ReturnsTheFirstOfEquallyNearTriangles) {
  TriangleMesh mesh = box_mesh({1, 1, 1});
  const std::vector<std::array<std::uint32_t, 3>> once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
  const SurfaceQuery surface(mesh);
  Random random(5);
  for (int trial = 0; trial < 100; ++trial) {
    const auto closest = surface.closest(random_point(random, -1, 1), kFar);
    ASSERT_TRUE(closest);
    EXPECT_LT(closest->triangle, once.size());
  }
}

TEST(SurfaceQuery, GivesTheSameResultsFromSeveralThreads) {
  Random random(6);
  const SurfaceQuery surface(triangle_soup(500, random));
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2000; ++i) points.push_back(random_point(random, -0.2, 1.2));
  const auto query_all = [&](std::vector<float>& distances) {
    for (const Eigen::Vector3f& p : points) distances.push_back(surface.closest(p, kFar)->distance);
  };
  std::vector<float> sequential;
  query_all(sequential);
  std::vector<std::vector<float>> parallel(4);
  std::vector<std::thread> threads;
  for (auto& distances : parallel) threads.emplace_back([&] { query_all(distances); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& distances : parallel) EXPECT_EQ(distances, sequential);
}

TEST(SurfaceQuery, RemainsValidWhenMoved) {
  SurfaceQuery first(box_mesh({1, 1, 1}));
  SurfaceQuery second(std::move(first));
  first = SurfaceQuery(sphere_mesh(1.0F, 8));
  EXPECT_TRUE(second.closest({0, 0, 0.6F}, 0.11F));
  EXPECT_TRUE(first.closest({0, 0, 1.0F}, 0.01F));
}

}  // namespace
}  // namespace pcavr
