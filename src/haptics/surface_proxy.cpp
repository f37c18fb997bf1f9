// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/surface_proxy.hpp"

#include <cmath>

#include "pcavr/core/check.hpp"

#include "haptics/friction_cone.hpp"
#include "haptics/proxy_sphere.hpp"

namespace pcavr {

struct SurfaceProxy::Impl {
  Impl(const TriangleMesh& mesh, const ProxyOptions& proxy_options)
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
  impl_ = std::make_unique<Impl>(mesh, options);
}
SurfaceProxy::~SurfaceProxy() = default;
SurfaceProxy::SurfaceProxy(SurfaceProxy&&) noexcept = default;
SurfaceProxy& SurfaceProxy::operator=(SurfaceProxy&&) noexcept = default;

bool SurfaceProxy::reset(const Eigen::Vector3d& centre) noexcept {
  if (!centre.allFinite() || !impl_->proxy.is_collision_free(centre)) return false;
  impl_->is_placed = true;
  impl_->proxy.set_centre(centre);
  impl_->tip = centre;
  impl_->contact_normal.setZero();
  return true;
}

ProxyState SurfaceProxy::step(const Eigen::Vector3d& tip) noexcept {
  Impl& impl = *impl_;
  if (!tip.allFinite()) return {impl.proxy.centre(), false};
  if (!impl.is_placed) {
    if (!reset(tip)) impl.proxy.set_centre(tip);
    return {tip, false};
  }
  const double displacement = (tip - impl.tip).norm();
  impl.tip = tip;
  if (displacement > 0.0) {
    const Eigen::Vector3d goal = detail::friction_limited_goal(
        tip, impl.proxy.centre(), impl.contact_normal, impl.options.friction);
    impl.proxy.follow(goal, displacement, impl.options.max_motion_ratio * displacement);
    impl.contact_normal = impl.proxy.static_normal(tip);
  }
  return {impl.proxy.centre(), impl.proxy.is_separated_from(tip)};
}

}  // namespace pcavr
