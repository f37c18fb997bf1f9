// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/geometry/pose.hpp"

namespace pcavr::tracking {

/// Standard deviations of a node's pose, all axes together.
struct NodeSigma {
  double position = 0.0;  ///< [m]
  double rotation = 0.0;  ///< [rad]
};

/// Four corners of a base tag in one image.
struct CornerFactor {
  std::size_t node = 0;
  Pose T_node_color;  ///< the camera that saw them, in the node
  std::array<Eigen::Vector3d, 4> p_base;
  std::array<Eigen::Vector2d, 4> rays;  ///< undistorted, on the plane z = 1
  /// What the lens makes of small offsets from the rays: with distortion, pixels are not of one
  /// size.
  std::array<Eigen::Matrix2d, 4> lens = {Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity(),
                                         Eigen::Matrix2d::Identity(), Eigen::Matrix2d::Identity()};
  double focal_length = 0.0;  ///< [px]
  double sigma = 0.0;         ///< of one coordinate [px]
};

/// Camera poses in base, and what was measured about them; solved as one non-linear least-squares
/// problem [Grisetti et al. 2010] with losses that let outliers go. Deterministic.
class PoseGraph {
 public:
  /// Holds at most so many nodes.
  explicit PoseGraph(std::size_t max_nodes);
  ~PoseGraph();
  PoseGraph(PoseGraph&&) noexcept;

  [[nodiscard]] std::size_t add_node(const Pose& T_base_node);
  /// T_a_b was measured; `information` is of T_a_b * exp([v; w]).
  void add_link(std::size_t a, std::size_t b, const Pose& T_a_b, const Matrix6d& information);
  void add_corners(const CornerFactor& corners);
  /// T_base_node was measured.
  void add_prior(std::size_t node, const Pose& T_base_node, double position_sigma,
                 double rotation_sigma);

  void solve();

  [[nodiscard]] const Pose pose(std::size_t node) const;
  /// From the covariance at the solution; nothing where the graph leaves a node undetermined.
  [[nodiscard]] std::vector<std::optional<NodeSigma>> sigmas(
      const std::vector<std::size_t>& nodes) const;
  /// Distances between seen and predicted corners [px]; infinite behind the camera.
  [[nodiscard]] std::array<double, 4> corner_errors(const CornerFactor& corners) const;

 private:
  struct Problem;
  std::unique_ptr<Problem> problem_;
};

}  // namespace pcavr::tracking
