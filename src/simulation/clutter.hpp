// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/core/random.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

/// Which parts of the table's top are taken: discs and rectangles in base x and y [m].
class Occupancy {
 public:
  void take(const Eigen::Vector2d& centre, double radius);
  void keep_out(const Eigen::Vector2d& low, const Eigen::Vector2d& high);

  /// A random place for a disc within the rectangle, clear of all that is taken, and takes it.
  [[nodiscard]] std::optional<Eigen::Vector2d> find_room(double radius, const Eigen::Vector2d& low,
                                                         const Eigen::Vector2d& high,
                                                         Random& random);

 private:
  [[nodiscard]] bool is_free(const Eigen::Vector2d& centre, double radius) const;

  struct Disc {
    Eigen::Vector2d centre;
    double radius;
  };
  std::vector<Disc> discs_;
  std::vector<Eigen::AlignedBox2d> rectangles_;
};

/// Puts cylinders, balls, blocks, prisms and cups on the table. Returns how many found room.
int add_clutter(Body& room, int count, Random& random, Occupancy& occupancy);

/// Steps of this many turns around the hue circle never come near one another soon.
inline constexpr double kGoldenSection = 0.6180339887;

/// An albedo by hue [turns: 0 red, 1/3 green, 2/3 blue]; `least` is the darkest channel's part of
/// the brightest, which is `brightness`, both 0 to 1.
[[nodiscard]] Eigen::Vector3f color_of_hue(double hue, double least, double brightness);

}  // namespace pcavr::simulation
