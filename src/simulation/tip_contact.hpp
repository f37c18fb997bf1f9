// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/simulation/plant.hpp"

#include "simulation/bristles.hpp"

namespace pcavr::simulation {

/// Position and velocity of the spherical tip.
struct Tip {
  Eigen::Vector3d p_base;  ///< its centre [m]
  Eigen::Vector3d v_base;  ///< [m/s]
};

/// Pose and velocity of an upright body.
struct BodyMotion {
  Eigen::Vector3d p_base;                           ///< of its origin [m]
  Eigen::Matrix3d R_base_body;                      ///< about z only
  Eigen::Vector3d centre_base;                      ///< the centre of mass [m]
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< of the centre of mass [m/s, m/s, rad/s]
};

/// Forces and moments of the tip on a body. Base axes.
struct TipLoad {
  bool is_touched = false;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();       ///< [N]
  Eigen::Vector3d tip_torque = Eigen::Vector3d::Zero();  ///< of the tool about the tip [N m]
  double moment = 0.0;  ///< about the vertical through the centre of mass [N m]
  /// See SupportLoad; without the inertial part.
  Eigen::Vector2d tipping_moment = Eigen::Vector2d::Zero();
};

/// Contact of the tip with one body: Hunt & Crossley [1975] along the surface's normal, bristles
/// along the surface. Stores the bristles' deflection, and the face through which a tip came whose
/// centre is inside of a soft cuboid: it presses on that one also where another one is closer.
class TipContact {
 public:
  TipContact(const PlantBody& body, double tip_radius);

  [[nodiscard]] TipLoad advance(const Tip& tip, const BodyMotion& body, double dt);

 private:
  struct Part {
    Eigen::AlignedBox3d box_body;
    std::vector<Eigen::Vector2d> outline_xz = {};          ///< of a prism; empty for a cuboid
    Eigen::Vector3d deflection = Eigen::Vector3d::Zero();  ///< base axes [m]
    std::optional<Eigen::Vector3d> entry_normal = {};      ///< body axes; while inside of a cuboid
  };

  void add(Part& part, const Tip& tip, const BodyMotion& body, double dt, TipLoad& load) const;

  PlantParameters parameters_;
  double radius_;
  double bottom_body_;      ///< z of the lowest face [m]
  double bounding_radius_;  ///< of the body about its origin [m]: broad phase
  BristleLaw law_;
  std::vector<Part> parts_;
};

}  // namespace pcavr::simulation
