// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/teleoperation/sites/picture_source.hpp"

namespace pcavr {

/// Samples that a robot has measured. Base frame, SI; times are seconds of the scene.
struct RobotSamples {
  struct Tool {
    double t = 0.0;
    Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
    Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  };
  struct Wrench {
    double t = 0.0;
    Eigen::Vector3d force_base = Eigen::Vector3d::Zero();   ///< that the tool exerts [N]
    Eigen::Vector3d torque_base = Eigen::Vector3d::Zero();  ///< about the tip [N m]
  };
  struct Tracked {
    std::size_t object = 0;  ///< index in the scene
    TrackedPose pose;
  };
  std::vector<Tool> tool;
  std::vector<Wrench> wrench;
  std::vector<Tracked> tracked;
  bool has_fault = false;  ///< a sample was no number, and is left out: the tool holds

  void clear() {
    has_fault = false;
    tool.clear();
    wrench.clear();
    tracked.clear();
  }
};

/// The robot of a robot's site: a recording, a simulated plant, a controller. Called once a cycle
/// from the site's thread; must not block.
class RobotInterface {
 public:
  virtual ~RobotInterface() = default;

  /// "recording", "plant", ...
  [[nodiscard]] virtual std::string name() const = 0;
  /// False if it moves as it was recorded, whatever is commanded.
  [[nodiscard]] virtual bool follows_commands() const = 0;
  /// Position at which the tip rests before the first command [m].
  [[nodiscard]] virtual Eigen::Vector3d p_base_start() const = 0;
  /// The setpoint of this cycle, within the site's limits.
  virtual void set_command(const Eigen::Vector3d& p_base_tip,
                           const Eigen::Quaterniond& q_base_tool) = 0;
  /// Appends what it has measured up to `t` [s] since the last call; each series ascends.
  virtual void advance(double t, RobotSamples& samples) = 0;
  /// Notices about the robot since the last call, a line each.
  [[nodiscard]] virtual std::vector<std::string> take_notices() { return {}; }
  /// [s] when it ends; nothing: it does not.
  [[nodiscard]] virtual std::optional<double> end() const { return std::nullopt; }
  /// The pictures of its camera; null: it has none. Called from a thread of its own.
  [[nodiscard]] virtual PictureSource* pictures() { return nullptr; }
};

}  // namespace pcavr
