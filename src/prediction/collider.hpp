// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pcavr/friction/planar_slider.hpp"
#include "pcavr/prediction/predicted_world.hpp"

namespace pcavr::detail {

/// Where two things touch, or nearly do.
struct CollisionPoint {
  Eigen::Vector3d p_base = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< into the first thing, base axes
  double depth = 0.0;                                 ///< [m]; negative: a gap
};

/// Finds where bodies touch each other and the static mesh: Bullet's hulls, tree, GJK, separating
/// axes and clipping, called one by one, so that nothing of an earlier call is kept and the same
/// poses give the same points. What is mostly level, the support above all, does not count.
class Collider {
 public:
  Collider(const std::vector<WorldBody>& bodies, const TriangleMesh& static_mesh_base);
  ~Collider();

  /// Whether a body's mesh spans a volume.
  [[nodiscard]] bool has_shape(std::size_t body) const;
  /// Of a body's hulls about the vertical through its centre of mass [m].
  [[nodiscard]] double reach(std::size_t body) const;

  static constexpr std::size_t kMaxPoints = 8;
  /// Points where `a` and `b` are closer than `margin` [m], the normal into `a`; appended.
  void between(std::size_t a, const PlanarState& planar_a, std::size_t b,
               const PlanarState& planar_b, double margin, std::vector<CollisionPoint>& points);
  /// Points where `a` is closer than kStaticMargin to the static mesh; appended. Searched for in
  /// the nearest pose of a grid of 0.25 mm and 2.5 mrad and carried from there to first order: a
  /// scan's noise then does not shake a body that leans on it, and what was found is good for the
  /// next steps, too.
  void with_static(std::size_t a, const PlanarState& planar_a, std::vector<CollisionPoint>& points);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr::detail
