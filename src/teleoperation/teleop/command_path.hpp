// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/tip_path.hpp"

#include "teleoperation/teleop/unrecorded_moves.hpp"

namespace pcavr {

/// The operator's command of a recording: the tip's path, sampled every `step` [s], without the
/// pose sensor's noise, which would be rendered as force: see smooth_motion. A live operator's
/// command has no such noise and needs none of this. Moves that were not recorded go over the
/// objects. Computed in blocks of some seconds.
class CommandPath {
 public:
  /// Keeps a reference; `tip` must outlive it and have two samples or more. `height_base` [m] is
  /// that at which the tip's centre passes over all objects.
  CommandPath(const TipPath& tip, double height_base, double start, double step);
  /// Position at start + step * cycle. Cheapest in ascending order.
  [[nodiscard]] Eigen::Vector3d at(std::size_t cycle);
  /// [m/s^2].
  [[nodiscard]] Eigen::Vector3d acceleration_at(std::size_t cycle);
  [[nodiscard]] const std::vector<UnrecordedMove>& unrecorded_moves() const { return unseen_; }

 private:
  void compute_block(std::size_t block);
  void go_over_objects(double first);

  const TipPath& tip_;
  double height_base_;
  std::vector<UnrecordedMove> unseen_;
  double start_;
  double step_;
  std::size_t block_ = ~std::size_t{0};
  std::vector<Eigen::Vector3d> path_;  ///< of the block's cycles
  std::vector<Eigen::Vector3d> acceleration_;
};

}  // namespace pcavr
