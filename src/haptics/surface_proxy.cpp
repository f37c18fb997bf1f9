// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/surface_proxy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "pcavr/core/check.hpp"

#include "haptics/free_walk.hpp"
#include "haptics/triangle_tree.hpp"

namespace pcavr {
namespace {

/// A ball of 1 mm meets some 20 triangles of a fine scan in a cycle; where more are met, the cycle
/// is walked in shorter stretches.
constexpr std::size_t kMostTriangles = 192;
/// Stretches of one cycle: what is not walked in them is left for the next. Bounds the time.
constexpr int kMostStretches = 6;
/// How often the half-spaces are drawn anew in a stretch, as the ball rolls over a triangle's rim.
constexpr int kMostDrawings = 4;
/// [m] A tip that reaches less deep than this is not inside: it is rounding.
constexpr double kInside = 1e-10;
/// [m] A motion that is not worth another drawing: a hundredth of what a device resolves.
constexpr double kNegligible = 1e-7;
/// [m] What is nearer than this bears the ball.
constexpr double kBearing = 1e-8;

}  // namespace

struct SurfaceProxy::Impl {
  Impl(const TriangleMesh& mesh, const ProxyOptions& proxy_options)
      : tree(mesh), options(proxy_options) {}

  detail::TriangleTree tree;
  ProxyOptions options;
  bool is_placed = false;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d contact_normal = Eigen::Vector3d::Zero();  ///< zero where nothing was touched
  std::array<std::uint32_t, kMostTriangles> places;
  std::array<detail::HalfSpace, kMostTriangles> half_spaces;

  /// The half-spaces at `at` of the first `count` triangles gathered.
  std::span<detail::HalfSpace> draw(const Eigen::Vector3d& at, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d away = at - model::closest_point(tree.triangle(places[i]), at);
      const double distance = away.norm();
      half_spaces[i] = {away / distance, std::max(distance - options.radius, 0.0)};
    }
    return {half_spaces.data(), count};
  }

  /// Gathers all triangles that a path of `stretch` [m] from `at` can meet; shortens it until they
  /// fit. The ball stands still where they never do.
  std::size_t gather(const Eigen::Vector3d& at, double& stretch) noexcept {
    for (int halvings = 0; halvings < 12; ++halvings) {
      // A little more than the path, so that what touches is among them in spite of rounding.
      const double reach = options.radius + stretch + kBearing;
      const auto nearby = tree.nearer_than(reach, at, places);
      if (nearby.is_complete) return nearby.count;
      stretch *= 0.5;
    }
    stretch = 0.0;
    return 0;
  }

  [[nodiscard]] Eigen::Vector3d goal() const noexcept;
  /// From the half-spaces that the last walk left.
  void find_contact_normal(std::size_t count) noexcept {
    contact_normal.setZero();
    for (std::size_t i = 0; i < count; ++i) {
      const detail::HalfSpace& there = half_spaces[i];
      if (there.slack <= kBearing && there.normal.dot(tip - centre) < 0.0) {
        contact_normal += there.normal;
      }
    }
    contact_normal.stableNormalize();
  }
  void follow(const Eigen::Vector3d& goal, double moved) noexcept;
  [[nodiscard]] bool is_kept_apart() const noexcept;
};

/// Where the ball would go: below the tip by as much as friction lets it lag behind. The tip pulls
/// by a spring, so the cone of the force is a cone of lengths.
Eigen::Vector3d SurfaceProxy::Impl::goal() const noexcept {
  const Eigen::Vector3d pull = tip - centre;
  const double depth = -pull.dot(contact_normal);
  if (contact_normal.isZero(0.0) || depth <= 0.0) return tip;
  const Eigen::Vector3d along = pull + depth * contact_normal;
  const double length = along.norm();
  const double held = options.friction * depth;
  return length <= held ? Eigen::Vector3d(tip - along)
                        : Eigen::Vector3d(tip - held / length * along);
}

void SurfaceProxy::Impl::follow(const Eigen::Vector3d& goal, double moved) noexcept {
  double budget = options.most_motion * moved;
  for (int stretches = 0; stretches < kMostStretches && budget > 0.0; ++stretches) {
    double stretch = std::min({budget, moved, (goal - centre).norm()});
    const std::size_t count = gather(centre, stretch);
    const double gathered_for = stretch;
    double last = stretch;
    for (int drawings = 0; drawings < kMostDrawings && stretch > 0.0; ++drawings) {
      last = stretch;
      centre = detail::walk(centre, goal, draw(centre, count), stretch);
      if (last - stretch <= kNegligible) break;
    }
    budget -= gathered_for - stretch;
    find_contact_normal(count);
    const bool was_halted = last - stretch <= kNegligible;
    if (was_halted || centre == goal) return;
  }
}

/// Whether the surface lies between ball and tip, or the tip's own ball would reach into it.
bool SurfaceProxy::Impl::is_kept_apart() const noexcept {
  if (centre == tip) return false;
  return tree.is_between(centre, tip) || tree.is_near(options.radius - kInside, tip);
}

SurfaceProxy::SurfaceProxy(const TriangleMesh& mesh, const ProxyOptions& options) {
  PCAVR_REQUIRE(std::isfinite(options.radius) && options.radius > 0.0, options.radius);
  PCAVR_REQUIRE(std::isfinite(options.friction) && options.friction >= 0.0, options.friction);
  PCAVR_REQUIRE(std::isfinite(options.most_motion) && options.most_motion >= 1.0,
                options.most_motion);
  impl_ = std::make_unique<Impl>(mesh, options);
}
SurfaceProxy::~SurfaceProxy() = default;
SurfaceProxy::SurfaceProxy(SurfaceProxy&&) noexcept = default;
SurfaceProxy& SurfaceProxy::operator=(SurfaceProxy&&) noexcept = default;

bool SurfaceProxy::reset(const Eigen::Vector3d& centre) noexcept {
  if (!centre.allFinite()) return false;
  if (impl_->tree.is_near(impl_->options.radius, centre)) return false;
  impl_->is_placed = true;
  impl_->centre = centre;
  impl_->tip = centre;
  impl_->contact_normal.setZero();
  return true;
}

ProxyState SurfaceProxy::step(const Eigen::Vector3d& tip) noexcept {
  if (!tip.allFinite()) return {impl_->centre, false};
  if (!impl_->is_placed) {
    if (!reset(tip)) impl_->centre = tip;
    return {tip, false};
  }
  const double moved = (tip - impl_->tip).norm();
  impl_->tip = tip;
  impl_->follow(impl_->goal(), moved);
  const bool is_inside = impl_->is_kept_apart();
  return {impl_->centre, is_inside};
}

}  // namespace pcavr
