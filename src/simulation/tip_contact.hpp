// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/simulation/plant.hpp"

#include "simulation/bristles.hpp"

namespace pcavr::simulation {

/// Where and how fast a ball is.
struct Tip {
  Eigen::Vector3d p_base;  ///< its centre [m]
  Eigen::Vector3d v_base;  ///< [m/s]
};

/// How an upright body moves.
struct BodyMotion {
  Eigen::Vector3d p_base;                           ///< of its origin [m]
  Eigen::Matrix3d R_base_body;                      ///< about z only
  Eigen::Vector3d centre_base;                      ///< the centre of mass [m]
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();  ///< of the centre of mass [m/s, m/s, rad/s]
};

/// What the tip does to a body. Base axes.
struct TipLoad {
  bool is_touched = false;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();       ///< [N]
  Eigen::Vector3d tip_torque = Eigen::Vector3d::Zero();  ///< of the tool about the tip [N m]
  double moment = 0.0;  ///< about the vertical through the centre of mass [N m]
  /// Moment that tips the body, see SupportLoad; without what acceleration adds.
  Eigen::Vector2d tipping = Eigen::Vector2d::Zero();
};

/// Contact of the tip with one body: Hunt & Crossley [1975] along the surface's normal, bristles
/// along the surface. Remembers how far the bristles are bent.
class TipContact {
 public:
  TipContact(const PlantBody& body, double tip_radius);

  [[nodiscard]] TipLoad advance(const Tip& tip, const BodyMotion& body, double dt);

 private:
  struct Part {
    Eigen::AlignedBox3d box_body;
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();  ///< base axes [m]
  };

  void add(Part& part, const Tip& tip, const BodyMotion& body, double dt, TipLoad& load) const;

  PlantParameters parameters_;
  double radius_;
  double bottom_body_;  ///< z of the lowest face [m]
  double reach_;        ///< no part is farther from the body's origin [m]
  BristleLaw law_;
  std::vector<Part> parts_;
};

}  // namespace pcavr::simulation
