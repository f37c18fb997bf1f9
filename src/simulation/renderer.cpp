// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/renderer.hpp"

#include <algorithm>

#include "simulation/shader.hpp"

namespace pcavr::simulation {
namespace {

constexpr int kGrid = 4;               ///< sub-samples a side of a pixel on an edge
constexpr float kLightRadius = 0.02F;  ///< of the light that casts shadows [m]

/// Offset of the k-th sub-sample from the pixel's centre [px] (multi-jittered sampling [Chiu,
/// Shirley & Wang 1994] without the jitter): one in each cell of a 4x4 grid, and no two in the same
/// sixteenth of a row or column, so that an edge along the rows is rendered to 1/32 px instead of
/// 1/8 px with a regular grid.
Eigen::Vector2d subpixel_offset(int k) {
  const double column = k % kGrid;
  const double row = k / kGrid;
  return {(column + (row + 0.5) / kGrid) / kGrid - 0.5,
          (row + (column + 0.5) / kGrid) / kGrid - 0.5};
}

/// The point on the area light for the k-th sub-sample: a 4x4 grid as well, shuffled, so that the
/// position in the pixel and on the light are not correlated.
Eigen::Vector3f light_offset(int k) {
  const int shuffled = (k * 7 + 3) % (kGrid * kGrid);
  const auto along = [](int step) {
    return kLightRadius * ((static_cast<float>(step) + 0.5F) * (2.0F / kGrid) - 1.0F);
  };
  return {along(shuffled % kGrid), along(shuffled / kGrid), 0.0F};
}

/// Whether a neighbour of the pixel sees another piece of surface: it needs supersampling.
bool is_on_edge(const Image<std::uint64_t>& keys, int x, int y) {
  const std::uint64_t key = keys(x, y);
  for (int v = std::max(0, y - 1); v <= std::min(keys.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(keys.width() - 1, x + 1); ++u) {
      if (keys(u, v) != key) return true;
    }
  }
  return false;
}

/// The rays' common origin, and the rotation from camera to base axes.
struct View {
  Eigen::Vector3f origin;
  Eigen::Matrix3f R_base_camera;
};

void sample_centres(const Shader& shader, const View& view,
                    const Image<Eigen::Vector3f>& directions, IdealFrame& frame,
                    Image<std::uint64_t>& keys) {
  std::array<Eigen::Vector3f, kPacket> light;
  light.fill(Eigen::Vector3f::Zero());
  for (int y = 0; y < directions.height(); ++y) {
    for (int x = 0; x < directions.width(); x += kPacket) {
      RayPacket rays;
      rays.count = std::min(kPacket, directions.width() - x);
      for (int i = 0; i < rays.count; ++i) {
        rays.origin[static_cast<std::size_t>(i)] = view.origin;
        rays.direction[static_cast<std::size_t>(i)] = view.R_base_camera * directions(x + i, y);
      }
      const auto samples = shader.shade(rays, light);
      for (int i = 0; i < rays.count; ++i) {
        const ShadedSample& sample = samples[static_cast<std::size_t>(i)];
        frame.radiance(x + i, y) = sample.radiance;
        frame.depth(x + i, y) = sample.depth;
        frame.normal_camera(x + i, y) = view.R_base_camera.transpose() * sample.normal_base;
        keys(x + i, y) = sample.key;
      }
    }
  }
}

Eigen::Vector3f supersample(const Shader& shader, const View& view, const CameraModel& camera,
                            int x, int y) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int first = 0; first < kGrid * kGrid; first += kPacket) {
    RayPacket rays;
    rays.count = kPacket;
    std::array<Eigen::Vector3f, kPacket> light;
    for (int i = 0; i < kPacket; ++i) {
      const int k = first + i;
      const Eigen::Vector2d pixel = Eigen::Vector2d(x, y) + subpixel_offset(k);
      const auto lane = static_cast<std::size_t>(i);
      rays.origin[lane] = view.origin;
      rays.direction[lane] = view.R_base_camera * camera.unproject(pixel, 1.0).cast<float>();
      light[lane] = light_offset(k);
    }
    for (const ShadedSample& sample : shader.shade(rays, light)) sum += sample.radiance;
  }
  return sum / (kGrid * kGrid);
}

}  // namespace

Renderer::Renderer(const World& world, const RayBodies& bodies, const CameraModel& camera)
    : world_(world),
      bodies_(bodies),
      camera_(camera),
      directions_(camera.width, camera.height, Eigen::Vector3f::Zero()) {
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      directions_(x, y) = camera.unproject(Eigen::Vector2d(x, y), 1.0).cast<float>();
    }
  }
}

IdealFrame Renderer::render(const Pose& T_base_camera, std::span<const Pose> T_base_body) const {
  const RayScene scene(bodies_, T_base_body);
  const Shader shader(world_, scene, T_base_body, static_cast<float>(1.0 / camera_.fx));
  const View view{.origin = T_base_camera.translation().cast<float>(),
                  .R_base_camera = T_base_camera.rotation_matrix().cast<float>()};
  const int width = camera_.width;
  const int height = camera_.height;
  IdealFrame frame{.radiance = Image<Eigen::Vector3f>(width, height, Eigen::Vector3f::Zero()),
                   .depth = DepthImage(width, height),
                   .normal_camera = Image<Eigen::Vector3f>(width, height, Eigen::Vector3f::Zero())};
  Image<std::uint64_t> keys(width, height);
  sample_centres(shader, view, directions_, frame, keys);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (is_on_edge(keys, x, y)) {
        frame.radiance(x, y) = supersample(shader, view, camera_, x, y);
      }
    }
  }
  return frame;
}

}  // namespace pcavr::simulation
