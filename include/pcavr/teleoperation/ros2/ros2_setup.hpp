// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/ros2/ros2_transport.hpp"

namespace pcavr {

/// A camera's topics; the tags in its images are those of `tags`.
struct Ros2Camera {
  Ros2Topic image;                  ///< sensor_msgs/msg/Image or CompressedImage
  Ros2Topic info;                   ///< sensor_msgs/msg/CameraInfo
  std::string frame = {};           ///< the camera's (z forward); empty: the image's frame_id
  std::filesystem::path tags = {};  ///< manifest whose markers are on the objects
};

/// The pose of an object of the scene, tracked by another program.
struct Ros2Object {
  std::string name;
  Ros2Topic topic;              ///< geometry_msgs/msg/PoseStamped
  double position_std = 0.001;  ///< [m]
};

/// Topics that a site publishes what is predicted on, besides /tf.
struct Ros2Publication {
  DdsOptions dds = {};
  std::string base_frame = "base_link";
  std::string prefix = "/pcavr";  ///< of the topics: a name with leading slash
  double rate = 50.0;             ///< [Hz]
};

/// Topics that `pcavr robot-site --ros2 FILE` subscribes and publishes; docs/ros2.md describes the
/// file.
struct Ros2Setup {
  DdsOptions dds;
  std::string base_frame = "base_link";
  double start_timeout = 10.0;    ///< [s] for the tool's first pose
  double silence_timeout = 0.25;  ///< [s] without the tool's pose: nothing is commanded
  Ros2Topic tool;  ///< geometry_msgs/msg/PoseStamped, or sensor_msgs/msg/JointState with a URDF
  std::filesystem::path tool_urdf = {};  ///< of the joints; empty: `tool` has poses
  std::string tool_link = {};            ///< of the URDF, at the tip
  std::string tool_frame = {};  ///< of the axes of `tool`'s orientation; empty: none has that name
  std::optional<Ros2Topic> wrench = {};  ///< geometry_msgs/msg/WrenchStamped
  std::string wrench_frame = {};         ///< in place of the messages' frame_id, if not empty
  bool is_wrench_on_tool = false;        ///< the wrench acts on the tool; false: the tool exerts it
  std::optional<Ros2Topic> transforms = {};         ///< tf2_msgs/msg/TFMessage
  std::optional<Ros2Topic> static_transforms = {};  ///< the same
  std::vector<Ros2Object> objects = {};
  std::optional<Ros2Camera> camera = {};
  /// geometry_msgs/msg/PoseStamped or trajectory_msgs/msg/JointTrajectory; nothing: only watches.
  std::optional<Ros2Topic> command = {};
  bool is_command_of_joints = false;   ///< a trajectory, by `tool_urdf`
  double command_time = 0.02;          ///< [s] from a trajectory's stamp to its point
  bool follows_orientation = false;    ///< of the commands; false: the tool's stays as at the start
  double max_command_rotation = 0.5;   ///< [rad/s] of the tool, where it follows the commands'
  double command_rate = 500.0;         ///< [Hz]
  double max_command_distance = 0.05;  ///< [m] from the measured tip: a farther one is withheld
  std::optional<Ros2Publication> publication = {};  ///< nothing: not published
};

/// Reads a setup. An Error for unknown keys, values out of range and names that are not topics.
[[nodiscard]] Expected<Ros2Setup> parse_ros2_setup(const std::string& text,
                                                   const std::filesystem::path& file);
[[nodiscard]] Expected<Ros2Setup> read_ros2_setup(const std::filesystem::path& file);
/// Of such a file, or of one without a robot's topics, what a site publishes; an Error if nothing.
[[nodiscard]] Expected<Ros2Publication> read_ros2_publication(const std::filesystem::path& file);

}  // namespace pcavr
