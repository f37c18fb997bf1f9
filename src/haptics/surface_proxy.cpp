// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/surface_proxy.hpp"

#include <cmath>

#include "pcavr/core/check.hpp"

#include "haptics/ball.hpp"
#include "haptics/friction_cone.hpp"

namespace pcavr {

struct SurfaceProxy::Impl {
  Impl(const TriangleMesh& mesh, const ProxyOptions& proxy_options)
      : ball(proxy_options.radius), options(proxy_options) {
    ball.add_static(mesh);
  }

  detail::Ball ball;
  ProxyOptions options;
  bool is_placed = false;
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d contact_normal = Eigen::Vector3d::Zero();  ///< zero where nothing was touched
};

SurfaceProxy::SurfaceProxy(const TriangleMesh& mesh, const ProxyOptions& options) {
  PCAVR_REQUIRE(std::isfinite(options.radius) && options.radius > 0.0, options.radius);
  PCAVR_REQUIRE(std::isfinite(options.friction) && options.friction >= 0.0, options.friction);
  PCAVR_REQUIRE(std::isfinite(options.max_motion) && options.max_motion >= 1.0, options.max_motion);
  impl_ = std::make_unique<Impl>(mesh, options);
}
SurfaceProxy::~SurfaceProxy() = default;
SurfaceProxy::SurfaceProxy(SurfaceProxy&&) noexcept = default;
SurfaceProxy& SurfaceProxy::operator=(SurfaceProxy&&) noexcept = default;

bool SurfaceProxy::reset(const Eigen::Vector3d& centre) noexcept {
  if (!centre.allFinite() || !impl_->ball.has_room(centre)) return false;
  impl_->is_placed = true;
  impl_->ball.put(centre);
  impl_->tip = centre;
  impl_->contact_normal.setZero();
  return true;
}

ProxyState SurfaceProxy::step(const Eigen::Vector3d& tip) noexcept {
  Impl& impl = *impl_;
  if (!tip.allFinite()) return {impl.ball.centre(), false};
  if (!impl.is_placed) {
    if (!reset(tip)) impl.ball.put(tip);
    return {tip, false};
  }
  const double moved = (tip - impl.tip).norm();
  impl.tip = tip;
  if (moved > 0.0) {
    const Eigen::Vector3d goal =
        detail::held_back(tip, impl.ball.centre(), impl.contact_normal, impl.options.friction);
    impl.ball.follow(goal, moved, impl.options.max_motion * moved);
    impl.contact_normal = impl.ball.static_normal(tip);
  }
  return {impl.ball.centre(), impl.ball.is_kept_apart(tip)};
}

}  // namespace pcavr
