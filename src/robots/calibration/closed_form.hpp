// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "robots/calibration/rig.hpp"

namespace pcavr {

/// Motions between two views: that of the mount, and that of the camera as it sees the board. They
/// are one motion of one body: T_mount T_mount_camera = T_mount_camera T_camera.
struct MotionPair {
  Pose T_mount;   ///< of the later view's mount in the earlier one's
  Pose T_camera;  ///< of the later view's camera in the earlier one's
};
/// The motions between the views of these indices: each with each, or of many views each with
/// kMaxPartners others.
[[nodiscard]] std::vector<MotionPair> motion_pairs(const std::vector<RigView>& views,
                                                   const std::vector<std::size_t>& indices);

/// T_mount_camera with the board's scale, rotation first, then position [Park & Martin 1994].
/// nullopt where the motions have no rotation. `with_scale`: else the scale is 1.
[[nodiscard]] std::optional<Rig> solve_by_park(const std::vector<MotionPair>& pairs,
                                               bool with_scale);

/// Rotation and position at once, by dual quaternions [Daniilidis 1999]. nullopt where the motions
/// do not determine them.
[[nodiscard]] std::optional<Rig> solve_by_daniilidis(const std::vector<MotionPair>& pairs);

/// Puts the board where the views of these indices put it: mean rotation, median position.
void place_board(const std::vector<RigView>& views, const std::vector<std::size_t>& indices,
                 Rig& rig);

}  // namespace pcavr
