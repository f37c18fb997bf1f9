// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/rendered_force.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

/// Share of min_force while the hand moves out with an empty energy budget: from deep penetration
/// all of it would return some microjoules.
constexpr double kEmptyBudgetShare = 1e-3;

}  // namespace

RenderedForce::RenderedForce(const ForceOptions& options)
    : options_(options), contact_law_(options.contact_law()), max_rate_(options.max_rate()) {
  const HuntCrossley& law = contact_law_;
  PCAVR_REQUIRE(std::isfinite(law.stiffness) && law.stiffness > 0.0, law.stiffness);
  PCAVR_REQUIRE(std::isfinite(law.damping) && law.damping >= 0.0, law.damping);
  PCAVR_REQUIRE(std::isfinite(law.exponent) && law.exponent >= 1.0, law.exponent);
  PCAVR_REQUIRE(std::isfinite(options.max_force) && options.max_force > 0.0, options.max_force);
  PCAVR_REQUIRE(std::isfinite(max_rate_) && max_rate_ > 0.0, max_rate_);
  PCAVR_REQUIRE(std::isfinite(options.max_acceleration) && options.max_acceleration > 0.0,
                options.max_acceleration);
  PCAVR_REQUIRE(options.min_force > 0.0 && options.min_force <= options.max_force,
                options.min_force);
}

/// The contact law half a cycle ahead.
double RenderedForce::law_force(double penetration, double dt) const noexcept {
  const double change = penetration - penetration_;
  const double ahead = std::max(penetration + 0.5 * change, 0.0);
  return unclamped_contact_force(contact_law_, ahead, change / dt);
}

Eigen::Vector3d RenderedForce::step(const Eigen::Vector3d& tip, const Eigen::Vector3d& proxy,
                                    bool is_inside, double dt,
                                    const Eigen::Vector3d& other_force) noexcept {
  if (!tip.allFinite() || !proxy.allFinite() || !other_force.allFinite() || !std::isfinite(dt) ||
      dt <= 0.0) {
    force_.setZero();
    has_tip_ = false;
    return force_;
  }
  const Eigen::Vector3d displacement =
      has_tip_ ? Eigen::Vector3d(tip - tip_) : Eigen::Vector3d::Zero();
  tip_ = tip;
  has_tip_ = true;
  energy_ -= force_.dot(displacement);  // passivity observer
  const double penetration = is_inside ? (proxy - tip).norm() : 0.0;
  const Eigen::Vector3d out =
      penetration > 0.0 ? Eigen::Vector3d((proxy - tip) / penetration) : Eigen::Vector3d::Zero();
  const double magnitude =
      std::clamp(law_force(penetration, dt), options_.min_force, options_.max_force);
  penetration_ = penetration;
  const Eigen::Vector3d total = magnitude * out + other_force;
  const double strength = total.norm();
  const Eigen::Vector3d limited = strength > options_.max_force
                                      ? Eigen::Vector3d(options_.max_force / strength * total)
                                      : total;
  const Eigen::Vector3d change = limited - force_;
  const double max_change = max_rate_ * dt;
  const double change_norm = change.norm();
  force_ += change_norm > max_change ? Eigen::Vector3d(max_change / change_norm * change) : change;
  limit_to_energy_budget(displacement, dt);
  if (force_.norm() < options_.min_force) {
    const bool is_budget_empty = energy_ <= 0.0 && limited.dot(displacement) > 0.0;
    force_ = (is_budget_empty ? kEmptyBudgetShare : 1.0) * options_.min_force *
             limited.stableNormalized();
  }
  if (force_.isZero(0.0)) energy_ = std::min(energy_, 0.0);
  return force_;
}

/// Passivity controller [Hannaford & Ryu 2002].
void RenderedForce::limit_to_energy_budget(const Eigen::Vector3d& displacement,
                                           double dt) noexcept {
  const double strength = force_.norm();
  if (strength <= 0.0) return;
  // Largest displacement along the force before the next cycle.
  const double max_displacement =
      force_.dot(displacement) / strength + options_.max_acceleration * dt * dt;
  if (max_displacement <= 0.0) return;
  const double max_passive_force = std::max(energy_, 0.0) / max_displacement;
  if (max_passive_force < strength) force_ *= max_passive_force / strength;
}

}  // namespace pcavr
