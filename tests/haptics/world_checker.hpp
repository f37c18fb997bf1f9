// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/prediction/closest_surface.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr::test {

/// Checks a haptic world's invariants independently of its own computation: by Embree's distances
/// to the scan and signed distances to the CAD bodies (a test oracle).
class WorldChecker {
 public:
  explicit WorldChecker(const HapticWorldModel& model)
      : radius_(model.world.tool_radius),
        max_force_(model.force.max_force),
        max_rate_(model.force.max_rate()),
        scan_(with_supports(model)) {
    for (const WorldBody& body : model.world.bodies) {
      bodies_.emplace_back(body.model.mesh_object, Pose());
    }
  }

  struct Count {
    long steps = 0;
    long inside = 0;         ///< a sphere at the HIP penetrated something
    long in_body = 0;        ///< of these, a body
    long on_scan = 0;        ///< the proxy was in contact with the scan
    long without_force = 0;  ///< inside, but without a force
    long in_scan = 0;        ///< the proxy penetrated the scan
    long in_bodies = 0;
    long pop_throughs = 0;  ///< of the proxy, through the scan or a support
    long jumps = 0;
    long body_jumps = 0;
    long over_max_force = 0;
    long over_max_rate = 0;
    long not_finite = 0;
    double max_in_scan = 0.0;    ///< [m]
    double max_in_bodies = 0.0;  ///< [m]
    double max_jump = 0.0;       ///< [m] beyond the motion of hand and bodies
    double max_body_jump = 0.0;  ///< [m]
    double lag = 0.0;            ///< [m] sum of the distances while free
    double max_lag = 0.0;
    long free = 0;
  };

  /// Call it after each step, with the hand engaged.
  void check(const HapticWorldState& now, double dt) {
    ++count_.steps;
    if (!now.p_base_proxy.allFinite() || !now.force_base.allFinite()) ++count_.not_finite;
    check_motion(now, dt);
    const double gap = scan_gap(now.p_base_proxy);
    record(gap - radius_ < -kSinglePrecision, radius_ - gap, count_.in_scan, count_.max_in_scan);
    const bool rests = gap - radius_ < kSinglePrecision;
    if (rests) ++count_.on_scan;
    const double body_gap = bodies_gap(now, now.p_base_proxy);
    record(body_gap - radius_ < -kMaxSqueeze, radius_ - body_gap, count_.in_bodies,
           count_.max_in_bodies);
    const bool is_in_body = bodies_gap(now, now.p_base_hip) < radius_ - kSinglePrecision;
    const bool is_inside = is_in_body || scan_gap(now.p_base_hip) < radius_ - kSinglePrecision;
    if (is_in_body) ++count_.in_body;
    if (is_inside) {
      ++count_.inside;
      if (!(now.force_base.norm() > 0.0)) ++count_.without_force;
    } else if (now.force_base.isZero(0.0) && !rests) {
      const double lag = (now.p_base_hip - now.p_base_proxy).norm();
      ++count_.free;
      count_.lag += lag;
      count_.max_lag = std::max(count_.max_lag, lag);
    }
    last_ = now;
    has_last_ = true;
  }
  /// The next state does not follow the last one.
  void restart() { has_last_ = false; }

  [[nodiscard]] const Count& count() const { return count_; }

 private:
  static constexpr double kNear = 0.01;  ///< [m] farther bodies cannot reach the proxy in a cycle
  static constexpr double kSinglePrecision =
      2e-6;  ///< [m] Embree's and the meshes' single precision

  /// [m] that a body may penetrate where it squeezes the proxy against the scan: its compliance.
  static constexpr double kMaxSqueeze = 1e-4;
  /// [m/s] by which the proxy may be faster than the hand, to catch up with it.
  static constexpr double kCatchUpSpeed = 0.5;
  /// [m/s] of a body pushed by hand over a table.
  static constexpr double kMaxBodySpeed = 5.0;

  static TriangleMesh with_supports(const HapticWorldModel& model) {
    TriangleMesh mesh = model.world.static_mesh_base;
    for (const auto& outline : model.supports_base) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      for (const Eigen::Vector3d& corner : outline) {
        mesh.vertices.emplace_back(corner.cast<float>());
      }
      for (std::uint32_t i = 2; i < outline.size(); ++i) {
        mesh.triangles.push_back({first, first + i - 1, first + i});
      }
    }
    return mesh;
  }

  static void record(bool is_violated, double size, long& count, double& max) {
    if (!is_violated) return;
    ++count;
    max = std::max(max, size);
  }

  void check_motion(const HapticWorldState& now, double dt) {
    if (now.force_base.norm() > max_force_ + 1e-9) ++count_.over_max_force;
    if (!has_last_) return;
    const double force_change = now.force_base.norm() - last_.force_base.norm();
    if (force_change > max_rate_ * dt + 1e-3) ++count_.over_max_rate;
    double allowed =
        (now.p_base_hip - last_.p_base_hip).norm() + last_body_displacement_ + kCatchUpSpeed * dt;
    last_body_displacement_ = 0.0;
    double body_displacement = 0.0;
    for (std::size_t i = 0; i < now.bodies.size(); ++i) {
      const Pose& to = now.bodies[i].T_base_object;
      const Pose& from = last_.bodies[i].T_base_object;
      if (now.bodies[i].is_outside_model) continue;
      const double step = (to.translation() - from.translation()).norm();
      record(step > kMaxBodySpeed * dt, step, count_.body_jumps, count_.max_body_jump);
      const Eigen::Vector3d& p = last_.p_base_proxy;
      if (body_gap(i, from, p) > radius_ + kNear) continue;
      body_displacement = std::max(body_displacement, (to * (from.inverse() * p) - p).norm());
    }
    last_body_displacement_ = body_displacement;
    const double jump =
        (now.p_base_proxy - last_.p_base_proxy).norm() - allowed - body_displacement;
    record(jump > 1e-9, jump, count_.jumps, count_.max_jump);
    const Eigen::Vector3f displacement = (now.p_base_proxy - last_.p_base_proxy).cast<float>();
    const auto hit = scan_.cast(last_.p_base_proxy.cast<float>(), displacement);
    if (hit && hit->distance <= displacement.norm()) ++count_.pop_throughs;
  }

  [[nodiscard]] double scan_gap(const Eigen::Vector3d& p) const {
    const auto closest = scan_.closest(p.cast<float>(), static_cast<float>(2.0 * radius_));
    return closest ? (closest->point.cast<double>() - p).norm() : 2.0 * radius_;
  }
  [[nodiscard]] double body_gap(std::size_t i, const Pose& T, const Eigen::Vector3d& p) const {
    const auto answer = bodies_[i].closest(T.inverse() * p, radius_ + 2.0 * kNear);
    return answer ? answer->distance : radius_ + 2.0 * kNear;
  }
  [[nodiscard]] double bodies_gap(const HapticWorldState& now, const Eigen::Vector3d& p) const {
    double gap = radius_ + 2.0 * kNear;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (now.bodies[i].is_outside_model) continue;
      gap = std::min(gap, body_gap(i, now.bodies[i].T_base_object, p));
    }
    return gap;
  }

  double radius_;
  double max_force_;
  double max_rate_;
  SurfaceQuery scan_;
  std::vector<detail::ClosestSurface> bodies_;
  Count count_;
  HapticWorldState last_;
  bool has_last_ = false;
  double last_body_displacement_ = 0.0;
};

/// A hand that wanders about a place, at any height up to 0.2 m above it and down to 15 mm below,
/// so that it presses, slides, pushes and leaves again, at up to some 0.5 m/s.
class WanderingHand {
 public:
  explicit WanderingHand(Random& random) {
    for (double& phase : phases_) phase = random.uniform(0.0, 2.0 * M_PI);
    for (double& rate : rates_) rate = random.uniform(0.5, 3.0);
  }

  /// `about` [m]: at the height of the support.
  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& about, double t) const {
    const auto wave = [&](std::size_t i) { return std::sin(rates_[i] * t + phases_[i]); };
    const double height = std::max(0.09 * (wave(4) + wave(5)), -0.08);
    return about + Eigen::Vector3d(0.13 * wave(0) + 0.06 * wave(1), 0.13 * wave(2) + 0.06 * wave(3),
                                   0.065 + height);
  }

 private:
  double phases_[6] = {};
  double rates_[6] = {};
};

}  // namespace pcavr::test
