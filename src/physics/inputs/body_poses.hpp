// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/input_series.hpp"
#include "pcavr/physics/inputs/touch.hpp"

namespace pcavr {

/// The bodies' poses over time: by tracking, else by the displacements of earlier pushes. Keeps
/// references to its arguments.
class BodyPoses {
 public:
  BodyPoses(const std::vector<InputBody>& bodies, const std::vector<BodySurface>& surfaces)
      : bodies_(bodies), surfaces_(surfaces), steps_(bodies.size()) {}

  [[nodiscard]] Pose at(std::size_t body, double t) const;
  [[nodiscard]] const BodySurface& surface(std::size_t body) const { return surfaces_[body]; }
  [[nodiscard]] bool is_tracked(std::size_t body) const { return !bodies_[body].tracked.empty(); }
  /// Adds the displacement by a push; only for a body that is not tracked.
  void displace(std::size_t body, double t, const Eigen::Vector3d& displacement_base);
  [[nodiscard]] Touch touch(std::size_t body, double t, const Eigen::Vector3d& p_base_tip,
                            double tool_radius) const;

 private:
  struct Step {
    double t;
    Eigen::Vector3d total_base;
  };
  const std::vector<InputBody>& bodies_;
  const std::vector<BodySurface>& surfaces_;
  std::vector<std::vector<Step>> steps_;
};

}  // namespace pcavr
