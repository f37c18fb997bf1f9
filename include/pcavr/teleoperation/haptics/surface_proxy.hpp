// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct ProxyOptions {
  ProxyOptions();
  double radius;    ///< [m] of the tool's tip; a larger one smooths a noisy scan more
  double friction;  ///< Coulomb coefficient between tip and surface
  /// >= 1: the proxy's maximum displacement in a step over that of the tip. At 1 the proxy never
  /// jumps, and lags where its path over a rough surface is longer than the tip's; 2 or more lags
  /// less.
  double max_motion_ratio;
};
[[nodiscard]] OptionSection section_of(ProxyOptions& options);

struct ProxyState {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m] of the proxy, in the mesh's frame
  bool is_inside = false;  ///< the tip, or a sphere at the tip, penetrates the surface
};

/// God-object [Zilles & Salisbury 1995], as a spherical virtual proxy [Ruspini et al. 1997]:
/// follows the tip of a haptic device as far as a triangle mesh lets it. The mesh may be open,
/// noisy, unoriented and in any order.
///
/// The proxy's centre never comes nearer than the radius to any triangle (to rounding), so that
/// there is no pop-through (tunnelling) at any speed; and in one step it moves no farther than
/// max_motion_ratio times the tip's displacement. Not thread-safe; `step` neither allocates, locks
/// nor throws, and is deterministic.
class SurfaceProxy {
 public:
  /// Vertices finite, indices valid, options in range: PCAVR_REQUIRE.
  SurfaceProxy(const TriangleMesh& mesh, const ProxyOptions& options);
  ~SurfaceProxy();
  SurfaceProxy(SurfaceProxy&&) noexcept;
  SurfaceProxy& operator=(SurfaceProxy&&) noexcept;

  /// Places the proxy at `centre` [m]. False, and nothing changed, where it would touch the mesh
  /// there or `centre` is not finite. Without it, the first collision-free tip places the proxy,
  /// and until then there is no contact.
  [[nodiscard]] bool reset(const Eigen::Vector3d& centre) noexcept;

  /// Follows the device's tip to `tip` [m]. A tip that is not finite leaves the proxy where it is.
  ProxyState step(const Eigen::Vector3d& tip) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
