// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

#include "physics/prediction/upright_body.hpp"

namespace pcavr::detail {

/// Maximum clearance between tip and body that is computed [m]: ten cycles at the maximum speed.
constexpr double kMaxClearance = 0.05;

/// The tip's sphere and the path of its centre during a step, in base.
struct TipPath {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
  double radius = 0.0;     ///< [m]
  double max_speed = 0.0;  ///< [m/s] a faster tip has jumped: it is placed at `to`
  bool is_present = true;  ///< false: there is no tool
};

/// Contact, or closest points, of the tip's sphere and a body, base axes.
struct TipContact {
  double depth = -kMaxClearance;  ///< penetration of the undeformed shapes [m]; negative: clearance
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< out of the body
  Eigen::Vector2d arm = Eigen::Vector2d::Zero();      ///< from the centre of mass to the surface
  double height = 0.0;                                ///< of that point in base [m]
};

/// Empty where they are further apart than kMaxClearance. `entry_normal`: see BodyState.
[[nodiscard]] std::optional<TipContact> find_tip_contact(
    const UprightBody& body, const PlanarState& planar, const Eigen::Vector3d& p_base_tip,
    double radius, const Eigen::Vector3d& entry_normal) noexcept;

/// The faces that the tip touches at once, the deepest first; alone, also where it touches none.
struct TipContacts {
  std::array<TipContact, BodyState::kMaxGrips> all = {};
  int count = 1;
  [[nodiscard]] const TipContact& deepest() const noexcept { return all[0]; }
};
[[nodiscard]] TipContacts find_tip_contacts(const UprightBody& body, const PlanarState& planar,
                                            const Eigen::Vector3d& p_base_tip, double radius,
                                            const Eigen::Vector3d& entry_normal) noexcept;

/// Force of the tip on the body, and its derivatives.
struct TipForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();       ///< base axes [N]
  Eigen::Vector3d deflection = Eigen::Vector3d::Zero();  ///< tangential, limited where it slips [m]
  double normal_stiffness = 0.0;                         ///< [N/m]
  double normal_damping = 0.0;                           ///< [N s/m]
  double tangential_stiffness = 0.0;                     ///< 0 where it slips
  double tangential_damping = 0.0;                       ///< 0 where it slips
};

/// The force follows the contact law along the normal. Tangentially it is a spring parallel to a
/// damper, by that law's stiffness, up to Coulomb's limit (elastoplastic, like the bristle of Dahl
/// and LuGre models). `radius` [m] is the tip's. `deflection` and `deflection_rate` are those of
/// the tip relative to the surface.
[[nodiscard]] TipForce tip_force(const UprightBody& body, double radius,
                                 const Eigen::Vector3d& normal, double depth, double rate,
                                 const Eigen::Vector3d& deflection,
                                 const Eigen::Vector3d& deflection_rate) noexcept;

/// The wrench [fx fy m] at the centre of mass.
[[nodiscard]] inline Eigen::Vector3d wrench_at(const Eigen::Vector2d& arm,
                                               const Eigen::Vector3d& force) noexcept {
  return {force.x(), force.y(), arm.x() * force.y() - arm.y() * force.x()};
}

}  // namespace pcavr::detail
