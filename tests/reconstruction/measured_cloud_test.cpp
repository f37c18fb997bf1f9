// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/measured_cloud.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

namespace pcavr {
namespace {

constexpr CameraModel kCloudCamera{
    .width = 160, .height = 120, .fx = 150.0, .fy = 150.0, .cx = 79.5, .cy = 59.5};
constexpr double kCloudVoxel = 0.02;  // [m]

/// Depth of the plane z = 0 from a camera above it that looks down, tilted by `tilt` [rad].
struct TableView {
  Pose T_base_camera;
  DepthImage depth;
};

TableView view_of_table(double tilt, double noise_std, std::uint64_t seed) {
  // Optical axis down, then tilted about the camera's x axis.
  const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI + tilt, Eigen::Vector3d::UnitX()));
  TableView view{Pose(down, {0.05, -0.1, 1.0}),
                 DepthImage(kCloudCamera.width, kCloudCamera.height)};
  Random random(seed);
  for (int v = 0; v < kCloudCamera.height; ++v) {
    for (int u = 0; u < kCloudCamera.width; ++u) {
      const Eigen::Vector3d ray =
          view.T_base_camera.rotation() * kCloudCamera.unproject({double(u), double(v)}, 1.0);
      const double z = -view.T_base_camera.translation().z() / ray.z();
      view.depth(u, v) = static_cast<float>(z + noise_std * random.normal());
    }
  }
  return view;
}

TEST(MeasuredCloud, AveragesThePointsOfAllFrames) {
  MeasuredCloud measured(kCloudVoxel, {});
  const ColorImage color(kCloudCamera.width, kCloudCamera.height, {200, 100, 50});
  for (int i = 0; i < 20; ++i) {
    const TableView view = view_of_table(0.02 * i, 0.002, static_cast<std::uint64_t>(i + 1));
    measured.add(view.depth, color, {}, kCloudCamera, view.T_base_camera);
  }
  const PointCloud cloud = measured.points(10);
  ASSERT_GT(cloud.points.size(), 1000U);
  ASSERT_EQ(cloud.normals.size(), cloud.points.size());
  double sum = 0.0;
  double min_normal_z = 1.0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    sum += std::pow(static_cast<double>(cloud.points[i].z()), 2);
    min_normal_z = std::min(min_normal_z, static_cast<double>(cloud.normals[i].z()));
    EXPECT_EQ(cloud.colors[i], (Rgb8{200, 100, 50}));
  }
  // The voxels on both sides of z = 0 each hold the points of one sign: the mean of half a normal
  // distribution is 0.8 std, and the frames average around it.
  EXPECT_LT(std::sqrt(sum / static_cast<double>(cloud.points.size())), 0.8 * 0.002 * 1.1);
  EXPECT_GT(min_normal_z, 0.9);
}

TEST(MeasuredCloud, VoxelsOfFewFramesAreLeftOut) {
  MeasuredCloud measured(kCloudVoxel, {});
  const TableView view = view_of_table(0.0, 0.0, 1);
  measured.add(view.depth, {}, {}, kCloudCamera, view.T_base_camera);
  EXPECT_TRUE(measured.points(2).points.empty());
  EXPECT_FALSE(measured.points(1).points.empty());
  EXPECT_TRUE(measured.points(1).colors.empty());
  // All four phases of pixels, twice.
  for (int i = 0; i < 7; ++i) {
    measured.add(view.depth, {}, {}, kCloudCamera, view.T_base_camera);
  }
  EXPECT_EQ(measured.points(2).points.size(), measured.points(1).points.size());
}

TEST(MeasuredCloud, MaskedPixelsAreLeftOut) {
  MeasuredCloud measured(kCloudVoxel, {});
  const TableView view = view_of_table(0.0, 0.0, 1);
  const MaskImage all(kCloudCamera.width, kCloudCamera.height, std::uint8_t{1});
  measured.add(view.depth, {}, all, kCloudCamera, view.T_base_camera);
  EXPECT_EQ(measured.voxel_count(), 0U);
}

TEST(MeasuredCloud, MemoryGrowsWithTheSurfaceNotWithTheFrames) {
  MeasuredCloud measured(kCloudVoxel, {});
  const TableView view = view_of_table(0.3, 0.0, 1);
  measured.add(view.depth, {}, {}, kCloudCamera, view.T_base_camera);
  for (int i = 0; i < 3; ++i) {  // every pixel once
    measured.add(view.depth, {}, {}, kCloudCamera, view.T_base_camera);
  }
  const std::size_t bytes = measured.memory_bytes();
  for (int i = 0; i < 50; ++i) {
    measured.add(view.depth, {}, {}, kCloudCamera, view.T_base_camera);
  }
  EXPECT_EQ(measured.memory_bytes(), bytes);
}

/// The noise's tails fill the neighbouring layers too, which would be two thirds of the points. The
/// few that remain have normals so noisy that the layer is not along them.
TEST(MeasuredCloud, NoiseDoesNotThickenASurface) {
  MeasuredCloud measured(0.01, {});
  for (int i = 0; i < 40; ++i) {
    const TableView view = view_of_table(0.0, 0.004, static_cast<std::uint64_t>(i + 1));
    measured.add(view.depth, {}, {}, kCloudCamera,
                 Pose::from_translation({0.0, 0.0, 0.005}) * view.T_base_camera);
  }
  std::size_t outside = 0;
  for (const Eigen::Vector3f& p : measured.points(1).points) {
    outside += std::abs(p.z() - 0.005F) > 0.005F ? 1U : 0U;
  }
  EXPECT_LT(outside, measured.points(1).points.size() / 10);
}

/// Each side of a depth discontinuity keeps the normal of its own surface.
TEST(MeasuredCloud, NormalsDoNotCrossEdges) {
  DepthImage depth(kCloudCamera.width, kCloudCamera.height, 1.0F);
  for (int v = 0; v < kCloudCamera.height; ++v) {
    for (int u = 80; u < kCloudCamera.width; ++u) depth(u, v) = 1.5F;
  }
  MeasuredCloud measured(kCloudVoxel, {});
  for (int i = 0; i < 4; ++i) measured.add(depth, {}, {}, kCloudCamera, Pose());
  for (const Eigen::Vector3f& normal : measured.points(1).normals) {
    EXPECT_NEAR(normal.z(), -1.0F, 1e-4F);
  }
}

TEST(MeasuredCloud, PointsFarFromTheMeshAreRemoved) {
  const PointCloud cloud{.points = {{0, 0, 0}, {0.005F, 0, 0}, {0.05F, 0, 0}},
                         .normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
                         .colors = {}};
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0.001F}};
  const PointCloud near = points_near(cloud, mesh, 0.01);
  ASSERT_EQ(near.points.size(), 2U);
  EXPECT_EQ(near.normals[1], Eigen::Vector3f(0, 1, 0));
}

TEST(MeasuredCloud, PartsOfACloudHaveThePointsOfTheWhole) {
  const auto row_of_points = [](int first, int last) {
    PointCloud cloud;
    for (int i = first; i < last; ++i) {
      cloud.points.emplace_back(0.004F * static_cast<float>(i), 0.0F, 0.0F);
      cloud.normals.emplace_back(0.0F, 0.0F, i % 2 == 0 ? 1.0F : -1.0F);
      cloud.colors.push_back({static_cast<std::uint8_t>(i), 0, 0});
    }
    return cloud;
  };
  TriangleMesh mesh;
  mesh.vertices = {{0.1F, 0, 0}, {0.2F, 0, 0}};
  const PointCloud whole = points_near(row_of_points(0, 100), mesh, 0.02);
  const PointCloud parts =
      points_near({row_of_points(0, 30), PointCloud(), row_of_points(30, 100)}, mesh, 0.02);
  ASSERT_GT(whole.points.size(), 10U);
  EXPECT_LT(whole.points.size(), 50U);
  EXPECT_EQ(parts.points, whole.points);
  EXPECT_EQ(parts.normals, whole.normals);
  EXPECT_EQ(parts.colors, whole.colors);
}

}  // namespace
}  // namespace pcavr
