// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/reconstruction/tsdf_volume.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "perception/reconstruction/kernels.hpp"
#include "reconstruction/depth_scenes.hpp"

namespace pcavr {
namespace {

using test::depth_of;
using test::looking_at;
using test::nearest_of;
using test::plane;
using test::sphere;
using test::Surface;

const CameraModel kCamera = test::small_camera();
constexpr double kVoxel = 0.01;

void integrate(TsdfVolume& volume, const Surface& surface, const Pose& T_base_camera,
               int threads = 1) {
  const ColorImage color(kCamera.width, kCamera.height, Rgb8{200, 100, 50});
  volume.integrate(depth_of(surface, kCamera, T_base_camera), color, {}, kCamera, T_base_camera,
                   {threads});
}

Surface wall() { return plane(Eigen::Vector3d::UnitZ(), 1.0); }

/// A sphere observed from all sides.
TsdfVolume fused_sphere(double radius, int threads) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  for (int i = 0; i < 24; ++i) {
    // Viewpoints distributed uniformly over a sphere (golden spiral).
    const double z = 1.0 - (2.0 * i + 1.0) / 24.0;
    const double angle = 2.399963 * i;
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3d eye(r * std::cos(angle), r * std::sin(angle), z);
    integrate(volume, sphere(Eigen::Vector3d::Zero(), radius), looking_at(eye, {0, 0, 0}), threads);
  }
  return volume;
}

double area_nearer_than(const TriangleMesh& mesh, float z) {
  TriangleMesh near = mesh;
  std::erase_if(near.triangles, [&](const auto& t) {
    return mesh.vertices[t[0]].z() >= z || mesh.vertices[t[1]].z() >= z ||
           mesh.vertices[t[2]].z() >= z;
  });
  return surface_area(near);
}

TEST(TsdfVolume, FusesASlantedWallIntoAPlane) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0.2, 1.0).normalized();
  TsdfVolume volume(TsdfOptions{kVoxel});
  for (int i = 0; i < 3; ++i) integrate(volume, plane(normal, 1.0), Pose());
  const TriangleMesh mesh = volume.extract_mesh(2.0, {1});
  ASSERT_GT(mesh.triangles.size(), 1000U);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    // The fit is exact on a plane, up to float rounding and the 20 um distance quantisation.
    EXPECT_NEAR(normal.dot(mesh.vertices[i].cast<double>()), 1.0, 2e-4);
    EXPECT_LT(mesh.normals[i].cast<double>().dot(normal), -0.99);
    EXPECT_NEAR(mesh.colors[i].r, 200, 1);
    EXPECT_NEAR(mesh.colors[i].g, 100, 1);
    EXPECT_NEAR(mesh.colors[i].b, 50, 1);
  }
}

TEST(TsdfVolume, HonoursLensDistortion) {
  CameraModel distorted = kCamera;
  distorted.distortion = {-0.2, 0.05, 0.001, -0.001, 0.0};
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, 0.2, 1.0).normalized();
  TsdfVolume volume(TsdfOptions{kVoxel});
  const DepthImage depth = depth_of(plane(normal, 1.0), distorted, Pose());
  for (int i = 0; i < 2; ++i) volume.integrate(depth, {}, {}, distorted, Pose(), {1});
  const TriangleMesh mesh = volume.extract_mesh(2.0, {1});
  ASSERT_GT(mesh.triangles.size(), 1000U);
  double sum = 0.0;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    const double distance = normal.dot(p.cast<double>()) - 1.0;
    // Nearest-neighbour lookup: an error of up to 0.71 pixels, which the lens stretches to 1 at the
    // corners. A ray error d changes the depth on the slanted plane by n d / n r, r the point's
    // ray.
    const Eigen::Vector3d ray = p.cast<double>() / double{p.z()};
    const double tolerance = normal.head<2>().norm() / distorted.fx / normal.dot(ray);
    EXPECT_NEAR(distance, 0.0, tolerance) << ray.transpose();
    sum += distance;
  }
  EXPECT_NEAR(sum / static_cast<double>(mesh.vertices.size()), 0.0, 2e-4);
}

TEST(TsdfVolume, IgnoresAFrameBeyondTheBlockCoordinates) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  const DepthImage depth = depth_of(plane({0.0, 0.0, 1.0}, 1.0), kCamera, Pose());
  for (const double away : {1e6, 1e12, 1e300}) {
    volume.integrate(depth, {}, {}, kCamera, Pose::from_translation({away, 0.0, -away}), {1});
  }
  EXPECT_TRUE(volume.extract_mesh(1.0, {1}).triangles.empty());
}

TEST(TsdfVolume, CountsNothingBehindTheCameraAsFree) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  for (int i = 0; i < 2; ++i) integrate(volume, wall(), Pose());
  const double before = surface_area(volume.extract_mesh(2.0, {1}));
  ASSERT_GT(before, 0.5);
  // With its back 5 cm from the wall: its blocks reach in front of the camera.
  for (int i = 0; i < 10; ++i) {
    integrate(volume, plane({0.0, 0.0, -1.0}, 0.5), looking_at({0.0, 0.0, 0.95}, {0.0, 0.0, 0.0}));
  }
  EXPECT_NEAR(area_nearer_than(volume.extract_mesh(2.0, {1}), 2.0F) -
                  area_nearer_than(volume.extract_mesh(2.0, {1}), 0.5F),
              before, 1e-3);
}

TEST(TsdfVolume, MeshesASphereWithoutHolesOrDuplicates) {
  const TriangleMesh mesh = fused_sphere(0.2, 1).extract_mesh(1.0, {1});
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
  // Half a per cent of the radius is a tenth of a voxel.
  EXPECT_NEAR(std::cbrt(signed_volume(mesh) * 0.75 / std::numbers::pi), 0.2, 0.001);
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.vertices[t[1]] - mesh.vertices[t[0]];
    const Eigen::Vector3f ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    EXPECT_GT(ab.cross(ac).norm(), 0.0F);
  }
}

TEST(TsdfVolume, GivesTheSameBytesOnAnyNumberOfThreads) {
  const TriangleMesh one = fused_sphere(0.15, 1).extract_mesh(1.0, {1});
  for (const int threads : {2, 4}) {
    const TriangleMesh many = fused_sphere(0.15, threads).extract_mesh(1.0, {threads});
    ASSERT_EQ(many.triangles, one.triangles);
    EXPECT_EQ(many.colors, one.colors);
    const auto bytes = [](const std::vector<Eigen::Vector3f>& v) {
      return v.size() * sizeof(Eigen::Vector3f);
    };
    EXPECT_EQ(std::memcmp(many.vertices.data(), one.vertices.data(), bytes(one.vertices)), 0);
    EXPECT_EQ(std::memcmp(many.normals.data(), one.normals.data(), bytes(one.normals)), 0);
  }
}

TEST(TsdfVolume, HasNoSurfaceThatWasNotObserved) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  integrate(volume, sphere({0.0, 0.0, 1.0}, 0.2), Pose());
  const TriangleMesh mesh = volume.extract_mesh(1.0, {1});
  ASSERT_FALSE(mesh.triangles.empty());
  // The camera observes the near half only, plus the truncation band behind its silhouette.
  for (const Eigen::Vector3f& p : mesh.vertices) EXPECT_LT(p.z(), 1.0F + 0.04F);
  EXPECT_TRUE(TsdfVolume(TsdfOptions{kVoxel}).extract_mesh(1.0, {1}).triangles.empty());
}

TEST(TsdfVolume, IgnoresEmptyAndMaskedFrames) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  const DepthImage none(kCamera.width, kCamera.height);
  EXPECT_EQ(volume.integrate(none, {}, {}, kCamera, Pose(), {1}).pixels_used, 0U);
  const DepthImage depth = depth_of(wall(), kCamera, Pose());
  const MaskImage all(kCamera.width, kCamera.height, 1);
  EXPECT_EQ(volume.integrate(depth, {}, all, kCamera, Pose(), {1}).pixels_used, 0U);
  EXPECT_EQ(volume.block_count(), 0U);
}

/// The remaining area of a sphere that is in front of a wall in some of the frames [m^2].
double remaining_sphere_area(const std::vector<bool>& has_sphere) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  const Surface with_sphere = nearest_of(sphere({0.0, 0.0, 0.7}, 0.08), wall());
  for (const bool has : has_sphere) integrate(volume, has ? with_sphere : wall(), Pose());
  return area_nearer_than(volume.extract_mesh(1.0, {1}), 0.9F);
}

std::vector<bool> frames(int without, int with, bool sphere_first) {
  std::vector<bool> result(static_cast<std::size_t>(without + with), sphere_first);
  const int first = sphere_first ? with : without;
  for (int i = first; i < without + with; ++i) result[static_cast<std::size_t>(i)] = !sphere_first;
  return result;
}

TEST(TsdfVolume, KeepsAStaticSphere) {
  EXPECT_GT(remaining_sphere_area(frames(0, 10, true)), 0.01);
}

TEST(TsdfVolume, CarvesAnObjectThatLeftAfterHalfOfTheFrames) {
  EXPECT_EQ(remaining_sphere_area(frames(10, 10, true)), 0.0);
}

TEST(TsdfVolume, CarvesAnObjectThatAppearedInTheSecondHalfOfTheFrames) {
  EXPECT_EQ(remaining_sphere_area(frames(10, 10, false)), 0.0);
  // More frames than PastViews::kMaxViews.
  EXPECT_EQ(remaining_sphere_area(frames(150, 10, false)), 0.0);
}

TEST(TsdfVolume, DoesNotErodeEdgesUnderPoseErrors) {
  // A sphere in front of a wall; independent pose errors of 2 mm and 0.2 deg rms in every frame.
  const Surface scene = nearest_of(sphere({0.0, 0.0, 0.7}, 0.08), wall());
  TsdfVolume volume(TsdfOptions{kVoxel});
  TsdfVolume noisy(TsdfOptions{kVoxel});
  Random random(3);
  for (int i = 0; i < 40; ++i) {
    integrate(volume, scene, Pose());
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = random.normal() * (k < 3 ? 0.002 : 0.0035) / 1.7321;
    const ColorImage color(kCamera.width, kCamera.height, Rgb8{200, 100, 50});
    noisy.integrate(depth_of(scene, kCamera, Pose()), color, {}, kCamera, Pose::exp(twist), {1});
  }
  const double exact_area = area_nearer_than(volume.extract_mesh(1.0, {1}), 0.9F);
  const double noisy_area = area_nearer_than(noisy.extract_mesh(1.0, {1}), 0.9F);
  EXPECT_GT(noisy_area, 0.97 * exact_area);
}

TEST(TsdfVolume, DoesNotGrowForRepeatedFrames) {
  TsdfVolume volume(TsdfOptions{kVoxel});
  for (int i = 0; i < 70; ++i) integrate(volume, wall(), Pose());
  const std::size_t blocks = volume.block_count();
  const std::size_t bytes = volume.memory_bytes();
  for (int i = 0; i < 70; ++i) integrate(volume, wall(), Pose());
  EXPECT_EQ(volume.block_count(), blocks);
  EXPECT_LE(volume.memory_bytes(), bytes + 1024);
}

/// A block fused with a frame of random surfaces, by the given kernels.
VoxelBlock fused_at_random(const Kernels& kernels) {
  Random random(5);
  std::vector<PixelSurface> pixels(64 * 48 + 1);
  for (std::size_t i = 0; i + 1 < pixels.size(); ++i) {
    pixels[i].normal[2] = 0.8F;
    pixels[i].normal[0] = 0.6F;
    pixels[i].offset = static_cast<float>(random.uniform(0.7, 0.9));
    pixels[i].weight = static_cast<float>(random.uniform(1.0, 256.0));
    pixels[i].truncation = 0.04F;
    pixels[i].free_depth = static_cast<float>(random.uniform(0.8, 1.1));
    pixels[i].color = static_cast<std::uint32_t>(random.below(1U << 24));
  }
  BlockView view{pixels.data(),
                 64,
                 48,
                 50.0F,
                 50.0F,
                 31.5F,
                 23.5F,
                 {-0.04F, -0.04F, 0.95F},
                 {0.01F, 0.001F, 0.0F},
                 {-0.001F, 0.01F, 0.0F},
                 {0.0F, 0.0F, 0.01F},
                 0.0F,
                 9.0F,
                 9.0F,
                 51200.0F,
                 0.01F,
                 77U,
                 3U};
  VoxelBlock block{};
  for (int i = 0; i < 5; ++i) kernels.fuse_block(view, block, nullptr);
  return block;
}

TEST(Kernels, GiveTheSameBitsOnEveryInstructionSet) {
  const std::vector<const Kernels*> supported = supported_kernels();
  const VoxelBlock baseline = fused_at_random(*supported.front());
  EXPECT_NE(baseline.distance_weight, VoxelBlock{}.distance_weight);
  for (const Kernels* kernels : supported) {
    const VoxelBlock block = fused_at_random(*kernels);
    EXPECT_EQ(block.distance_weight, baseline.distance_weight);
    EXPECT_EQ(block.color_counts, baseline.color_counts);
  }
}

/// The results of the row passes for random depth with holes, of a width that is not a multiple of
/// the SIMD width.
std::vector<std::vector<float>> passes_at_random(const Kernels& kernels) {
  constexpr int kWidth = 37;
  constexpr int kStride = kWidth + 2 + kMaxLanes;
  Random random(6);
  std::vector<float> depth(3 * kStride, 0.0F);
  for (int i = 0; i < 3 * kWidth; ++i) {
    const auto at = static_cast<std::size_t>(i / kWidth * kStride + 1 + i % kWidth);
    const double z = 1.0 + 0.02 * random.uniform(0.0, 1.0);
    depth[at] = random.below(8) == 0 ? 0.0F : static_cast<float>(z);
  }
  const std::vector<float> steps(100, 0.012F);
  const float* centre = depth.data() + kStride + 1;
  const FilterRow row{centre, kStride, kWidth, 0.5F, 50.0F, steps.data()};
  std::vector<std::vector<float>> results(3, std::vector<float>(kWidth));
  kernels.filter_row(row, results[0].data());
  kernels.pool_min(centre, centre + kStride, kWidth / 2, results[1].data());
  kernels.pool_depth(centre, centre + kStride, kWidth / 2, results[2].data());
  return results;
}

TEST(Kernels, RowPassesGiveTheSameBitsOnEveryInstructionSet) {
  const std::vector<std::vector<float>> baseline = passes_at_random(*supported_kernels().front());
  for (const std::vector<float>& result : baseline) {
    EXPECT_GT(std::count_if(result.begin(), result.end(), [](float z) { return z > 0.0F; }), 5);
  }
  for (const Kernels* kernels : supported_kernels())
    EXPECT_EQ(passes_at_random(*kernels), baseline);
}

std::vector<std::uint32_t> pooled_colors_at_random(const Kernels& kernels) {
  constexpr int kWidth = 21;
  Random random(7);
  std::vector<std::uint8_t> rows(2 * 6 * kWidth);
  for (std::size_t i = 6; i < rows.size(); ++i) {
    rows[i] = i / (6 * kWidth) == 0 || i % (6 * kWidth) >= 6
                  ? static_cast<std::uint8_t>(random.below(256))
                  : std::uint8_t{0};
  }
  std::vector<std::uint32_t> pooled(kWidth);
  kernels.pool_colors(rows.data(), rows.data() + 6 * kWidth, kWidth, pooled.data());
  // The first four pixels are black; the mean of the next four is rounded to nearest.
  EXPECT_EQ(pooled[0], 1U);
  const int sum = rows[6] + rows[9] + rows[6 * kWidth + 6] + rows[6 * kWidth + 9];
  EXPECT_EQ(pooled[1] & 255U, static_cast<std::uint32_t>((sum + 2) / 4));
  return pooled;
}

TEST(Kernels, PoolColorsGivesTheSameBitsOnEveryInstructionSet) {
  const std::vector<std::uint32_t> baseline = pooled_colors_at_random(*supported_kernels().front());
  for (const Kernels* kernels : supported_kernels()) {
    EXPECT_EQ(pooled_colors_at_random(*kernels), baseline);
  }
}

}  // namespace
}  // namespace pcavr
