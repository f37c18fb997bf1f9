// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "pcavr/identification/sliding.hpp"

namespace pcavr {

struct ForceOptions {
  Compliance compliance{1000.0, 0.0, 1.0};  ///< of the surface
  double max_force = 5.0;                   ///< [N] of the device
  double max_rate = 2000.0;                 ///< [N/s] by which the force may grow or turn
  /// [m/s^2] of the hand: what lets the next cycle's motion be told from the last one's. A hand
  /// that holds a device's handle stays under 2 g.
  double max_acceleration = 20.0;
  /// [N] while inside, paid for or not: what a force grows from. Too small to be felt. A hand on
  /// its way out that has not paid gets a thousandth of it.
  double min_force = 1e-4;
};

/// The force on the device from how far its tip has sunk in, held until the next cycle.
///
/// A spring that is held for a cycle gives more than it took [Colgate & Schenkel 1997]. Two things
/// prevent that: the law is taken half a cycle ahead, which is exact at constant speed; and an
/// account is kept of the work that the hand has put in [Hannaford & Ryu 2002], of which the force
/// may never spend more in the coming cycle than there is. The hand's acceleration bounds how far
/// it can go by then. Not thread-safe; neither allocates, locks nor throws.
class RenderedForce {
 public:
  /// Options finite and in range: PCAVR_REQUIRE.
  explicit RenderedForce(const ForceOptions& options);

  /// The force [N] on the device after a cycle of `dt` [s] > 0 that ended with the device at `tip`
  /// and the proxy at `proxy` [m]. Not more than max_force; it does not grow or turn faster than
  /// max_rate, but falls faster where the work runs out. `beside` [N] is what something else would
  /// have the hand feel: it is added to the law's force before all that. Zero, and the account as
  /// before, where an argument is not finite.
  Eigen::Vector3d step(const Eigen::Vector3d& tip, const Eigen::Vector3d& proxy, bool is_inside,
                       double dt, const Eigen::Vector3d& beside = Eigen::Vector3d::Zero()) noexcept;

  /// The work [J] that the hand has put in and may get back. Once the force is zero what is left
  /// counts as dissipated; a debt is kept.
  [[nodiscard]] double available_work() const { return work_; }

 private:
  [[nodiscard]] double wanted(double depth, double dt) const noexcept;
  void spend_no_more_than_there_is(const Eigen::Vector3d& moved, double dt) noexcept;

  ForceOptions options_;
  bool has_tip_ = false;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  double depth_ = 0.0;
  double work_ = 0.0;
};

}  // namespace pcavr
