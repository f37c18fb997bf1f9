// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/simulation/plant_case.hpp"

namespace pcavr {

/// Samples of the sensors of a live plant, with the noise of sensors.hpp. Base frame, SI; times are
/// seconds since the plant's start.
struct LivePlantSamples {
  struct Tool {
    double t = 0.0;
    Pose T_base_tool;
  };
  struct Wrench {
    double t = 0.0;
    Eigen::Vector3d force_base = Eigen::Vector3d::Zero();   ///< that the tool exerts [N]
    Eigen::Vector3d torque_base = Eigen::Vector3d::Zero();  ///< about the tip [N m]
  };
  struct Tracked {
    double t = 0.0;  ///< of the frame
    std::size_t body = 0;
    Pose T_base_object;
    double position_std = 0.0;  ///< [m], over all axes
    double rotation_std = 0.0;  ///< [rad]
    bool is_at_rest = false;
  };
  std::vector<Tool> tool;        ///< 500 Hz
  std::vector<Wrench> wrench;    ///< 500 Hz
  std::vector<Tracked> tracked;  ///< 30 Hz

  void clear();
};

/// The plant of run_plant, commanded step by step instead of by a list of moves: the same bodies,
/// arm, contact and sensors. Deterministic by seed and commands. Not thread-safe.
class LivePlant {
 public:
  static constexpr double kStep = 0.001;  ///< [s]

  /// The moves of `plant` are not used. Throws ContractError for numbers out of range.
  LivePlant(const PlantCase& plant, std::uint64_t seed);
  LivePlant(LivePlant&&) noexcept;
  LivePlant& operator=(LivePlant&&) noexcept;
  ~LivePlant();

  /// Advances by kStep while the arm's command goes to `p_base_command` [m] in a straight line;
  /// appends what was measured. A command that is not finite leaves the last one.
  void step(const Eigen::Vector3d& p_base_command, LivePlantSamples& samples);

  /// The plant and its clock stand still while the scene's time goes on by `steps` of kStep.
  void skip(long long steps);
  /// Makes run() grow from now on, by some 0.2 MB a second and body.
  void keep_run();

  [[nodiscard]] double t() const;  ///< [s], without what was skipped
  /// Whether the integration has not diverged; a plant that has stands still, and measures nothing.
  [[nodiscard]] bool is_finite() const;
  // Exact, without noise.
  [[nodiscard]] Eigen::Vector3d p_base_tip() const;
  [[nodiscard]] std::size_t size() const;
  [[nodiscard]] PlantBodyState body(std::size_t index) const;
  /// The run since keep_run(), with what was skipped, except for impacts, forces and torques.
  [[nodiscard]] PlantRun run() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
