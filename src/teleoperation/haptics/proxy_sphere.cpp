// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/haptics/proxy_sphere.hpp"

#include <algorithm>
#include <limits>

namespace pcavr::detail {
namespace {

/// Substeps of one cycle; the rest of the motion is left for the next cycle. Bounds the time.
constexpr int kMaxSubsteps = 6;
/// Largest number of times that the half-spaces are rebuilt (relinearized) in a substep, as the
/// sphere rolls over a triangle's edge.
constexpr int kMaxLinearizations = 4;
/// [m] A smaller penetration of the tip is rounding.
constexpr double kMinPenetration = 1e-10;
/// [m] No relinearization below this motion: a hundredth of a device's resolution.
constexpr double kMinMotion = 1e-7;
/// [m] A surface within this slack is in contact.
constexpr double kContactTolerance = 1e-8;

}  // namespace

void ProxySphere::add(const TriangleMesh& mesh, bool is_moving) {
  surfaces_.push_back({TriangleTree(mesh), is_moving});
}

void ProxySphere::set_pose(std::size_t surface, const Pose& T_base_object) noexcept {
  surfaces_[surface].is_present = true;
  surfaces_[surface].R_base_object = T_base_object.rotation_matrix();
  surfaces_[surface].p_base_object = T_base_object.translation();
}

void ProxySphere::set_centre(const Eigen::Vector3d& centre) noexcept {
  centre_ = centre;
  count_ = 0;
}

bool ProxySphere::is_collision_free(const Eigen::Vector3d& centre) const noexcept {
  return std::none_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
    return surface.is_present && surface.tree.is_near(radius_, surface.to_object(centre));
  });
}

bool ProxySphere::is_separated_from(const Eigen::Vector3d& tip) const noexcept {
  if (centre_ == tip) return false;
  return std::any_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
    if (surface.is_moving) return false;
    return surface.tree.is_between(centre_, tip) ||
           surface.tree.is_near(radius_ - kMinPenetration, tip);
  });
}

bool ProxySphere::collect_within(const Eigen::Vector3d& at, double reach) noexcept {
  count_ = 0;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (!surfaces_[s].is_present) continue;
    const std::span<std::uint32_t> found(triangles_.data() + count_, kMaxTriangles - count_);
    const auto nearby = surfaces_[s].tree.nearer_than(reach, surfaces_[s].to_object(at), found);
    if (!nearby.is_complete) return false;
    std::fill_n(surface_of_.begin() + static_cast<std::ptrdiff_t>(count_), nearby.count,
                static_cast<std::uint32_t>(s));
    count_ += nearby.count;
  }
  return true;
}

/// Collects all triangles that a path of `substep` [m] from `at` can meet; halves it until they fit
/// (0 where they never do).
void ProxySphere::collect_triangles(const Eigen::Vector3d& at, double& substep) noexcept {
  for (int halvings = 0; halvings < 12; ++halvings) {
    // The margin keeps rounding from excluding a surface in contact.
    if (collect_within(at, radius_ + substep + kContactTolerance)) return;
    substep *= 0.5;
  }
  substep = 0.0;
  count_ = 0;
}

/// The half-spaces at `at` of the collected triangles (active constraints).
std::span<HalfSpace> ProxySphere::build_half_spaces(const Eigen::Vector3d& at) noexcept {
  Eigen::Vector3d p_object = at;
  std::uint32_t last_surface = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < count_; ++i) {
    const Surface& surface = surfaces_[surface_of_[i]];
    if (surface_of_[i] != last_surface) p_object = surface.to_object(at);
    last_surface = surface_of_[i];
    const Eigen::Vector3d offset =
        p_object - model::closest_point(surface.tree.triangle(triangles_[i]), p_object);
    const double distance = offset.norm();
    Eigen::Vector3d normal = offset / distance;
    if (surface.is_moving) normal = surface.R_base_object * normal;
    half_spaces_[i] = {normal, std::max(distance - radius_, 0.0)};
  }
  return {half_spaces_.data(), count_};
}

void ProxySphere::follow(const Eigen::Vector3d& goal, double max_substep, double budget) noexcept {
  for (int substeps = 0; substeps < kMaxSubsteps && budget > 0.0; ++substeps) {
    double substep = std::min({budget, max_substep, (goal - centre_).norm()});
    collect_triangles(centre_, substep);
    const double substep_before = substep;
    double last = substep;
    for (int linearizations = 0; linearizations < kMaxLinearizations; ++linearizations) {
      last = substep;
      centre_ = move_constrained(centre_, goal, build_half_spaces(centre_), substep);
      if (last - substep <= kMinMotion) break;
    }
    budget -= substep_before - substep;
    const bool is_blocked = last - substep <= kMinMotion;
    if (is_blocked || centre_ == goal) return;
  }
}

void ProxySphere::resolve_overlap(const Eigen::Vector3d& goal, std::size_t surface) noexcept {
  double budget = (goal - centre_).norm();
  collect_triangles(centre_, budget);
  build_half_spaces(centre_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (surface_of_[i] != surface) selected_[kept++] = half_spaces_[i];
  }
  centre_ = move_constrained(centre_, goal, {selected_.data(), kept}, budget);
}

bool ProxySphere::rests_on(std::size_t surface, const Eigen::Vector3d& goal) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    const HalfSpace& half_space = half_spaces_[i];
    if (surface_of_[i] == surface && half_space.slack <= kContactTolerance &&
        half_space.normal.dot(goal - centre_) < 0.0)
      return true;
  }
  return false;
}

Eigen::Vector3d ProxySphere::static_normal(const Eigen::Vector3d& tip) const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const HalfSpace& half_space = half_spaces_[i];
    if (surfaces_[surface_of_[i]].is_moving || half_space.slack > kContactTolerance) continue;
    if (half_space.normal.dot(tip - centre_) < 0.0) sum += half_space.normal;
  }
  sum.stableNormalize();
  return sum;
}

Eigen::Vector3d ProxySphere::centre_ignoring_moving(const Eigen::Vector3d& goal,
                                                    double& budget) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!surfaces_[surface_of_[i]].is_moving) selected_[kept++] = half_spaces_[i];
  }
  return move_constrained(centre_, goal, {selected_.data(), kept}, budget);
}

}  // namespace pcavr::detail
