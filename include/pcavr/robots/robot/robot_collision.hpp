// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"
#include "pcavr/robots/robot/robot_model.hpp"

namespace pcavr {

/// A segment with a radius: all points within `radius` of it.
struct Capsule {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double radius = 0.0;  ///< [m]
};

/// A capsule of small volume that contains all points; nothing without points. Tried are the axes
/// of the frame and of the points' scatter. Pure function.
[[nodiscard]] std::optional<Capsule> enclosing_capsule(const std::vector<Eigen::Vector3f>& points);

/// The nearest two things of which one is a link of the robot.
struct NearestPair {
  double distance = 0.0;                  ///< [m] negative: the capsules overlap by so much
  std::size_t link = 0;                   ///< index as in RobotModel::links
  std::optional<std::size_t> other_link;  ///< for a distance of the robot to itself
  std::optional<std::size_t> surface;     ///< for one to a surface, in the order of add_surface
  Eigen::Vector3d p_base_link = Eigen::Vector3d::Zero();   ///< on the link's axis
  Eigen::Vector3d p_base_other = Eigen::Vector3d::Zero();  ///< on the surface, or the other's axis
};

/// Distances of a robot to itself and to triangle meshes: a scan, CAD bodies. Each link is the
/// capsule that encloses its mesh, so distances are never larger than those of the meshes.
///
/// Only pairs of links count that can get apart: not neighbours along the chain, and not those
/// whose capsules are less than 2 cm apart at the reference position. The links fixed to the base
/// count for the robot itself, not for surfaces (the scan contains them), and so do the links that
/// move with the tip: a tool has to touch things.
///
/// Frame: the robot's base. After the setup nothing allocates. Threads: one at a time per object.
class RobotCollision {
 public:
  /// `meshes` by link, in link frames (LinkMeshes::of_link); `q_reference` is a position without
  /// collision. Throws ContractError for wrong sizes.
  RobotCollision(const RobotModel& model, const std::vector<TriangleMesh>& meshes, std::size_t tip,
                 const Eigen::VectorXd& q_reference);
  RobotCollision(RobotCollision&&) noexcept;
  RobotCollision& operator=(RobotCollision&&) noexcept;
  ~RobotCollision();

  /// Adds a surface at its origin; returns its index. Builds a bounding volume hierarchy.
  std::size_t add_surface(const TriangleMesh& mesh);
  void place_surface(std::size_t surface, const Pose& T_base_surface);

  /// Sets the links' poses: of RobotDynamics::forward_kinematics.
  void place_links(const RobotDynamics& robot);

  /// The nearest pair of links; nothing if no pair counts.
  [[nodiscard]] std::optional<NearestPair> distance_to_itself() const noexcept;
  /// The nearest pair of a link and a surface within `reach` [m]; else nothing. Exact for the
  /// capsules. The nearest triangle of the previous call is tried first, which makes a call after a
  /// small motion fast.
  [[nodiscard]] std::optional<NearestPair> distance_to_surfaces(double reach) noexcept;

  /// The capsules of links that have one, in the base frame, for drawing and tests.
  [[nodiscard]] std::vector<std::pair<std::size_t, Capsule>> capsules() const;
  [[nodiscard]] std::size_t pairs() const;  ///< of links that count

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// The least distance of a segment to a triangle, and where; 0 if they intersect [Ericson 2005,
/// 5.1.9, 5.1.10]. Pure function.
struct SegmentDistance {
  double squared = 0.0;  ///< [m^2]
  Eigen::Vector3d on_segment;
  Eigen::Vector3d on_other;
};
[[nodiscard]] SegmentDistance segment_triangle_distance(
    const Eigen::Vector3d& a, const Eigen::Vector3d& b,
    const std::array<Eigen::Vector3d, 3>& corners) noexcept;
[[nodiscard]] SegmentDistance segment_segment_distance(const Eigen::Vector3d& a,
                                                       const Eigen::Vector3d& b,
                                                       const Eigen::Vector3d& c,
                                                       const Eigen::Vector3d& d) noexcept;

}  // namespace pcavr
