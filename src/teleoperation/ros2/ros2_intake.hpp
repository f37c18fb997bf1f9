// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/record_queue.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/recordings/rosbag/transform_tree.hpp"
#include "pcavr/teleoperation/ros2/ros2_setup.hpp"

#include "ros2_joints.hpp"

namespace pcavr {

/// A sample on its way to the site's thread. Base frame, SI; `t` is CLOCK_BOOTTIME [s].
struct Ros2Sample {
  enum class Kind : std::uint64_t { tool, wrench, tracked };
  Kind kind = Kind::tool;
  std::uint64_t object = 0;  ///< of a tracked pose
  double t = 0.0;            ///< when it was measured
  /// Position and quaternion x y z w; or force and torque.
  std::array<double, 7> values{};
  std::array<double, 2> std{};  ///< of a tracked pose: position [m], rotation [rad]
};

/// When messages were measured, by the local clock: the offset between it and the peers' clock is
/// that of the messages that arrived fastest.
class StampOffset {
 public:
  /// The local time of a stamp [s] of a message that arrived at `now` [s].
  double local(double stamp, double now);
  /// Whether `stamp` may be of this clock: arrived at `now` within a second after it.
  [[nodiscard]] bool has_plausible(double stamp, double now) const;
  [[nodiscard]] bool is_known() const { return offset_.has_value(); }
  /// Times it was set anew, because the peer's clock was set.
  [[nodiscard]] std::size_t steps() const { return steps_; }

 private:
  std::optional<double> offset_;  ///< [s] local less peer's: the least since two windows
  double window_ = 0.0;           ///< [s] the least in the current window
  double window_end_ = 0.0;       ///< [s]
  std::size_t steps_ = 0;
};

/// Lines for the user, each at once and then at most every 30 s.
class Ros2Notices {
 public:
  explicit Ros2Notices(RecordQueue& queue) : queue_(queue) {}
  void add(const std::string& text, double now);

 private:
  std::mutex mutex_;  ///< of the reading and the camera's thread
  RecordQueue& queue_;
  std::map<std::string, double> next_;  ///< [s] by line
};

/// Takes the messages of peers, which are not trusted: decodes and checks them, brings them to the
/// base frame and the local clock, and passes them on through `samples`. Called from the reading
/// thread, except where stated.
class Ros2Intake {
 public:
  /// `objects`: by Ros2Setup::objects, the index in the scene.
  Ros2Intake(const Ros2Setup& setup, std::vector<std::size_t> objects, RecordQueue& samples,
             Ros2Notices& notices);

  /// Takes images and camera infos of a topic, as they are.
  using PictureSink = std::function<void(std::size_t topic, bool is_image,
                                         std::span<const std::uint8_t> message, double now)>;
  void set_picture_sink(PictureSink sink) { pictures_ = std::move(sink); }

  /// Gives the tool's pose where its topic has joint states.
  void set_joints(Ros2ToolJoints joints) { joints_ = std::move(joints); }
  /// Joint positions of the newest message; null where the tool has poses.
  [[nodiscard]] const Eigen::VectorXd* joint_positions() const {
    return joints_ ? &joints_->q() : nullptr;
  }

  /// A message of subscriptions_of()[topic] that arrived at `now` [s].
  void on_message(std::size_t topic, std::span<const std::uint8_t> message, double now);

  [[nodiscard]] const Ros2Topic& topic(std::size_t index) const {
    return subscriptions_[index].topic;
  }
  /// Notes a text on a topic for the user. Any thread.
  void note(std::size_t topic, const std::string& text, double now);

  struct Tool {
    Pose T_base_tool;
    double arrival = 0.0;  ///< [s]
  };
  [[nodiscard]] const std::optional<Tool>& tool() const { return tool_; }

  /// T_base_frame at a peer's stamp; nothing where it is not known. Any thread.
  [[nodiscard]] std::optional<Pose> lookup(const std::string& frame, std::optional<Stamp> stamp);
  /// The local time of a header's stamp. Any thread.
  [[nodiscard]] double local_time(std::size_t topic, const std::optional<Stamp>& stamp, double now);

 private:
  void on_joints(std::size_t topic, const RosJointState& state, double now);
  void on_tool(std::size_t topic, const Pose& T_base_tool, const std::optional<Stamp>& stamp,
               double now);
  void on_wrench(std::size_t topic, const RosWrench& wrench, double now);
  void on_object(std::size_t topic, const RosPose& pose, double now);
  void on_transforms(const RosTransforms& transforms, bool is_static);
  /// T_base_body of a pose in its header's frame.
  [[nodiscard]] std::optional<Pose> in_base(std::size_t topic, const RosPose& pose, double now);
  /// False for a stamp that is not newer than the last one of this topic, or too near to it.
  [[nodiscard]] bool advances(std::size_t topic, double t);
  void push(const Ros2Sample& sample);

  const Ros2Setup& setup_;
  std::vector<Ros2Subscription> subscriptions_;
  std::vector<std::size_t> objects_;
  RecordQueue& samples_;
  Ros2Notices& notices_;
  PictureSink pictures_;
  std::optional<Ros2ToolJoints> joints_;
  std::optional<Tool> tool_;
  std::vector<std::optional<double>> last_;  ///< [s] by topic: of the last sample
  std::mutex mutex_;                         ///< of what follows
  TransformTree transforms_;
  StampOffset offset_;                ///< of the tool's clock
  std::vector<StampOffset> offsets_;  ///< by topic: of those with another clock
};

}  // namespace pcavr
