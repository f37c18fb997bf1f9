// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/teleoperation/haptics/rendered_force.hpp"
#include "pcavr/teleoperation/haptics/surface_proxy.hpp"

namespace pcavr {

struct HapticState {
  Eigen::Vector3d proxy =
      Eigen::Vector3d::Zero();  ///< [m] centre of the tool's sphere (god-object)
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] on the device, until the next step
  bool is_in_contact = false;                       ///< the tip is inside the surface
};

/// Surface proxy (god-object) and rendered force on a scan, as one haptic cycle.
class HapticTool {
 public:
  HapticTool(const TriangleMesh& mesh, const ProxyOptions& proxy, const ForceOptions& force)
      : proxy_(mesh, proxy), force_(force) {}

  /// See SurfaceProxy::reset.
  [[nodiscard]] bool reset(const Eigen::Vector3d& tip) noexcept { return proxy_.reset(tip); }

  /// One cycle of `dt` [s] > 0 that ended with the device's tip at `tip` [m], in the mesh's frame.
  HapticState step(const Eigen::Vector3d& tip, double dt) noexcept {
    const ProxyState proxy = proxy_.step(tip);
    const Eigen::Vector3d force = force_.step(tip, proxy.centre, proxy.is_inside, dt);
    return {proxy.centre, force, proxy.is_inside};
  }

  [[nodiscard]] double available_energy() const { return force_.available_energy(); }

 private:
  SurfaceProxy proxy_;
  RenderedForce force_;
};

}  // namespace pcavr
