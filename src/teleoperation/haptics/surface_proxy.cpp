// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

#include <cmath>

#include "pcavr/base/core/check.hpp"

#include "teleoperation/haptics/friction_cone.hpp"
#include "teleoperation/haptics/proxy_sphere.hpp"

namespace pcavr {

struct SurfaceProxy::State {
  State(const TriangleMesh& mesh, const ProxyOptions& proxy_options)
      : proxy(proxy_options.radius), options(proxy_options) {
    proxy.add_static(mesh);
  }

  detail::ProxySphere proxy;
  ProxyOptions options;
  bool is_placed = false;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d contact_normal = Eigen::Vector3d::Zero();  ///< zero where nothing was touched
};

SurfaceProxy::SurfaceProxy(const TriangleMesh& mesh, const ProxyOptions& options) {
  PCAVR_REQUIRE(std::isfinite(options.radius) && options.radius > 0.0, options.radius);
  PCAVR_REQUIRE(std::isfinite(options.friction) && options.friction >= 0.0, options.friction);
  PCAVR_REQUIRE(std::isfinite(options.max_motion_ratio) && options.max_motion_ratio >= 1.0,
                options.max_motion_ratio);
  state_ = std::make_unique<State>(mesh, options);
}
SurfaceProxy::~SurfaceProxy() = default;
SurfaceProxy::SurfaceProxy(SurfaceProxy&&) noexcept = default;
SurfaceProxy& SurfaceProxy::operator=(SurfaceProxy&&) noexcept = default;

bool SurfaceProxy::reset(const Eigen::Vector3d& centre) noexcept {
  if (!centre.allFinite() || !state_->proxy.is_collision_free(centre)) return false;
  state_->is_placed = true;
  state_->proxy.set_centre(centre);
  state_->tip = centre;
  state_->contact_normal.setZero();
  return true;
}

ProxyState SurfaceProxy::step(const Eigen::Vector3d& tip) noexcept {
  State& state = *state_;
  if (!tip.allFinite()) return {state.proxy.centre(), false};
  if (!state.is_placed) {
    if (!reset(tip)) state.proxy.set_centre(tip);
    return {tip, false};
  }
  const double displacement = (tip - state.tip).norm();
  state.tip = tip;
  if (displacement > 0.0) {
    const Eigen::Vector3d goal = detail::friction_limited_goal(
        tip, state.proxy.centre(), state.contact_normal, state.options.friction);
    state.proxy.follow(goal, displacement, state.options.max_motion_ratio * displacement);
    state.contact_normal = state.proxy.static_normal(tip);
  }
  return {state.proxy.centre(), state.proxy.is_separated_from(tip)};
}

}  // namespace pcavr
