// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/simulation/plant.hpp"

#include "simulation/plant_bodies.hpp"

namespace pcavr::simulation {

inline constexpr double kClearance = 0.025;         ///< of the tip above the highest body [m]
inline constexpr double kTravelSpeed = 0.9;         ///< [m/s]
inline constexpr double kTravelAcceleration = 5.0;  ///< [m/s^2]

/// The contact of a push in the box's frame: a point on a face, and the direction from which the
/// box is pushed.
struct PushContact {
  Eigen::Vector3d point;
  Eigen::Vector3d outward;
};

/// Builds the tool's sequence of moves.
class Program {
 public:
  Program(const std::vector<PlantBody>& bodies, const PlantTool& tool)
      : bodies_(bodies), tool_(tool), travel_height_(travel_height(bodies, tool)) {}

  /// Height of the tip in base that is above all bodies [m].
  static double travel_height(const std::vector<PlantBody>& bodies, const PlantTool& tool) {
    double top = 0.0;
    for (const PlantBody& body : bodies) top = std::max(top, 2.0 * half_extents_of(body).z());
    return top + tool.radius + kClearance;
  }

  /// A contact on the face towards -y, `offset` [m] from its centre along x; low enough that the
  /// box does not tip over.
  [[nodiscard]] PushContact minus_y_face(std::size_t body, double offset) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return turned(body, {offset, -half.y(), height(body, half.y())}, -Eigen::Vector3d::UnitY());
  }

  /// A contact on the face towards +y, from where a box is pushed back.
  [[nodiscard]] PushContact plus_y_face(std::size_t body, double offset) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return turned(body, {offset, half.y(), height(body, half.y())}, Eigen::Vector3d::UnitY());
  }

  /// A contact on the face towards -x.
  [[nodiscard]] PushContact minus_x_face(std::size_t body, double offset) const {
    const Eigen::Vector3d half = half_extents_of(bodies_[body]);
    return turned(body, {-half.x(), offset, height(body, half.x())}, -Eigen::Vector3d::UnitX());
  }

  /// Turns the pushes of the next body, in order, by this angle [rad] about the vertical.
  void turn_pushes(double angle) { push_angles_.push_back(angle); }

  void add(const ToolMove& move) { moves_.push_back(move); }
  void wait(double seconds) { moves_.back().dwell += seconds; }

  void lift() {
    add({.target = {0.0, 0.0, travel_height_ - tool_.radius},
         .is_offset = true,
         .speed = kTravelSpeed,
         .acceleration = kTravelAcceleration});
  }

  /// Free motion above all bodies, to a point in the body's frame.
  void travel(std::size_t body, const Eigen::Vector3d& p_body) {
    Eigen::Vector3d above = p_body;
    above.z() = travel_height_ - bodies_[body].T_base_object.translation().z();
    for (const Eigen::Vector3d& p : {above, p_body}) {
      add({.body = body, .target = p, .speed = kTravelSpeed, .acceleration = kTravelAcceleration});
    }
  }

  /// Moves to a contact, stopping `gap` [m] before it.
  void approach(std::size_t body, const PushContact& contact, double gap, double speed) {
    add({.body = body,
         .target = contact.point + (tool_.radius + gap) * contact.outward,
         .speed = speed,
         .acceleration = 1.0});
  }

  void back_off(std::size_t body, const PushContact& contact, double distance, double speed) {
    add({.body = body,
         .target = distance * contact.outward,
         .is_offset = true,
         .speed = speed,
         .acceleration = 1.0});
  }

  /// Speed of the tip [m/s] at which breakaway is reached after `seconds`.
  [[nodiscard]] double loading_speed(std::size_t body, double seconds) const {
    const PlantParameters& p = bodies_[body].parameters;
    const double compression =
        std::pow(p.limiting_static_friction / p.contact_stiffness, 1.0 / p.contact_exponent) +
        p.limiting_static_friction / tool_.stiffness;
    return compression / seconds;
  }

  [[nodiscard]] const PlantBody& body(std::size_t index) const { return bodies_[index]; }
  [[nodiscard]] std::vector<ToolMove> take() { return std::move(moves_); }

 private:
  [[nodiscard]] PushContact turned(std::size_t body, const Eigen::Vector3d& point,
                                   const Eigen::Vector3d& normal) const {
    if (body >= push_angles_.size()) return {point, normal};
    return {point, Eigen::AngleAxisd(push_angles_[body], Eigen::Vector3d::UnitZ()) * normal};
  }

  /// Height of a push above the body's origin [m]: the middle, or lower where friction is high, so
  /// that the centre of pressure stays well inside the base (no tipping).
  [[nodiscard]] double height(std::size_t body, double half_along) const {
    const PlantBody& b = bodies_[body];
    const double half = half_extents_of(b).z();
    const double coefficient =
        b.parameters.limiting_static_friction / (b.parameters.mass * kStandardGravity);
    return std::max(tool_.radius + 0.005, std::min(half, 0.6 * half_along / coefficient)) - half;
  }

  const std::vector<PlantBody>& bodies_;
  const PlantTool& tool_;
  double travel_height_;
  std::vector<double> push_angles_;  ///< [rad] by body; empty: along the normals
  std::vector<ToolMove> moves_;
};

}  // namespace pcavr::simulation
