// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"

namespace pcavr::tracking {

/// Standard deviations of a node's pose, all axes combined.
struct NodeStd {
  double position = 0.0;  ///< [m]
  double rotation = 0.0;  ///< [rad]
};

/// Four corners of a base tag in one image.
struct CornerFactor {
  std::size_t node = 0;
  Pose T_node_color;  ///< pose of the colour camera in the node
  std::array<Eigen::Vector3d, 4> p_base;
  std::array<Eigen::Vector2d, 4> rays;  ///< undistorted, on the plane z = 1
  /// Derivatives of the lens distortion at the rays: convert small offsets on z = 1 to distorted
  /// ones.
  std::array<Eigen::Matrix2d, 4> lens_jacobians = {
      Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity(),
      Eigen::Matrix2d::Identity()};
  double focal_length = 0.0;  ///< [px]
  double corner_std = 0.0;    ///< of one coordinate [px]
};

/// Pose graph of camera poses in base: relative poses, tag corners and pose priors, solved as one
/// nonlinear least-squares problem [Grisetti et al. 2010] with robust losses. Deterministic.
class PoseGraph {
 public:
  /// `max_nodes`: capacity; add_node throws ContractError beyond it.
  explicit PoseGraph(std::size_t max_nodes);
  ~PoseGraph();
  PoseGraph(PoseGraph&&) noexcept;

  [[nodiscard]] std::size_t add_node(const Pose& T_base_node);
  /// Adds an edge: a measured T_a_b; `information` is of T_a_b * exp([v; w]).
  void add_link(std::size_t a, std::size_t b, const Pose& T_a_b, const Matrix6d& information);
  void add_corners(const CornerFactor& corners);
  /// Adds a measured T_base_node (pose prior).
  void add_prior(std::size_t node, const Pose& T_base_node, double position_std,
                 double rotation_std);

  void solve();

  /// Scatter of the priors about the solution over that by their standard deviations, without
  /// outliers; at least 1. `gauges`: rigid parts of the graph, each of which follows its
  /// priors as a whole. 1 where all errors together are within chance (3 std).
  [[nodiscard]] double prior_scatter(std::size_t gauges) const;
  /// Multiplies the standard deviations of all priors.
  void scale_priors(double factor);

  [[nodiscard]] const Pose pose(std::size_t node) const;
  /// Standard deviations from the covariance at the solution; nothing for an undetermined node.
  [[nodiscard]] std::vector<std::optional<NodeStd>> node_stds(
      const std::vector<std::size_t>& nodes) const;
  /// Reprojection errors of the corners [px]; infinite behind the camera.
  [[nodiscard]] std::array<double, 4> corner_errors(const CornerFactor& corners) const;

 private:
  struct Problem;
  std::unique_ptr<Problem> problem_;
};

}  // namespace pcavr::tracking
