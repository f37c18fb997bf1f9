// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/surface_errors.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "shapes.hpp"

namespace pcavr {
namespace {

/// Float coordinates of about a metre.
constexpr double kFloatRounding = 1e-6;
SurfaceErrorOptions make_options() {
  SurfaceErrorOptions options;
  options.sample_spacing = 0.01;
  return options;
}
const SurfaceErrorOptions kOptions = make_options();

/// Looks straight down from `height` above the origin; sees 1.28 m x 0.96 m from 1 m.
Views a_view_from_above(double height) {
  Views views;
  views.camera = {.width = 128, .height = 96, .fx = 100, .fy = 100, .cx = 63.5, .cy = 47.5};
  const Eigen::Quaterniond down(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  views.T_base_camera = {Pose(down, {0, 0, height})};
  return views;
}

MeshErrors compare(const TriangleMesh& truth, const TriangleMesh& mesh,
                   const std::optional<Views>& views = std::nullopt) {
  return mesh_errors(truth, mesh, views, kOptions, Parallelism{2});
}

TEST(MeshErrors, OfAMeshAgainstItselfAreZero) {
  const TriangleMesh box = a_box({1, 1, 1});
  const MeshErrors errors = compare(box, box);
  EXPECT_LT(errors.accuracy.max, kFloatRounding);
  EXPECT_EQ(errors.completeness_5mm, 1.0);
  EXPECT_EQ(errors.share_not_explained, 0.0);
}

TEST(MeshErrors, OfAPlaneShiftedByTwoMillimetresAreTwoMillimetres) {
  const MeshErrors errors = compare(a_plane(-1, 1, -1, 1, 0.0F), a_plane(-1, 1, -1, 1, 0.002F));
  EXPECT_NEAR(errors.accuracy.mean, 0.002, kFloatRounding);
  EXPECT_NEAR(errors.accuracy.max, 0.002, kFloatRounding);
  EXPECT_NEAR(static_cast<double>(errors.accuracy.count), 40000.0, 1.0);  // 4 m^2 / 1 cm^2
  EXPECT_EQ(errors.completeness_5mm, 1.0);
}

TEST(MeshErrors, OfHalfAPlaneAreExactButOnlyHalfComplete) {
  const MeshErrors errors = compare(a_plane(-1, 1, -1, 1, 0.0F), a_plane(-1, 0, -1, 1, 0.0F));
  EXPECT_LT(errors.accuracy.max, kFloatRounding);
  // The half, and a strip of 5 or 10 mm next to it; one sample in 40 000 and their spread.
  EXPECT_NEAR(errors.completeness_5mm, 0.5 + 0.0025, 0.001);
  EXPECT_NEAR(errors.completeness_10mm, 0.5 + 0.005, 0.001);
}

TEST(MeshErrors, IncludeTheShareThatTheTruthDoesNotExplain) {
  const TriangleMesh truth = a_plane(-1, 1, -1, 1, 0.0F);
  const TriangleMesh mesh = merged(truth, a_plane(0, 1, 0, 1, 0.5F));
  EXPECT_NEAR(compare(truth, mesh).share_not_explained, 0.2, 0.001);
}

TEST(MeshErrors, OfAnEmptyMeshHaveNoSamplesAndNoCompleteness) {
  const MeshErrors errors = compare(a_plane(0, 1, 0, 1, 0), TriangleMesh());
  EXPECT_EQ(errors.accuracy.count, 0U);
  EXPECT_EQ(errors.completeness_10mm, 0.0);
}

TEST(MeshErrors, RejectATruthWithoutSurface) {
  EXPECT_THROW((void)compare(TriangleMesh(), a_plane(0, 1, 0, 1, 0)), ContractError);
}

TEST(MeshErrors, CountOnlySamplesInTheImage) {
  const TriangleMesh truth = a_plane(-2, 2, -2, 2, 0.0F);
  // The view covers 1.28 m x 0.96 m, and the mesh is exactly that: complete.
  const TriangleMesh mesh = a_plane(-0.64F, 0.64F, -0.48F, 0.48F, 0.0F);
  const MeshErrors errors = compare(truth, mesh, a_view_from_above(1.0));
  EXPECT_EQ(errors.completeness_5mm, 1.0);
  EXPECT_NEAR(static_cast<double>(errors.seen_truth_to_mesh.size()), 12288.0, 200.0);
  EXPECT_LT(compare(truth, mesh).completeness_5mm, 0.1);
}

TEST(MeshErrors, ExcludePointsThatTheDistortionModelFoldsIntoTheImage) {
  // r (1 - 0.1 r^2) is zero again at r = 3.16: a point there would lie in the middle of the image.
  Views views = a_view_from_above(1.0);
  views.camera.distortion = {-0.1, 0, 0, 0, 0};
  const TriangleMesh near = a_plane(-0.9F, 0.9F, -0.9F, 0.9F, 0.0F);
  const TriangleMesh wide = a_plane(-3.6F, 3.6F, -3.6F, 3.6F, 0.0F);
  const auto seen = [&](const TriangleMesh& truth) {
    return static_cast<double>(compare(truth, near, views).seen_truth_to_mesh.size());
  };
  EXPECT_NEAR(seen(wide), seen(near), 50.0);  // of 13 000: samples on the image's edge
  EXPECT_GT(seen(near), 12288.0);             // a barrel lens sees more than a pinhole
}

TEST(MeshErrors, ExcludeSurfaceOccludedByTheTruth) {
  const TriangleMesh table = a_plane(-0.4F, 0.4F, -0.4F, 0.4F, 0.2F);
  const TriangleMesh floor = a_plane(-0.4F, 0.4F, -0.4F, 0.4F, 0.0F);
  const MeshErrors errors = compare(merged(table, floor), table, a_view_from_above(1.2));
  EXPECT_EQ(errors.completeness_5mm, 1.0);
}

TEST(MeshErrors, ExcludeSurfaceOccludedByABodyUntilItMovesAway) {
  const TriangleMesh floor = a_plane(-0.2F, 0.2F, -0.2F, 0.2F, 0.0F);
  Views views = a_view_from_above(1.0);
  views.bodies = {{a_box({1, 1, 0.1F}), {Pose::from_translation({0.5, 0, 0.2})}}};
  // The body's edge, seen from 1 m, projects onto 0 m: it occludes half.
  const std::size_t seen_then = compare(floor, floor, views).seen_truth_to_mesh.size();
  EXPECT_NEAR(static_cast<double>(seen_then), 800.0, 30.0);
  views.T_base_camera.push_back(views.T_base_camera[0]);
  views.bodies[0].T_base_object.push_back(Pose::from_translation({5, 0, 0.2}));
  EXPECT_EQ(compare(floor, floor, views).seen_truth_to_mesh.size(), 1600U);
}

TEST(MeshErrors, ExcludeSurfaceOutOfRangeOrAtGrazingIncidence) {
  const TriangleMesh floor = a_plane(-0.3F, 0.3F, -0.3F, 0.3F, 0.0F);
  EXPECT_TRUE(compare(floor, floor, a_view_from_above(0.3)).seen_truth_to_mesh.empty());
  EXPECT_TRUE(compare(floor, floor, a_view_from_above(4.1)).seen_truth_to_mesh.empty());
  EXPECT_TRUE(compare(floor, floor, a_view_from_above(-1.0)).seen_truth_to_mesh.empty());
  // A wall along the line of sight.
  const TriangleMesh wall = transformed(
      Pose(Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX())),
           {0, 0.05, 0.5}),
      floor);
  EXPECT_TRUE(compare(wall, wall, a_view_from_above(2.0)).seen_truth_to_mesh.empty());
}

TEST(MeshErrors, AreTheSameBitsForAnyNumberOfThreads) {
  const TriangleMesh truth = a_box({1, 1, 1});
  const TriangleMesh mesh = a_box({1.01F, 0.99F, 1});
  const std::optional<Views> views = a_view_from_above(2.0);
  const MeshErrors one = mesh_errors(truth, mesh, views, kOptions, Parallelism{1});
  for (const int threads : {2, 4}) {
    const MeshErrors many = mesh_errors(truth, mesh, views, kOptions, Parallelism{threads});
    EXPECT_EQ(one.mesh_to_truth, many.mesh_to_truth);
    EXPECT_EQ(one.seen_truth_to_mesh, many.seen_truth_to_mesh);
    EXPECT_EQ(one.accuracy.mean, many.accuracy.mean);
  }
}

TEST(MeshErrors, DoNotDependOnTheTriangulation) {
  const TriangleMesh truth = a_plane(-1, 1, -1, 1, 0.0F);
  TriangleMesh fine = a_plane(0, 1, -1, 1, 0.004F);  // half of it at 4 mm, two triangles ...
  for (int i = 0; i < 100; ++i) {                    // ... half at 2 mm, in strips
    const float x = -0.01F * static_cast<float>(i);
    fine = merged(fine, a_plane(x - 0.01F, x, -1, 1, 0.002F));
  }
  EXPECT_NEAR(compare(truth, fine).accuracy.mean, 0.003, 1e-5);
}

double left_behind(const TriangleMesh& truth, const TriangleMesh& mesh,
                   const std::vector<MovedBody>& bodies) {
  return share_left_behind(truth, mesh, bodies, kOptions, Parallelism{2});
}

TEST(ShareLeftBehind, IsTheShareOfABodysResidue) {
  const TriangleMesh floor = a_plane(-1, 1, -1, 1, 0.0F);
  const TriangleMesh cube = a_box({0.4F, 0.4F, 0.4F});
  const Pose pose = Pose::from_translation({0.3, 0.1, 0.2});
  // A sheet half-way up in the body, 0.4 m x 0.4 m of 4.16 m^2.
  const TriangleMesh mesh = merged(floor, a_plane(0.1F, 0.5F, -0.1F, 0.3F, 0.2F));
  EXPECT_NEAR(left_behind(floor, mesh, {{cube, {Pose::from_translation({-2, 0, 0}), pose}}}),
              0.16 / 4.16, 0.001);
  EXPECT_EQ(left_behind(floor, mesh, {{cube, {Pose::from_translation({-2, 0, 0})}}}), 0.0);
  EXPECT_EQ(left_behind(floor, mesh, {}), 0.0);
}

TEST(ShareLeftBehind, CountsTheBodysSurfaceWithAMargin) {
  const TriangleMesh floor = a_plane(-1, 1, -1, 1, -0.5F);
  const TriangleMesh cube = a_box({0.4F, 0.4F, 0.4F});
  const TriangleMesh shell = a_box({0.41F, 0.41F, 0.41F});   // 5 mm outside
  const TriangleMesh far_shell = a_box({0.5F, 0.5F, 0.5F});  // 50 mm outside
  EXPECT_EQ(left_behind(floor, shell, {{cube, {Pose()}}}), 1.0);
  EXPECT_EQ(left_behind(floor, far_shell, {{cube, {Pose()}}}), 0.0);
}

TEST(ShareLeftBehind, ExcludesTheTableUnderTheBody) {
  const TriangleMesh table = a_plane(-1, 1, -1, 1, 0.0F);
  const TriangleMesh mesh = a_plane(-1, 1, -1, 1, 0.004F);
  const MovedBody body{a_box({0.4F, 0.4F, 0.4F}), {Pose::from_translation({0, 0, 0.2})}};
  EXPECT_EQ(left_behind(table, mesh, {body}), 0.0);
}

}  // namespace
}  // namespace pcavr
