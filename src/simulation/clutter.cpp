// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/clutter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/layout.hpp"

namespace pcavr::simulation {
namespace {

constexpr double kNeighbourGap = 0.02;  ///< between neighbours [m]: separable in a point cloud
constexpr int kMaxAttempts = 300;  ///< of rejection sampling; more attempts hardly ever succeed
constexpr int kSegments = 48;      ///< of round bodies: the facets' error is below 0.1 mm

Pose upright(const Eigen::Vector2d& position, double yaw) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())),
          {position.x(), position.y(), 0.0}};
}

/// `number` counts the pieces: consecutive ones are far apart in hue (golden section).
Material random_material(double first_hue, int number, Random& random) {
  constexpr Texture kTextures[] = {Texture::plaster, Texture::fabric, Texture::patches,
                                   Texture::terrazzo};
  const Eigen::Vector3f base = color_of_hue(first_hue + kGoldenSection * number,
                                            random.uniform(0.2, 0.6), random.uniform(0.6, 0.9));
  const float darker = static_cast<float>(random.uniform(0.35, 0.6));
  return {.texture = kTextures[random.below(4)],
          .base = base,
          .accent = darker * base,
          .scale = static_cast<float>(random.uniform(0.015, 0.035)),
          .gloss = static_cast<float>(random.uniform(0.0, 0.25)),
          .seed = static_cast<std::uint32_t>(random.bits())};
}

/// Adds one piece of clutter of random shape with the given footprint radius.
void add_piece(Surface& surface, double radius, const Eigen::Vector2d& position, Random& random,
               std::uint16_t material) {
  const Pose T_base_shape = upright(position, random.uniform(0.0, 2.0 * std::numbers::pi));
  const double height = random.uniform(0.06, 0.20);
  switch (random.below(5)) {
    case 0:
      return add_revolution(surface, cylinder_profile(radius, height), kSegments, T_base_shape,
                            material);
    case 1:
      return add_revolution(surface, sphere_profile(radius), kSegments, T_base_shape, material);
    case 2:
      return add_revolution(surface, cup_profile(radius, 1.2 * radius + 0.4 * height, 0.005),
                            kSegments, T_base_shape, material);
    case 3: {
      const double angle = random.uniform(0.5, 1.0);
      const Eigen::Vector2d half = radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      return add_prism(surface,
                       {{-half.x(), -half.y()},
                        {half.x(), -half.y()},
                        {half.x(), half.y()},
                        {-half.x(), half.y()}},
                       0.0, 0.7 * height, T_base_shape, material);
    }
    default: {
      // A wedge: a prism on a triangle, laid on its side.
      const double half = 0.7 * radius;
      const Pose T_shape_wedge(
          Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX())),
          Eigen::Vector3d::Zero());
      return add_prism(surface, {{-half, 0.0}, {half, 0.0}, {0.3 * half, 1.3 * half}}, -half, half,
                       T_base_shape * T_shape_wedge, material);
    }
  }
}

}  // namespace

void Occupancy::occupy(const Eigen::Vector2d& centre, double radius) {
  discs_.push_back({centre, radius});
}

void Occupancy::keep_out(const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  rectangles_.emplace_back(low, high);
}

bool Occupancy::is_free(const Eigen::Vector2d& centre, double radius) const {
  const double reach = radius + kNeighbourGap;
  return std::all_of(discs_.begin(), discs_.end(),
                     [&](const Disc& disc) {
                       return (disc.centre - centre).norm() >= disc.radius + reach;
                     }) &&
         std::all_of(rectangles_.begin(), rectangles_.end(), [&](const Eigen::AlignedBox2d& box) {
           return box.exteriorDistance(centre) >= reach;
         });
}

std::optional<Eigen::Vector2d> Occupancy::find_free_position(double radius,
                                                             const Eigen::Vector2d& low,
                                                             const Eigen::Vector2d& high,
                                                             Random& random) {
  for (int i = 0; i < kMaxAttempts; ++i) {
    const double x = random.uniform(low.x(), high.x());
    const Eigen::Vector2d centre(x, random.uniform(low.y(), high.y()));
    if (!is_free(centre, radius)) continue;
    occupy(centre, radius);
    return centre;
  }
  return std::nullopt;
}

int add_clutter(Body& room, int count, Random& random, Occupancy& occupancy) {
  int placed = 0;
  const double first_hue = random.uniform();
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.025, 0.055);
    const double edge = radius + kNeighbourGap;
    const auto position =
        occupancy.find_free_position(radius, {kTableNear + edge, -kTableSide + edge},
                                     {kTableFar - 0.1 - edge, kTableSide - edge}, random);
    if (!position) continue;
    const auto material = static_cast<std::uint16_t>(room.materials.size());
    room.materials.push_back(random_material(first_hue, i, random));
    add_piece(room.surface, radius, *position, random, material);
    ++placed;
  }
  return placed;
}

Eigen::Vector3f color_of_hue(double hue, double min_channel, double brightness) {
  const auto channel = [&](double position) {
    // HSV: one third of the circle full, one third zero, with ramps of a sixth between.
    const double hue_distance = std::abs(std::remainder(hue - position, 1.0));
    return std::clamp(2.0 - 6.0 * hue_distance, 0.0, 1.0);
  };
  const Eigen::Vector3d pure(channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0));
  return (brightness * (min_channel + (1.0 - min_channel) * pure.array())).matrix().cast<float>();
}

}  // namespace pcavr::simulation
