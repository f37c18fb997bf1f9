// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Volumes fused from random poses, against analytic surfaces.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

/// A camera with half the ray spacing of small_camera, to bound the errors on curved surfaces.
CameraModel fine_camera() {
  CameraModel camera = test::small_camera();
  camera.width *= 2;
  camera.height *= 2;
  camera.fx = camera.fy = 260.0;
  camera.cx = 159.5;
  camera.cy = 119.5;
  return camera;
}
const CameraModel kFineCamera = fine_camera();
constexpr double kMinCosine = 0.65;  ///< of the incidence, of the pixels kept

/// Depth of a sphere (radius > 0) or else the plane z = 0, in base axes, seen from `T_base_camera`;
/// none at larger incidence than that of kMinCosine: in whole squares of 2 x 2 pixels, as the mean
/// of a part of them is not that at their centre. The depth has noise of `std_factor` times the
/// model's.
DepthImage view_of_body(double radius, const Pose& T_base_camera, double std_factor,
                        Random& random) {
  const test::Surface body = radius > 0.0 ? test::sphere(Eigen::Vector3d::Zero(), radius)
                                          : test::plane(Eigen::Vector3d::UnitZ(), 0.0);
  DepthImage depth = test::depth_of(body, kFineCamera, T_base_camera);
  const auto is_seen = [&](int u, int v) {
    if (depth(u, v) == 0.0F) return false;
    const Eigen::Vector3d p = T_base_camera * kFineCamera.unproject({u, v}, depth(u, v));
    const Eigen::Vector3d normal = radius > 0.0 ? p.normalized() : Eigen::Vector3d::UnitZ();
    return normal.dot((T_base_camera.translation() - p).normalized()) >= kMinCosine;
  };
  for (int v = 0; v < depth.height(); v += 2) {
    for (int u = 0; u < depth.width(); u += 2) {
      const bool is_kept =
          is_seen(u, v) && is_seen(u + 1, v) && is_seen(u, v + 1) && is_seen(u + 1, v + 1);
      for (float* z : {&depth(u, v), &depth(u + 1, v), &depth(u, v + 1), &depth(u + 1, v + 1)}) {
        const double std = std_factor * DepthNoise{}.depth_std(*z);
        *z = is_kept ? *z + static_cast<float>(std * random.normal()) : 0.0F;
      }
    }
  }
  return depth;
}

/// A camera 0.8 to 1.2 m above the plane z = 0, tilted by up to 40 deg, in any rotation about z.
Pose pose_above_plane(Random& random) {
  const Eigen::Vector3d eye(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1),
                            random.uniform(0.8, 1.2));
  const double angle = random.uniform(0.0, 2.0 * M_PI);
  const double away = eye.z() * std::tan(random.uniform(0.0, 40.0) * M_PI / 180.0);
  return test::looking_at(
      eye, {eye.x() + away * std::cos(angle), eye.y() + away * std::sin(angle), 0.0});
}

TEST(FusedPlane, IsFlatFromAnyPosesWithinABound) {
  // The distance of a vertex from the plane is at most
  // - 1/64 voxel: vertices keep that distance from the ends of their edge;
  // - half a step (1/512 voxel) of rounding in each frame;
  // - z / (4 f^2 cos^2): the mean depth of 2 x 2 pixels is not that of their centre, as depth is
  // not
  //   linear in the pixel (relative slope s per pixel, at most 1 / (f cos): s^2 / 4); z is below
  //   1.2 m / cos 40 deg / cos of half the field of view < 2.2 m;
  // - 20 um of float rounding: 1e-7 of the coordinates, amplified by f / 5 over the window.
  constexpr int kFrames = 6;
  constexpr double kPooling = 2.2 / (4.0 * 260.0 * 260.0 * kMinCosine * kMinCosine);
  for (const double voxel : {0.004, 0.01, 0.1}) {
    Random random(51);
    TsdfVolume volume(TsdfOptions{voxel});
    for (int i = 0; i < kFrames; ++i) {
      const Pose pose = pose_above_plane(random);
      volume.integrate(view_of_body(0.0, pose, 0.0, random), {}, {}, kFineCamera, pose, {2});
    }
    const TriangleMesh mesh = volume.extract_mesh(1.0, {2});
    const double bound = voxel * (1.0 / 64.0 + kFrames * 0.5 / 512.0) + kPooling + 2e-5;
    ASSERT_GT(surface_area(mesh), 0.2);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      ASSERT_NEAR(mesh.vertices[i].z(), 0.0, bound) << "voxel " << voxel;
      ASSERT_GT(mesh.normals[i].z(), 0.99F);
    }
  }
}

TEST(FusedPlane, AveragesNoise) {
  // The fitted plane in a window of 25 pooled pixels (std / 2 each) has std / 10 at the centre and
  // less than std / 4 two pixels off it: the error of 16 frames' mean is below std / 16. In
  // addition, the bound of the test above, of which 1/64 voxel applies to 1/32 of the vertices.
  constexpr int kFrames = 16;
  constexpr double kNoiseVoxel = 0.005;
  Random random(52);
  TsdfVolume volume(TsdfOptions{kNoiseVoxel});
  const Pose pose = Pose::from_translation({0.0, 0.0, 1.0}) *
                    Pose(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX())),
                         Eigen::Vector3d::Zero());
  for (int i = 0; i < kFrames; ++i) {
    volume.integrate(view_of_body(0.0, pose, 1.0, random), {}, {}, kFineCamera, pose, {2});
  }
  const TriangleMesh mesh = volume.extract_mesh(kFrames / 2.0, {2});
  double sum = 0.0;
  double squares = 0.0;
  std::size_t count = 0;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    // The image's border, where windows are cut, is left out.
    if (std::abs(p.x()) > 0.5F || std::abs(p.y()) > 0.35F) continue;
    sum += double{p.z()};
    squares += double{p.z()} * p.z();
    ++count;
  }
  ASSERT_GT(count, 10'000U);
  const double std_of_depth = DepthNoise{}.depth_std(1.0);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(count)),
            std_of_depth / 16.0 + kNoiseVoxel / 64.0 / 4.0);
  // The mean has no bias: 10 000 vertices of thousands of independent windows; rounding of half a
  // step.
  EXPECT_NEAR(sum / static_cast<double>(count), 0.0,
              std_of_depth / 16.0 / 10.0 + kNoiseVoxel * 0.5 / 512.0 + kNoiseVoxel / 64.0);
}

/// A sphere at the origin, from random poses 1 m from its centre.
TsdfVolume random_views_of_sphere(double radius, double voxel, int frames, double std_factor,
                                  int threads, std::uint64_t seed) {
  Random random(seed);
  TsdfVolume volume(TsdfOptions{voxel});
  for (int i = 0; i < frames; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const Pose pose = test::looking_at(direction, Eigen::Vector3d::Zero());
    ColorImage color(kFineCamera.width, kFineCamera.height);
    for (Rgb8& pixel : color.pixels()) {
      pixel = {static_cast<std::uint8_t>(random.below(256)),
               static_cast<std::uint8_t>(10 + random.below(10)), 255};
    }
    volume.integrate(view_of_body(radius, pose, std_factor, random), color, {}, kFineCamera, pose,
                     {threads});
  }
  return volume;
}

TEST(FusedSphere, IsRoundWithinTheBoundOfAPlanePerPixel) {
  // A plane fitted to a window of radius h lies within h^2 / (2 R) of the sphere. h: 2.5 pooled
  // pixels of z / 130 on each axis, on the surface by 1 / cos; and the distance from the pixel's
  // point to the voxel's, whose ray passes the surface at up to a voxel's diagonal times tan.
  constexpr double kRadius = 0.3;
  constexpr double kSphereVoxel = 0.005;
  const double z = 1.0 - kRadius * kMinCosine;
  const double tangent = std::sqrt(1.0 / (kMinCosine * kMinCosine) - 1.0);
  const double reach =
      2.5 * std::sqrt(2.0) * z / 130.0 / kMinCosine + std::sqrt(3.0) * kSphereVoxel * tangent;
  const double bound = reach * reach / (2.0 * kRadius) + kSphereVoxel / 64.0 + 5e-5;
  ASSERT_LT(bound, kSphereVoxel);
  const TriangleMesh mesh =
      random_views_of_sphere(kRadius, kSphereVoxel, 30, 0.0, 2, 53).extract_mesh(1.0, {2});
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3d p = mesh.vertices[i].cast<double>();
    ASSERT_NEAR(p.norm(), kRadius, bound) << p.transpose();
    // 10 deg: planes at the window's border are tilted by reach / R.
    ASSERT_GT(mesh.normals[i].cast<double>().dot(p.normalized()), std::cos(reach / kRadius));
  }
  // Seen by at least two cameras: the mean of 30 is 2.9 times.
  ASSERT_GT(surface_area(mesh), 2.0 * M_PI * kRadius * kRadius);
}

TEST(FusedSphere, HasAnOrientedManifoldMeshWithColoursInRange) {
  const TriangleMesh mesh =
      random_views_of_sphere(0.2, 0.008, 12, 1.0, 2, 54).extract_mesh(1.0, {2});
  ASSERT_GT(mesh.triangles.size(), 5000U);
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double facing = 0.0;
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      ASSERT_LT(t[i], mesh.vertices.size());
      ASSERT_EQ((++edges[{t[i], t[(i + 1) % 3]}]), 1);
    }
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[t[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[t[2]].cast<double>();
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    ASSERT_GT(cross.norm(), 0.0);
    facing += cross.dot(((a + b + c) / 3.0).normalized());
    area += cross.norm();
  }
  // Faces are outward; noise tilts them, by less than 45 deg on average.
  EXPECT_GT(facing, std::sqrt(0.5) * area);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    ASSERT_NEAR(mesh.normals[i].norm(), 1.0F, 1e-5F);
    // Dithering changes a channel by at most one.
    ASSERT_GE(mesh.colors[i].g, 9);
    ASSERT_LE(mesh.colors[i].g, 20);
    ASSERT_GE(mesh.colors[i].b, 254);
  }
}

TEST(FusedSphere, HasTheSameBytesForAnyNumberOfThreads) {
  const auto mesh_of = [](int threads) {
    return random_views_of_sphere(0.2, 0.008, 6, 1.0, threads, 55).extract_mesh(1.0, {threads});
  };
  const TriangleMesh one = mesh_of(1);
  for (const int threads : {2, 3, 7}) {
    const TriangleMesh many = mesh_of(threads);
    ASSERT_EQ(many.vertices, one.vertices);
    EXPECT_EQ(many.normals, one.normals);
    EXPECT_EQ(many.colors, one.colors);
    EXPECT_EQ(many.triangles, one.triangles);
  }
}

TEST(TsdfVolumeInput, InvalidDepthIsAsNone) {
  // NaN, infinite, negative, zero and out-of-range depth: all as zero, bit by bit.
  const std::vector<float> invalid = {std::numeric_limits<float>::quiet_NaN(),
                                      std::numeric_limits<float>::infinity(),
                                      -std::numeric_limits<float>::infinity(),
                                      -1.0F,
                                      std::numeric_limits<float>::denorm_min(),
                                      std::numeric_limits<float>::max(),
                                      0.299F,
                                      5.001F};
  Random random(56);
  TsdfVolume zeros(TsdfOptions{0.01});
  TsdfVolume invalids(TsdfOptions{0.01});
  for (int i = 0; i < 4; ++i) {
    const Pose pose = pose_above_plane(random);
    DepthImage depth = view_of_body(0.0, pose, 1.0, random);
    DepthImage bad = depth;
    for (std::size_t k = 0; k < depth.pixels().size(); ++k) {
      if (random.below(3) != 0 && k % 320 > 100) continue;
      depth.pixels()[k] = 0.0F;
      bad.pixels()[k] = invalid[random.below(invalid.size())];
    }
    const IntegrationReport a = zeros.integrate(depth, {}, {}, kFineCamera, pose, {1});
    const IntegrationReport b = invalids.integrate(bad, {}, {}, kFineCamera, pose, {1});
    EXPECT_EQ(a.pixels_used, b.pixels_used);
    EXPECT_EQ(a.blocks_added, b.blocks_added);
  }
  const TriangleMesh mesh = zeros.extract_mesh(1.0, {1});
  ASSERT_GT(mesh.vertices.size(), 1000U);
  EXPECT_EQ(invalids.extract_mesh(1.0, {1}).vertices, mesh.vertices);
  // Nothing else than invalid depth: no block.
  TsdfVolume nothing(TsdfOptions{0.01});
  for (const float z : invalid) {
    const DepthImage depth(kFineCamera.width, kFineCamera.height, z);
    EXPECT_EQ(nothing.integrate(depth, {}, {}, kFineCamera, Pose(), {1}).pixels_used, 0U);
  }
  EXPECT_EQ(nothing.block_count(), 0U);
}

TEST(TsdfVolumeInput, FramesWithoutInformationChangeNothing) {
  Random random(57);
  TsdfVolume volume(TsdfOptions{0.01});
  const Pose pose = pose_above_plane(random);
  const DepthImage depth = view_of_body(0.0, pose, 0.0, random);
  for (int i = 0; i < 2; ++i) volume.integrate(depth, {}, {}, kFineCamera, pose, {1});
  const TriangleMesh before = volume.extract_mesh(1.0, {1});
  ASSERT_GT(before.vertices.size(), 1000U);
  const std::size_t blocks = volume.block_count();
  // Images of any size without depth; of one pixel, which is less than the two that are pooled.
  for (const auto& [width, height] : {std::pair(0, 0), {1, 1}, {1, 9}, {9, 1}, {2, 2}, {33, 17}}) {
    CameraModel camera = kFineCamera;
    camera.width = width;
    camera.height = height;
    camera.cx = 0.5 * (width - 1);
    camera.cy = 0.5 * (height - 1);
    volume.integrate(DepthImage(width, height), {}, {}, camera, pose, {2});
    if (width < 2 || height < 2) {
      volume.integrate(DepthImage(width, height, 1.0F), {}, {}, camera, pose, {2});
    }
  }
  // Valid depth, beyond the coordinates of blocks.
  for (const double away : {1e6, 1e12, 1e300}) {
    volume.integrate(depth, {}, {}, kFineCamera, Pose::from_translation({away, 0.0, -away}), {1});
  }
  EXPECT_EQ(volume.block_count(), blocks);
  const TriangleMesh after = volume.extract_mesh(1.0, {1});
  EXPECT_EQ(after.vertices, before.vertices);
  EXPECT_EQ(after.triangles, before.triangles);
}

TEST(TsdfVolumeInput, TheSurfaceDoesNotDependOnTheOrderOfFrames) {
  // Distances are means: another order only changes their rounding, of half a step of 1/512 voxel
  // in each frame. Vertices on the same edge (rounded to a voxel) differ by at most that, over the
  // slope along the edge; compared along z, at a slope of 1.
  constexpr int kFrames = 8;
  Random random(58);
  std::vector<Pose> poses;
  std::vector<DepthImage> depths;
  for (int i = 0; i < kFrames; ++i) {
    poses.push_back(pose_above_plane(random));
    depths.push_back(view_of_body(0.0, poses.back(), 1.0, random));
  }
  const auto heights_of = [&](bool reversed) {
    TsdfVolume volume(TsdfOptions{0.01});
    for (int i = 0; i < kFrames; ++i) {
      const auto k = static_cast<std::size_t>(reversed ? kFrames - 1 - i : i);
      volume.integrate(depths[k], {}, {}, kFineCamera, poses[k], {1});
    }
    std::map<std::pair<long, long>, std::vector<double>> heights;
    for (const Eigen::Vector3f& p : volume.extract_mesh(3.0, {1}).vertices) {
      const double x = p.x() / 0.01;
      const double y = p.y() / 0.01;
      if (std::abs(x - std::round(x)) > 1e-3 || std::abs(y - std::round(y)) > 1e-3) continue;
      heights[{std::lround(x), std::lround(y)}].push_back(p.z());
    }
    return heights;
  };
  const auto forward = heights_of(false);
  const auto backward = heights_of(true);
  ASSERT_GT(forward.size(), 1000U);
  std::size_t compared = 0;
  for (const auto& [at, heights] : forward) {
    const auto other = backward.find(at);
    if (other == backward.end() || other->second.size() != 1 || heights.size() != 1) continue;
    // Both ends of the edge, in both orders: twice kFrames / 2 steps; and 1/64 voxel if the
    // crossing changed its edge.
    ASSERT_NEAR(heights[0], other->second[0], 0.01 * (kFrames / 512.0 + 2.0 / 64.0));
    ++compared;
  }
  EXPECT_GT(compared, forward.size() * 99 / 100);
}

}  // namespace
}  // namespace pcavr
