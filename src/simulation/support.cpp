// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/support.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/solvers.hpp"

namespace pcavr::simulation {
namespace {

Eigen::Vector2d centre_of(const std::vector<PlantPatch>& patches) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const PlantPatch& patch : patches) sum += patch.share * patch.p_body;
  return sum;
}

}  // namespace

Support::Support(const PlantBody& body) {
  const PlantParameters& p = body.parameters;
  weight_ = p.mass * kStandardGravity;
  law_ = {.static_coefficient = p.limiting_static_friction / weight_,
          .sliding_coefficient = p.sliding_friction_coefficient,
          .stribeck_speed = p.stribeck_speed,
          .breakaway_deflection = p.breakaway_displacement};
  law_.damping = bristle_damping(law_.stiffness(), kStandardGravity);
  viscous_ = p.viscous_friction;
  load_exponent_ = p.load_exponent;
  radius_ = friction_radius(body.patches);
  centre_ = centre_of(body.patches);
  Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
  for (const PlantPatch& patch : body.patches) {
    const Eigen::Vector2d r = patch.p_body - centre_;
    farthest = farthest.cwiseMax(r.cwiseAbs());
    patches_.push_back(
        {.r_body = r, .share = patch.share, .wear = patch.wear, .pressure = patch.share * weight_});
  }
  half_side_ = farthest.minCoeff();
}

/// Linear pressure share (a + b . r) on the loaded patches (Winkler foundation) with the given
/// force and moment. Patches can't pull: an active-set iteration. The loaded patches of the
/// previous step are those of this one, except for one or two at the edge of lift-off, so that one
/// iteration per step suffices.
void Support::distribute(double extra_normal_force, const Eigen::Vector2d& tipping_moment_body) {
  // A tip that lifts the body by more than its weight leaves nothing on the support.
  const double total = std::max(0.0, weight_ + extra_normal_force);
  if (total == 0.0 || tipping_moment_body.squaredNorm() < 1e-12) return distribute_evenly(total);
  // Beyond this the body would tip over, which is not modelled.
  const double max_moment = 0.9 * half_side_ * total;
  const double magnitude = tipping_moment_body.norm();
  const Eigen::Vector2d moment = tipping_moment_body * std::min(1.0, max_moment / magnitude);
  const bool is_loaded = std::any_of(patches_.begin(), patches_.end(),
                                     [](const Patch& patch) { return patch.pressure > 0.0; });
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (const Patch& patch : patches_) {
    if (is_loaded && patch.pressure <= 0.0) continue;
    const Eigen::Vector3d row(1.0, patch.r_body.x(), patch.r_body.y());
    sums += patch.share * row * row.transpose();
  }
  const Eigen::Vector3d ab = sums.ldlt().solve(Eigen::Vector3d(total, moment.x(), moment.y()));
  double carried = 0.0;
  for (Patch& patch : patches_) {
    const double pressure = ab.x() + ab.tail<2>().dot(patch.r_body);
    // A lifted patch is loaded again once this is positive.
    patch.pressure = patch.share * std::max(0.0, pressure);
    carried += patch.pressure;
  }
  // The loaded patches may lie on a line, about which no moment has a solution.
  if (!(carried > 0.0 && std::isfinite(carried))) return distribute_evenly(total);
  for (Patch& patch : patches_) patch.pressure *= total / carried;
}

void Support::distribute_evenly(double total) {
  for (Patch& patch : patches_) patch.pressure = patch.share * total;
}

double Support::friction_factor(const Patch& patch) const {
  if (load_exponent_ == 0.0 || patch.pressure <= 0.0) return patch.wear;
  return patch.wear * std::pow(patch.pressure / (patch.share * weight_), load_exponent_);
}

Eigen::Vector3d Support::advance(const Eigen::Vector3d& twist, double yaw, const SupportLoad& load,
                                 double dt) {
  const Eigen::Rotation2Dd R_base_body(yaw);
  distribute(load.extra_normal_force, R_base_body.inverse() * load.tipping_moment);
  const Eigen::Matrix2d R = R_base_body.toRotationMatrix();
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  double carried = 0.0, resisting = 0.0;
  for (Patch& patch : patches_) {
    const Eigen::Vector2d r = R * patch.r_body;
    const Eigen::Vector2d velocity(twist.x() - twist.z() * r.y(), twist.y() + twist.z() * r.x());
    const Eigen::Vector2d friction = advance_bristles<2>(law_, velocity, dt, patch.deflection);
    const double factor = friction_factor(patch);
    const Eigen::Vector2d force =
        -factor * patch.pressure * friction - viscous_ * patch.share * velocity;
    wrench += Eigen::Vector3d(force.x(), force.y(), r.x() * force.y() - r.y() * force.x());
    carried += patch.pressure;
    resisting += factor * patch.pressure;
  }
  load_factor_ = carried > 0.0 ? resisting / carried : 1.0;
  return wrench;
}

}  // namespace pcavr::simulation
