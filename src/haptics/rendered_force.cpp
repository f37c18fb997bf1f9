// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/rendered_force.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

/// Of the least force, for a hand on its way out that has no work to its credit: from deep inside
/// the whole of it would be worth some microjoules.
constexpr double kUnpaid = 1e-3;

}  // namespace

RenderedForce::RenderedForce(const ForceOptions& options) : options_(options) {
  const Compliance& law = options.compliance;
  PCAVR_REQUIRE(std::isfinite(law.stiffness) && law.stiffness > 0.0, law.stiffness);
  PCAVR_REQUIRE(std::isfinite(law.damping) && law.damping >= 0.0, law.damping);
  PCAVR_REQUIRE(std::isfinite(law.exponent) && law.exponent >= 1.0, law.exponent);
  PCAVR_REQUIRE(std::isfinite(options.max_force) && options.max_force > 0.0, options.max_force);
  PCAVR_REQUIRE(std::isfinite(options.max_rate) && options.max_rate > 0.0, options.max_rate);
  PCAVR_REQUIRE(std::isfinite(options.max_acceleration) && options.max_acceleration > 0.0,
                options.max_acceleration);
  PCAVR_REQUIRE(options.min_force > 0.0 && options.min_force <= options.max_force,
                options.min_force);
}

double RenderedForce::wanted(double depth, double dt) const noexcept {
  const Compliance& law = options_.compliance;
  const double deepened = depth - depth_;
  // The law of n = 1 damps without the depth's power (see Compliance).
  const double ahead = std::pow(std::max(depth + 0.5 * deepened, 0.0), law.exponent);
  const double damping = law.exponent == 1.0 ? law.damping : law.damping * ahead;
  return law.stiffness * ahead + damping * deepened / dt;
}

Eigen::Vector3d RenderedForce::step(const Eigen::Vector3d& tip, const Eigen::Vector3d& proxy,
                                    bool is_inside, double dt,
                                    const Eigen::Vector3d& beside) noexcept {
  if (!tip.allFinite() || !proxy.allFinite() || !beside.allFinite() || !std::isfinite(dt) ||
      dt <= 0.0) {
    force_.setZero();
    has_tip_ = false;
    return force_;
  }
  const Eigen::Vector3d moved = has_tip_ ? Eigen::Vector3d(tip - tip_) : Eigen::Vector3d::Zero();
  tip_ = tip;
  has_tip_ = true;
  work_ -= force_.dot(moved);
  const double depth = is_inside ? (proxy - tip).norm() : 0.0;
  const Eigen::Vector3d out =
      depth > 0.0 ? Eigen::Vector3d((proxy - tip) / depth) : Eigen::Vector3d::Zero();
  const double size = std::clamp(wanted(depth, dt), options_.min_force, options_.max_force);
  depth_ = depth;
  const Eigen::Vector3d both = size * out + beside;
  const double strength = both.norm();
  const Eigen::Vector3d wished =
      strength > options_.max_force ? Eigen::Vector3d(options_.max_force / strength * both) : both;
  const Eigen::Vector3d change = wished - force_;
  const double max_change = options_.max_rate * dt;
  const double grown = change.norm();
  force_ += grown > max_change ? Eigen::Vector3d(max_change / grown * change) : change;
  spend_no_more_than_there_is(moved, dt);
  if (force_.norm() < options_.min_force) {
    const bool is_unpaid = work_ <= 0.0 && wished.dot(moved) > 0.0;
    force_ = (is_unpaid ? kUnpaid : 1.0) * options_.min_force * wished.stableNormalized();
  }
  if (force_.isZero(0.0)) work_ = std::min(work_, 0.0);
  return force_;
}

void RenderedForce::spend_no_more_than_there_is(const Eigen::Vector3d& moved, double dt) noexcept {
  const double strength = force_.norm();
  if (strength <= 0.0) return;
  // How far the force can push the hand before the next cycle.
  const double farthest = force_.dot(moved) / strength + options_.max_acceleration * dt * dt;
  if (farthest <= 0.0) return;
  const double affordable = std::max(work_, 0.0) / farthest;
  if (affordable < strength) force_ *= affordable / strength;
}

}  // namespace pcavr
