// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// Defaults and ranges of all options of this module: src/teleoperation/haptics/options.cpp.
struct ForceOptions {
  ForceOptions();
  double stiffness;  ///< [N/m^n] of the surface
  double damping;    ///< [N s/m^(n+1)] of the surface
  double exponent;   ///< n of the surface's contact law
  double max_force;  ///< [N] of the device
  double rise_time;  ///< [s] in which the force vector may rise to max_force: avoids force steps
  /// [m/s^2] of the hand: bounds the next cycle's motion given the last one's.
  double max_acceleration;
  /// [N] rendered while inside even with an empty energy budget, so that a force can build up.
  /// A thousandth of it where the hand moves out with an empty budget.
  double min_force;

  [[nodiscard]] HuntCrossley contact_law() const { return {stiffness, damping, exponent}; }
  [[nodiscard]] double max_rate() const { return max_force / rise_time; }  ///< [N/s]
};
[[nodiscard]] OptionSection section_of(ForceOptions& options);

/// The force on the device from the penetration of its tip, constant until the next cycle
/// (zero-order hold).
///
/// A virtual spring with a zero-order hold is active: it returns more energy than it took [Colgate
/// & Schenkel 1997]. Two measures keep it passive. The law is evaluated half a cycle ahead, which
/// is exact at constant speed. A passivity observer sums the work that the hand has put in (the
/// energy budget), and a passivity controller scales the force so that the coming cycle cannot
/// return more than that [Hannaford & Ryu 2002]; the hand's acceleration bounds its motion in that
/// cycle. Not thread-safe; neither allocates, locks nor throws.
class RenderedForce {
 public:
  /// Options finite and in range: PCAVR_REQUIRE.
  explicit RenderedForce(const ForceOptions& options);

  /// The force [N] on the device after a cycle of `dt` [s] > 0 that ended with the device at `tip`
  /// and the proxy at `proxy` [m]. Limited to max_force and its maximum rate; it decreases faster
  /// where the energy budget runs out. `other_force` [N] comes from other contacts: it is added to
  /// the law's force before limiting. Zero, with the energy budget unchanged, where an argument is
  /// not finite.
  Eigen::Vector3d step(const Eigen::Vector3d& tip, const Eigen::Vector3d& proxy, bool is_inside,
                       double dt,
                       const Eigen::Vector3d& other_force = Eigen::Vector3d::Zero()) noexcept;

  /// The energy budget [J]: work that the hand has put in and that may be returned. Once the force
  /// is zero the rest counts as dissipated; a negative budget is kept.
  [[nodiscard]] double available_energy() const { return energy_; }

 private:
  [[nodiscard]] double law_force(double penetration, double dt) const noexcept;
  void limit_to_energy_budget(const Eigen::Vector3d& displacement, double dt) noexcept;

  ForceOptions options_;
  HuntCrossley contact_law_;
  double max_rate_;  ///< [N/s]
  bool has_tip_ = false;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  double penetration_ = 0.0;
  double energy_ = 0.0;
};

}  // namespace pcavr
