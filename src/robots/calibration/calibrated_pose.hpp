// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "robots/calibration/rig_fit.hpp"

namespace pcavr {

/// A pose with stds in a's axes; none along `unobservable`, a direction there.
[[nodiscard]] CalibratedPose calibrated(const Pose& T_a_b, const Matrix6d& covariance,
                                        const std::optional<Eigen::Vector3d>& unobservable);

/// The board at the frame of the given poses, from a fit of its best point [m] in that frame.
[[nodiscard]] CalibratedPose board_at_origin(
    const Rig& at_point, const Matrix6d& covariance, const Eigen::Vector3d& best_point,
    const std::optional<Eigen::Vector3d>& unobservable_world);

/// Moves the board's frame by `shift` in it, of HandEyeViews or RigViews.
template <typename View>
void move_board(const Eigen::Vector3d& shift, std::vector<View>& views) {
  const Pose T_board_point = Pose::from_translation(shift);
  for (View& view : views) view.T_camera_board = view.T_camera_board * T_board_point;
}

/// The views that one of the random splits fits, sorted, and those that it judges.
struct ViewSplit {
  std::vector<std::size_t> fitted, judged;
};
/// None where the views are too few for a judgement.
[[nodiscard]] std::vector<ViewSplit> view_splits(const std::vector<std::size_t>& views,
                                                 const HandEyeOptions& options);

}  // namespace pcavr
