// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include "pcavr/friction/planar_slider.hpp"

#include "prediction/upright_body.hpp"

namespace pcavr::detail {

/// Beyond this the clearance between tip and body is not told [m].
constexpr double kClearance = 0.05;
/// A tip that is faster [m/s] was put elsewhere: no arm that is guided by hand moves so.
constexpr double kFastestTip = 5.0;

/// The tip's sphere and where its centre goes during a step, in base.
struct TipPath {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// Where the tip is next to the body, base axes.
struct Touch {
  double depth = -kClearance;  ///< how deep the undeformed shapes overlap [m]; negative: clearance
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< out of the body
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();      ///< from the centre of mass to the surface
  double height = 0.0;                                ///< of that point in base [m]
};

/// Nothing where they are further apart than kClearance.
[[nodiscard]] std::optional<Touch> touch_of(const UprightBody& body, const PlanarState& planar,
                                            const Eigen::Vector3d& p_base_tip,
                                            double radius) noexcept;

/// What the tip does to the body.
struct TipForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< base axes [N]
  Eigen::Vector3d stretch =
      Eigen::Vector3d::Zero();        ///< of the surface, as far as it does not slip
  double normal_stiffness = 0.0;      ///< [N/m]
  double normal_damping = 0.0;        ///< [N s/m]
  double tangential_stiffness = 0.0;  ///< 0 where it slips
  double tangential_damping = 0.0;    ///< 0 where it slips
};

/// By the contact law along the normal; along the surface a spring beside a damper, of that law's
/// secant, up to Coulomb's limit. `stretch` and `stretch_rate` are of the tip against the surface.
[[nodiscard]] TipForce tip_force(const BodyPhysics& physics, const Eigen::Vector3d& normal,
                                 double depth, double rate, const Eigen::Vector3d& stretch,
                                 const Eigen::Vector3d& stretch_rate) noexcept;

/// The wrench [fx fy m] at the centre of mass.
[[nodiscard]] inline Eigen::Vector3d wrench_at(const Eigen::Vector2d& arm,
                                               const Eigen::Vector3d& force) noexcept {
  return {force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x()};
}

}  // namespace pcavr::detail
