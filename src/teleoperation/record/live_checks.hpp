// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/record/recorder.hpp"

namespace pcavr {

/// What `doctor` would say of the recording, while it is made: rates that fall, gaps, a force that
/// is not zero at rest, tags that are out of view. In the time of arrival; the same input gives the
/// same lines. Memory: a second of a force's samples.
class LiveChecks {
 public:
  LiveChecks(const std::vector<RecordedTopic>& topics, double start);

  /// A message of a topic that arrived at `t` [s], not before earlier ones.
  void on_message(std::size_t topic, double t, std::span<const std::uint8_t> payload);
  /// An image of a topic that was searched for the declared tags.
  void on_tags(std::size_t topic, double t, std::size_t count);
  /// Messages of a topic arrived up to `t` [s] and could not be kept: that is neither a gap nor a
  /// lower rate of the source.
  void on_dropped(std::size_t topic, double t, std::uint64_t count);
  /// Looks at the time that has passed; call it some times a second, when all messages that arrived
  /// up to `t` have been given.
  void on_time(double t);
  /// The warnings since the last call, one line each.
  [[nodiscard]] std::vector<std::string> take_warnings();

 private:
  struct Topic {
    BagTopic type;
    RecordRole role = RecordRole::other;
    std::uint64_t messages = 0;
    std::optional<double> last = {};    ///< [s]
    double first = 0.0;                 ///< [s]
    std::optional<double> rate = {};    ///< [Hz] of its first seconds, against which it is judged
    std::uint64_t window_messages = 0;  ///< in the current window
    bool is_silent = false;             ///< stated
    bool has_partial_window = false;    ///< it was silent at the window's begin
    std::optional<double> last_dropped = {};  ///< [s] of the last warning
    bool is_slow = false;                     ///< stated
    bool is_undecodable = false;              ///< stated
    std::optional<double> last_tags = {};  ///< [s] when tags were seen; first: when it was searched
    bool is_without_tags = false;          ///< stated
  };
  struct ForceSample {
    double t = 0.0;
    Eigen::Vector3d force;
  };

  void check_gap(Topic& topic, double t);
  void check_rate(Topic& topic, double window);
  void on_pose(double t, const Eigen::Vector3d& position);
  void on_wrench(const Topic& topic, double t, const Eigen::Vector3d& force);
  void warn(const Topic& topic, const std::string& text);

  std::vector<Topic> topics_;
  double start_;                           ///< [s]
  double window_begin_;                    ///< [s]
  std::optional<Eigen::Vector3d> p_rest_;  ///< where the tool has been since `rest_since_`
  double rest_since_ = 0.0;                ///< [s]
  bool has_tool_ = false;
  std::deque<ForceSample> forces_;
  bool is_force_stated_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace pcavr
