// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <Eigen/Core>

#include "pcavr/geometry/mesh.hpp"

namespace pcavr {

struct ProxyOptions {
  double radius =
      0.001;  ///< [m] > 0 of the tool's tip; the larger, the smoother a noisy scan feels
  double friction = 0.0;  ///< >= 0, Coulomb's coefficient between tip and surface
  /// >= 1: how much farther than the tip the ball may move in a step. At 1 it never jumps, and lags
  /// where its way over a rough surface is longer than the tip's below it; 2 or more lags less.
  double max_motion = 1.0;
};

struct ProxyState {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m] of the ball, in the mesh's frame
  bool is_inside = false;  ///< the tip lies behind the surface, or its ball would reach into it
};

/// A ball that follows the tip of a haptic device as far as a triangle mesh lets it [Zilles &
/// Salisbury 1995; Ruspini et al. 1997]. The mesh may be open, noisy, unoriented and in any order.
///
/// The ball never touches less than its radius to any triangle (to rounding), so that it cannot
/// fall through, at any speed; and in one step its centre moves no farther than max_motion times
/// what the tip did. Not thread-safe; `step` neither allocates, locks nor throws, and is
/// deterministic.
class SurfaceProxy {
 public:
  /// Vertices finite, indices sound, options in range: PCAVR_REQUIRE.
  SurfaceProxy(const TriangleMesh& mesh, const ProxyOptions& options);
  ~SurfaceProxy();
  SurfaceProxy(SurfaceProxy&&) noexcept;
  SurfaceProxy& operator=(SurfaceProxy&&) noexcept;

  /// Puts the ball at `centre` [m]. False, and nothing changed, where it would touch the mesh there
  /// or `centre` is not finite. Without it, the first tip that is free of the mesh places the ball,
  /// and until then there is no contact.
  [[nodiscard]] bool reset(const Eigen::Vector3d& centre) noexcept;

  /// Follows the device's tip to `tip` [m]. A tip that is not finite leaves the ball where it is.
  ProxyState step(const Eigen::Vector3d& tip) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pcavr
