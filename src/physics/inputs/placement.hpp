// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// Other interpretations of a body's mesh (its size times a factor) and of its poses (their unit).
inline constexpr std::size_t kMeshInterpretations = 8;
inline constexpr std::size_t kPoseInterpretations = 2;

/// Place and size of one body, compared with the tip's places when a force begins.
struct BodyPlacement {
  std::size_t touches = 0;  ///< contacts at its surface, as everything is written
  std::array<std::size_t, kMeshInterpretations> by_mesh = {};   ///< of the contacts elsewhere
  std::array<std::size_t, kPoseInterpretations> by_poses = {};  ///< the same
  bool is_tracked = false;
  double tilt = 0.0;               ///< [rad] range of the tracked orientation's vertical
  double tilt_if_w_first = 0.0;    ///< [rad] the same, with the quaternion's w written first
  double turn_at_start = 0.0;      ///< [rad] from the pose before to the first tracked one
  double turn_if_w_first = 0.0;    ///< [rad]
  double distance_at_start = 0.0;  ///< [m] between the same
  /// The body whose pose in the scene is nearest to this one's first tracked pose, and [m] how
  /// near.
  std::size_t nearest_at_start = 0;
  double nearest_distance = 0.0;
  // The contact in which this body moved the farthest of all while the tip was not at it.
  double moved_untouched = 0.0;  ///< [m]
  double gap_untouched = 0.0;    ///< [m] to the tip
  double t_untouched = 0.0;      ///< [s]
  /// [m] minimum distance between the tip's surface and the body's over all contacts.
  double min_distance = std::numeric_limits<double>::infinity();

  void add(const BodyPlacement& later);
};

struct BodyPlacements {
  std::size_t contacts = 0;   ///< with a force into the surface of one body, or at none
  std::size_t elsewhere = 0;  ///< those at no body's surface
  std::vector<BodyPlacement> bodies = {};

  void add(const BodyPlacements& later);
};

[[nodiscard]] BodyPlacements placement_of(const InputSeries& series,
                                          std::span<const Contact> contacts, const PathView& tip,
                                          const BodyPoses& poses);

/// A mesh of another size, poses in another unit or with another order of the quaternion, where
/// that explains at least two contacts, or the motion, and the data as written do not.
[[nodiscard]] std::optional<InputFault> placement_fault(const std::vector<InputBody>& bodies,
                                                        const BodyPlacements& placement);
/// Notes on data that do not fit together, without another interpretation that explains them.
[[nodiscard]] std::vector<std::string> placement_notes(const std::vector<InputBody>& bodies,
                                                       const BodyPlacements& placement);

/// Data that contradict each other: a body that moves in contacts elsewhere, tracks of two bodies
/// that seem exchanged.
[[nodiscard]] std::vector<std::string> placement_contradictions(
    const std::vector<InputBody>& bodies, const BodyPlacements& placement);

}  // namespace pcavr
