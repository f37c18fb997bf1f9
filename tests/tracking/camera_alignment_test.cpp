// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/camera_alignment.hpp"

#include <array>

#include <gtest/gtest.h>

#include "camera_scene.hpp"
#include "perception/tracking/camera_surface.hpp"

namespace pcavr::tracking {
namespace {

using camera_scene::a_camera;
using camera_scene::render;
using camera_scene::Scene;
using camera_scene::walk;

DepthImage observe(const Pose& T_base_camera, std::size_t index, double noise) {
  return render(Scene(), a_camera(), T_base_camera, T_base_camera, index, noise).depth;
}

TEST(CellGrid, InverseDepthAndNormalsOfAPlaneAreExact) {
  const CellGrid grid(a_camera());
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, 0.9).normalized();
  DepthImage depth(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector3d ray = a_camera().normalise(Eigen::Vector2d(x, y)).homogeneous();
      depth(x, y) = static_cast<float>(1.2 / normal.dot(ray));
    }
  }
  const Surface surface =
      make_surface(grid, cell_inverse_depth(grid, depth, {}, DepthNoise()), DepthNoise());
  const auto cell = static_cast<std::size_t>(60 * grid.width() + 80);
  // Single precision at a distance of 1 m.
  EXPECT_NEAR(normal.dot(surface.points[cell].cast<double>()), 1.2, 1e-6);
  EXPECT_NEAR(surface.normals[cell].cast<double>().dot(normal), 1.0, 1e-6);
}

TEST(CellGrid, NormalsOfAPlaneSeenThroughAFisheyeAreExact) {
  CameraModel camera = a_camera();
  const std::array<double, 4> k = {-0.0117, 0.0301, -0.0274, 0.0079};
  camera.distortion = LensDistortion(LensModel::fisheye, k);
  const CellGrid grid(camera);
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -0.4, 0.9).normalized();
  DepthImage depth(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector3d ray = camera.normalise(Eigen::Vector2d(x, y)).homogeneous();
      depth(x, y) = static_cast<float>(1.2 / normal.dot(ray));
    }
  }
  const Surface surface =
      make_surface(grid, cell_inverse_depth(grid, depth, {}, DepthNoise()), DepthNoise());
  for (const auto& [x, y] : {std::pair{80, 60}, {20, 20}, {140, 100}}) {
    const auto cell = static_cast<std::size_t>(y * grid.width() + x);
    // The image of a plane is bent by a cell's width over the window of five: 0.1 degrees.
    EXPECT_GT(surface.normals[cell].cast<double>().dot(normal), std::cos(0.002)) << x << ' ' << y;
  }
}

TEST(CellGrid, SkipsCellsWithAHoleADepthStepOrADynamicPixel) {
  const CellGrid grid(a_camera());
  DepthImage depth(320, 240, 1.0F);
  depth(40, 40) = 0.0F;
  depth(81, 40) = 1.5F;
  MaskImage is_dynamic(320, 240);
  is_dynamic(121, 41) = 1;
  const InverseDepth cells = cell_inverse_depth(grid, depth, is_dynamic, DepthNoise());
  const auto cell = [&](int x, int y) {
    return cells[static_cast<std::size_t>(y / grid.pixels * grid.width() + x / grid.pixels)];
  };
  EXPECT_EQ(cell(40, 40), 0.0F);
  EXPECT_EQ(cell(81, 40), 0.0F);
  EXPECT_EQ(cell(121, 41), 0.0F);
  EXPECT_EQ(cell(160, 40), 1.0F);
}

/// Aligns the frame at walk(3.2) to the surface seen from walk(3.0), where two sides of each block
/// are in view: the surface alone determines the pose.
Alignment align_views(const Pose& start_error, double noise, Parallelism parallelism) {
  const CellGrid grid(a_camera());
  const Surface model = make_surface(
      grid, cell_inverse_depth(grid, observe(walk(3.0), 0, noise), {}, DepthNoise()), DepthNoise());
  const InverseDepth frame =
      cell_inverse_depth(grid, observe(walk(3.2), 1, noise), {}, DepthNoise());
  const std::vector<FeatureMatch> no_features;
  AlignmentInput input;
  input.grid = &grid;
  input.model = &model;
  input.frame = &frame;
  input.features = &no_features;
  input.focal_length = a_camera().fx;
  return align(input, walk(3.0).inverse() * walk(3.2) * start_error, parallelism);
}

TEST(Align, FindsThePoseFromTheSurfaceAlone) {
  const Pose start_error =
      Pose::exp((Vector6d() << 0.02, -0.015, 0.01, 0.01, 0.02, -0.015).finished());
  const Alignment alignment = align_views(start_error, 0.5, {1});
  EXPECT_TRUE(alignment.is_valid());
  const Pose truth = walk(3.0).inverse() * walk(3.2);
  // Noise of 1 mm over some thousand cells; the remaining error is from data association at edges.
  EXPECT_LT(translation_distance(alignment.T_model_frame, truth), 0.001);
  EXPECT_LT(rotation_distance(alignment.T_model_frame, truth), 0.001);
}

TEST(Align, IsBitwiseIdenticalForAnyNumberOfThreads) {
  const Pose expected = align_views(Pose(), 0.5, {1}).T_model_frame;
  for (const int threads : {2, 4}) {
    EXPECT_EQ(align_views(Pose(), 0.5, {threads}).T_model_frame.matrix(), expected.matrix());
  }
}

TEST(Align, IsNotValidForABarePlane) {
  const CellGrid grid(a_camera());
  const InverseDepth plane(grid.size(), 1.0F);
  const Surface model = make_surface(grid, plane, DepthNoise());
  const std::vector<FeatureMatch> no_features;
  AlignmentInput input;
  input.grid = &grid;
  input.model = &model;
  input.frame = &plane;
  input.features = &no_features;
  input.focal_length = a_camera().fx;
  // Sliding along the plane is unobservable.
  EXPECT_FALSE(align(input, Pose(), {1}).is_valid());
}

TEST(Align, SkipsPointsNearThePlaneOfTheCameraCentre) {
  // Points at 1 m are moved to 6e-8 m (the resolution of a float there) in front of the plane z = 0
  // and far from the axis: cells 1e12 from the image, which overflow an int.
  CameraModel camera = a_camera();
  const CellGrid grid(camera);
  const InverseDepth plane(grid.size(), 1.0F);
  const Surface model = make_surface(grid, plane, DepthNoise());
  const std::vector<FeatureMatch> no_features;
  AlignmentInput input;
  input.grid = &grid;
  input.model = &model;
  input.frame = &plane;
  input.features = &no_features;
  input.focal_length = camera.fx;
  for (const double lateral : {1e4, 1e20, 1e30}) {
    const Pose start = Pose::from_translation({lateral, 0.5 * lateral, -1.0 + 6e-8});
    EXPECT_FALSE(align(input, start, {1}).is_valid());
  }
}

TEST(Fuse, AveragesTheNoiseOfTheFramesThatMatch) {
  const CellGrid grid(a_camera());
  const DepthNoise noise;
  SurfaceModel model;
  model.inverse_depth = cell_inverse_depth(grid, observe(walk(0.0), 0, 1.0), {}, noise);
  model.weight.assign(grid.size(), 1.0F);
  const InverseDepth truth = cell_inverse_depth(grid, observe(walk(0.0), 0, 0.0), {}, noise);
  const Surface surface = make_surface(grid, model.inverse_depth, noise);
  const auto mean_square = [&] {
    double sum = 0.0;
    int cells = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      if (surface.normals[i].isZero() || truth[i] <= 0.0F) continue;
      const double error = double{model.inverse_depth[i]} - double{truth[i]};
      sum += error * error;
      ++cells;
    }
    return sum / cells;
  };
  const double before = mean_square();
  for (std::size_t i = 1; i < 8; ++i) {
    const double t = 0.02 * static_cast<double>(i);
    fuse(grid, surface, cell_inverse_depth(grid, observe(walk(t), i, 1.0), {}, noise),
         walk(0.0).inverse() * walk(t), noise, model);
  }
  // Eight independent frames reduce the mean square to an eighth; interpolation between cells and
  // cells that left the view lose a part of that.
  EXPECT_LT(mean_square(), before / 4.0);
}

}  // namespace
}  // namespace pcavr::tracking
