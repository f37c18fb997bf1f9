// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/core/random.hpp"
#include "pcavr/haptics/haptic_world.hpp"
#include "pcavr/model/cad_model.hpp"

#include "prediction/closest_surface.hpp"

namespace pcavr::test {

/// What must not happen in a haptic world, told by other means than its own: Embree's distances to
/// the scan and the CAD bodies' signed ones.
class Judge {
 public:
  explicit Judge(const HapticWorldModel& model)
      : radius_(model.world.tool_radius),
        max_force_(model.force.max_force),
        max_rate_(model.force.max_rate),
        scan_(with_supports(model)) {
    for (const WorldBody& body : model.world.bodies) {
      bodies_.emplace_back(body.model.mesh_object, Pose());
    }
  }

  struct Count {
    long steps = 0;
    long inside = 0;         ///< the tip's ball reached into something
    long in_body = 0;        ///< of these, into a body
    long on_scan = 0;        ///< the proxy lay on the scan
    long without_force = 0;  ///< and yet no force
    long in_scan = 0;        ///< the proxy's ball did
    long in_bodies = 0;
    long fallen = 0;  ///< the proxy went through the scan or a support
    long jumps = 0;
    long leaps = 0;  ///< of a body
    long too_strong = 0;
    long too_sudden = 0;
    long not_finite = 0;
    double deepest_in_scan = 0.0;    ///< [m]
    double deepest_in_bodies = 0.0;  ///< [m]
    double max_jump = 0.0;           ///< [m] beyond what the hand and the bodies did
    double max_leap = 0.0;           ///< [m]
    double lag = 0.0;                ///< [m] sum of the distances while touching nothing
    double max_lag = 0.0;
    long free = 0;
  };

  /// After each step, with the hand engaged.
  void see(const HapticWorldState& now, double dt) {
    ++count_.steps;
    if (!now.p_base_proxy.allFinite() || !now.force_base.allFinite()) ++count_.not_finite;
    see_motion(now, dt);
    const double gap = scan_gap(now.p_base_proxy);
    note(gap - radius_ < -kFloat, radius_ - gap, count_.in_scan, count_.deepest_in_scan);
    const bool rests = gap - radius_ < kFloat;
    if (rests) ++count_.on_scan;
    const double body_gap = bodies_gap(now, now.p_base_proxy);
    note(body_gap - radius_ < -kSqueezed, radius_ - body_gap, count_.in_bodies,
         count_.deepest_in_bodies);
    const bool is_in_body = bodies_gap(now, now.p_base_hip) < radius_ - kFloat;
    const bool is_inside = is_in_body || scan_gap(now.p_base_hip) < radius_ - kFloat;
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
  /// The next state is not the next of the last one.
  void forget() { has_last_ = false; }

  [[nodiscard]] const Count& count() const { return count_; }

 private:
  static constexpr double kNear = 0.01;   ///< [m] farther bodies do not meet the proxy in a cycle
  static constexpr double kFloat = 2e-6;  ///< [m] Embree's and the meshes' single precision

  /// [m] by which a body that squeezes the ball against the scan may be in it: what it gives.
  static constexpr double kSqueezed = 1e-4;
  /// [m/s] by which the proxy may be faster than the hand, to catch up with it.
  static constexpr double kCatchingUp = 0.5;
  /// [m/s] Nothing that a hand pushes over a table goes faster.
  static constexpr double kFastestBody = 5.0;

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

  static void note(bool is_so, double size, long& count, double& largest) {
    if (!is_so) return;
    ++count;
    largest = std::max(largest, size);
  }

  void see_motion(const HapticWorldState& now, double dt) {
    if (now.force_base.norm() > max_force_ + 1e-9) ++count_.too_strong;
    if (!has_last_) return;
    const double grown = now.force_base.norm() - last_.force_base.norm();
    if (grown > max_rate_ * dt + 1e-3) ++count_.too_sudden;
    double allowed = (now.p_base_hip - last_.p_base_hip).norm() + last_carried_ + kCatchingUp * dt;
    last_carried_ = 0.0;
    double carried = 0.0;
    for (std::size_t i = 0; i < now.bodies.size(); ++i) {
      const Pose& to = now.bodies[i].T_base_object;
      const Pose& from = last_.bodies[i].T_base_object;
      if (now.bodies[i].is_outside_model) continue;
      const double way = (to.translation() - from.translation()).norm();
      note(way > kFastestBody * dt, way, count_.leaps, count_.max_leap);
      const Eigen::Vector3d& p = last_.p_base_proxy;
      if (body_gap(i, from, p) > radius_ + kNear) continue;
      carried = std::max(carried, (to * (from.inverse() * p) - p).norm());
    }
    last_carried_ = carried;
    const double jump = (now.p_base_proxy - last_.p_base_proxy).norm() - allowed - carried;
    note(jump > 1e-9, jump, count_.jumps, count_.max_jump);
    const Eigen::Vector3f way = (now.p_base_proxy - last_.p_base_proxy).cast<float>();
    const auto hit = scan_.cast(last_.p_base_proxy.cast<float>(), way);
    if (hit && hit->distance <= way.norm()) ++count_.fallen;
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
  double last_carried_ = 0.0;
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
