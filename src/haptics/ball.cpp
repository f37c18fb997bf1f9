// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "haptics/ball.hpp"

#include <algorithm>
#include <limits>

namespace pcavr::detail {
namespace {

/// Stretches of one cycle: what is not walked in them is left for the next. Bounds the time.
constexpr int kMaxStretches = 6;
/// How often the half-spaces are drawn anew in a stretch, as the ball rolls over a triangle's rim.
constexpr int kMaxDrawings = 4;
/// [m] A tip that reaches less deep than this is not inside: it is rounding.
constexpr double kInside = 1e-10;
/// [m] A motion that is not worth another drawing: a hundredth of what a device resolves.
constexpr double kNegligible = 1e-7;
/// [m] What is nearer than this bears the ball.
constexpr double kBearing = 1e-8;

}  // namespace

void Ball::add(const TriangleMesh& mesh, bool is_moving) {
  surfaces_.push_back({TriangleTree(mesh), is_moving});
}

void Ball::place(std::size_t surface, const Pose& T_base_object) noexcept {
  surfaces_[surface].is_present = true;
  surfaces_[surface].R_base_object = T_base_object.rotation_matrix();
  surfaces_[surface].p_base_object = T_base_object.translation();
}

void Ball::put(const Eigen::Vector3d& centre) noexcept {
  centre_ = centre;
  count_ = 0;
}

bool Ball::has_room(const Eigen::Vector3d& centre) const noexcept {
  return std::none_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
    return surface.is_present && surface.tree.is_near(radius_, surface.to_own(centre));
  });
}

bool Ball::is_kept_apart(const Eigen::Vector3d& tip) const noexcept {
  if (centre_ == tip) return false;
  return std::any_of(surfaces_.begin(), surfaces_.end(), [&](const Surface& surface) {
    if (surface.is_moving) return false;
    return surface.tree.is_between(centre_, tip) || surface.tree.is_near(radius_ - kInside, tip);
  });
}

bool Ball::gather_all(const Eigen::Vector3d& at, double reach) noexcept {
  count_ = 0;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    if (!surfaces_[s].is_present) continue;
    const std::span<std::uint32_t> room(places_.data() + count_, kMaxTriangles - count_);
    const auto nearby = surfaces_[s].tree.nearer_than(reach, surfaces_[s].to_own(at), room);
    if (!nearby.is_complete) return false;
    std::fill_n(owners_.begin() + static_cast<std::ptrdiff_t>(count_), nearby.count,
                static_cast<std::uint32_t>(s));
    count_ += nearby.count;
  }
  return true;
}

/// Gathers all triangles that a path of `stretch` [m] from `at` can meet; shortens it until they
/// fit. The ball stands still where they never do.
void Ball::gather(const Eigen::Vector3d& at, double& stretch) noexcept {
  for (int halvings = 0; halvings < 12; ++halvings) {
    // A little more than the path, so that what touches is among them in spite of rounding.
    if (gather_all(at, radius_ + stretch + kBearing)) return;
    stretch *= 0.5;
  }
  stretch = 0.0;
  count_ = 0;
}

/// The half-spaces at `at` of the triangles gathered.
std::span<HalfSpace> Ball::draw(const Eigen::Vector3d& at) noexcept {
  Eigen::Vector3d own = at;
  std::uint32_t owner = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < count_; ++i) {
    const Surface& surface = surfaces_[owners_[i]];
    if (owners_[i] != owner) own = surface.to_own(at);
    owner = owners_[i];
    const Eigen::Vector3d away = own - model::closest_point(surface.tree.triangle(places_[i]), own);
    const double distance = away.norm();
    Eigen::Vector3d normal = away / distance;
    if (surface.is_moving) normal = surface.R_base_object * normal;
    half_spaces_[i] = {normal, std::max(distance - radius_, 0.0)};
  }
  return {half_spaces_.data(), count_};
}

void Ball::follow(const Eigen::Vector3d& goal, double max_stretch, double budget) noexcept {
  for (int stretches = 0; stretches < kMaxStretches && budget > 0.0; ++stretches) {
    double stretch = std::min({budget, max_stretch, (goal - centre_).norm()});
    gather(centre_, stretch);
    const double gathered_for = stretch;
    double last = stretch;
    for (int drawings = 0; drawings < kMaxDrawings; ++drawings) {
      last = stretch;
      centre_ = walk(centre_, goal, draw(centre_), stretch);
      if (last - stretch <= kNegligible) break;
    }
    budget -= gathered_for - stretch;
    const bool was_halted = last - stretch <= kNegligible;
    if (was_halted || centre_ == goal) return;
  }
}

void Ball::evade(const Eigen::Vector3d& goal, std::size_t surface) noexcept {
  double way = (goal - centre_).norm();
  gather(centre_, way);
  draw(centre_);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (owners_[i] != surface) some_[kept++] = half_spaces_[i];
  }
  centre_ = walk(centre_, goal, {some_.data(), kept}, way);
}

bool Ball::rests_on(std::size_t surface, const Eigen::Vector3d& goal) const noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    const HalfSpace& there = half_spaces_[i];
    if (owners_[i] == surface && there.slack <= kBearing && there.normal.dot(goal - centre_) < 0.0)
      return true;
  }
  return false;
}

Eigen::Vector3d Ball::static_normal(const Eigen::Vector3d& tip) const noexcept {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < count_; ++i) {
    const HalfSpace& there = half_spaces_[i];
    if (surfaces_[owners_[i]].is_moving || there.slack > kBearing) continue;
    if (there.normal.dot(tip - centre_) < 0.0) sum += there.normal;
  }
  sum.stableNormalize();
  return sum;
}

Eigen::Vector3d Ball::beyond_the_moving(const Eigen::Vector3d& goal, double& budget) noexcept {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    if (!surfaces_[owners_[i]].is_moving) some_[kept++] = half_spaces_[i];
  }
  return walk(centre_, goal, {some_.data(), kept}, budget);
}

}  // namespace pcavr::detail
