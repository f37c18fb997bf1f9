// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/friction/planar_slider.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"

#include "physics/prediction/upright_body.hpp"

namespace pcavr::detail {

/// Contact point of two shapes, or their closest points.
struct CollisionPoint {
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< into the first shape, base axes
  double depth = 0.0;                                 ///< penetration [m]; negative: a gap
};

/// Collision detection between bodies: Bullet's hulls, GJK, separating axes (SAT) and clipping,
/// called directly, without a persistent contact manifold, so that the same poses give the same
/// points; and with the static mesh: signed distances of its points to the body's surface.
class Collider {
 public:
  /// `upright` are the same bodies; they must outlive the collider.
  Collider(const std::vector<WorldBody>& bodies, const std::vector<UprightBody>& upright,
           const TriangleMesh& static_mesh_base, const WorldOptions& options);
  ~Collider();

  /// Whether a body's mesh spans a volume.
  [[nodiscard]] bool has_shape(std::size_t body) const;
  /// Radius of a body's hulls about the vertical through its centre of mass [m].
  [[nodiscard]] double reach(std::size_t body) const;

  static constexpr std::size_t kMaxPoints = 8;  ///< of two bodies: in the plane two a face suffice
  /// Points where `a` and `b` are closer than `margin` [m], the normal into `a`; appended.
  void between(std::size_t a, const PlanarState& planar_a, std::size_t b,
               const PlanarState& planar_b, double margin, std::vector<CollisionPoint>& points);
  /// Points where `a` is closer than kStaticMargin to the static mesh; appended. Found in
  /// the nearest pose of a grid of 0.25 mm and 2.5 mrad and extrapolated from there to first order:
  /// a scan's noise then does not shake a body in contact with it, and the result is reused in the
  /// next steps.
  void with_static(std::size_t a, const PlanarState& planar_a, std::vector<CollisionPoint>& points);
  /// Share of the motion of `a` between two states (0 to 1) in which no point of the static mesh
  /// gets deeper inside it than `max_scan_penetration`, or than it was.
  [[nodiscard]] double collision_free_share(std::size_t a, const PlanarState& before,
                                            const PlanarState& after);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr::detail
