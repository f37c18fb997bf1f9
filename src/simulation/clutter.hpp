// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/random.hpp"

#include "simulation/world.hpp"

namespace pcavr::simulation {

/// The occupied parts of the table's top: discs and rectangles in base x and y [m].
class Occupancy {
 public:
  void occupy(const Eigen::Vector2d& centre, double radius);
  void keep_out(const Eigen::Vector2d& low, const Eigen::Vector2d& high);

  /// Finds a random free position for a disc in the rectangle (rejection sampling), and occupies
  /// it.
  [[nodiscard]] std::optional<Eigen::Vector2d> find_free_position(double radius,
                                                                  const Eigen::Vector2d& low,
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

/// Puts cylinders, spheres, blocks, prisms and cups on the table. Returns how many fitted.
int add_clutter(Body& room, int count, Random& random, Occupancy& occupancy);

/// Golden ratio conjugate: hues that are steps of this many turns stay far apart (low discrepancy).
inline constexpr double kGoldenSection = 0.6180339887;

/// Converts HSV to an albedo: hue [turns: 0 red, 1/3 green, 2/3 blue], saturation 1 - `min_channel`
/// and value `brightness`, both 0 to 1.
[[nodiscard]] Eigen::Vector3f color_of_hue(double hue, double min_channel, double brightness);

}  // namespace pcavr::simulation
