// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/support.hpp"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "pcavr/core/check.hpp"
#include "pcavr/core/gravity.hpp"

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
          .reach = p.bristle_reach};
  law_.damping = bristle_damping(law_.stiffness(), kStandardGravity);
  viscous_ = p.viscous_friction;
  radius_ = friction_radius(body.patches);
  centre_ = centre_of(body.patches);
  Eigen::Vector2d farthest = Eigen::Vector2d::Zero();
  for (const PlantPatch& patch : body.patches) {
    const Eigen::Vector2d r = patch.p_body - centre_;
    farthest = farthest.cwiseMax(r.cwiseAbs());
    patches_.push_back({.r_body = r, .share = patch.share, .pressure = patch.share * weight_});
  }
  reach_ = farthest.minCoeff();
}

/// Pressure share (a + b . r) on the patches that bear, such that force and moment are right. The
/// patches that bore in the step before are those that bear now, but for one or two at the edge of
/// what has lifted, so that one round a step follows.
void Support::distribute(double down, const Eigen::Vector2d& tipping_body) {
  const double total = weight_ + down;
  if (tipping_body.squaredNorm() < 1e-12) {
    for (Patch& patch : patches_) patch.pressure = patch.share * total;
    return;
  }
  // Beyond that the body would tip over, which it can't here.
  const double largest = 0.9 * reach_ * total;
  const double much = tipping_body.norm();
  const Eigen::Vector2d moment = tipping_body * std::min(1.0, largest / much);
  Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
  for (const Patch& patch : patches_) {
    if (patch.pressure <= 0.0) continue;
    const Eigen::Vector3d row(1.0, patch.r_body.x(), patch.r_body.y());
    sums += patch.share * row * row.transpose();
  }
  const Eigen::Vector3d ab = sums.ldlt().solve(Eigen::Vector3d(total, moment.x(), moment.y()));
  double borne = 0.0;
  for (Patch& patch : patches_) {
    const double pressure = ab.x() + ab.tail<2>().dot(patch.r_body);
    // Where this is positive again, a patch that had lifted bears once more.
    patch.pressure = patch.share * std::max(0.0, pressure);
    borne += patch.pressure;
  }
  for (Patch& patch : patches_) patch.pressure *= total / borne;
}

Eigen::Vector3d Support::advance(const Eigen::Vector3d& twist, double yaw, const SupportLoad& load,
                                 double dt) {
  const Eigen::Rotation2Dd R_base_body(yaw);
  distribute(load.down, R_base_body.inverse() * load.tipping);
  const Eigen::Matrix2d R = R_base_body.toRotationMatrix();
  Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
  for (Patch& patch : patches_) {
    const Eigen::Vector2d r = R * patch.r_body;
    const Eigen::Vector2d velocity(twist.x() - twist.z() * r.y(), twist.y() + twist.z() * r.x());
    const Eigen::Vector2d dry = advance_bristles<2>(law_, velocity, dt, patch.bend);
    const Eigen::Vector2d force = -patch.pressure * dry - viscous_ * patch.share * velocity;
    wrench += Eigen::Vector3d(force.x(), force.y(), r.x() * force.y() - r.y() * force.x());
  }
  return wrench;
}

}  // namespace pcavr::simulation
