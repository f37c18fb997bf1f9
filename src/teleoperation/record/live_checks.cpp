// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "live_checks.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace pcavr {
namespace {

// As `doctor` judges a bag's topics: log times are those of messages that arrive.
constexpr double kMinGap = 0.5;         // [s]
constexpr double kMinIntervals = 10.0;  // [mean intervals]
constexpr double kFirstMessage = 3.0;   // [s] until a topic without any is named
constexpr double kRateTime = 3.0;       // [s] of the rate against which later ones are judged
constexpr double kWindow = 2.0;         // [s] over which a rate is taken
constexpr double kMinRate = 5.0;        // [Hz] a slower topic has too few messages in a window
constexpr double kSlow = 0.7;           // of the rate that it had
// As `doctor` judges the force at rest.
constexpr double kMaxRestForce = 1.0;  // [N]
constexpr double kRestTime = 1.0;      // [s] that tool and force stand still
constexpr double kRestMotion = 5e-4;   // [m] of a tool that stands still, by its noise
constexpr double kMaxScatter = 0.5;    // [N] of a force on nothing that moves
constexpr std::size_t kMinForces = 10;
constexpr std::size_t kMaxForces = 10'000;         // of a peer that floods
constexpr double kDropTime = 10.0;                 // [s] between two warnings of drops
constexpr double kTagTime = 5.0;                   // [s] without a tag
constexpr std::size_t kMaxWaitingWarnings = 1000;  // that nobody has taken

bool may_pause(RecordRole role) {
  return role == RecordRole::transforms || role == RecordRole::camera_info;
}

}  // namespace

LiveChecks::LiveChecks(const std::vector<RecordedTopic>& topics, double start)
    : start_(start), window_begin_(start) {
  for (const RecordedTopic& recorded : topics) {
    Topic& topic = topics_.emplace_back();
    topic.type = {.name = recorded.name,
                  .type = recorded.type,
                  .encoding = "cdr",
                  .schema_encoding = {},
                  .schema = {}};
    topic.role = recorded.role;
    has_tool_ = has_tool_ || recorded.role == RecordRole::tool;
  }
}

void LiveChecks::on_message(std::size_t index, double t, std::span<const std::uint8_t> payload) {
  Topic& topic = topics_.at(index);
  if (topic.messages++ == 0) topic.first = t;
  if (topic.is_silent) {
    if (topic.last) warn(topic, fmt::format("messages again after {:.1f} s", t - *topic.last));
    topic.is_silent = false;
    topic.has_partial_window = true;
  }
  topic.last = t;
  ++topic.window_messages;
  if (!topic.rate && t - topic.first >= kRateTime) {
    topic.rate = static_cast<double>(topic.messages - 1) / (t - topic.first);
  }
  const bool is_pose =
      topic.role == RecordRole::tool && ros_message_kind(topic.type.type) == RosMessageKind::pose;
  if (!is_pose && topic.role != RecordRole::wrench) return;
  const Expected<RosMessage> message = decode_ros_message(topic.type, payload);
  if (!message) {
    if (!std::exchange(topic.is_undecodable, true)) warn(topic, message.error().message);
    return;
  }
  if (const auto* pose = std::get_if<RosPose>(&*message)) on_pose(t, pose->position);
  if (const auto* wrench = std::get_if<RosWrench>(&*message)) on_wrench(topic, t, wrench->force);
}

void LiveChecks::on_pose(double t, const Eigen::Vector3d& position) {
  if (p_rest_ && (position - *p_rest_).norm() <= kRestMotion) return;
  p_rest_ = position;
  rest_since_ = t;
}

void LiveChecks::on_wrench(const Topic& topic, double t, const Eigen::Vector3d& force) {
  if (is_force_stated_) return;
  forces_.push_back({t, force});
  while (forces_.size() > kMaxForces || forces_.front().t < t - kRestTime) forces_.pop_front();
  const bool is_still = has_tool_ && p_rest_ && t - rest_since_ >= kRestTime;
  // Some tenths of a second less than the time of rest: the oldest sample lies inside it.
  const bool is_long = forces_.back().t - forces_.front().t >= 0.8 * kRestTime;
  if (!is_still || !is_long || forces_.size() < kMinForces) return;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ForceSample& sample : forces_) mean += sample.force;
  mean /= static_cast<double>(forces_.size());
  double scatter = 0.0;
  for (const ForceSample& sample : forces_) {
    scatter = std::max(scatter, (sample.force - mean).norm());
  }
  if (mean.norm() < kMaxRestForce || scatter > std::max(kMaxScatter, 0.2 * mean.norm())) return;
  is_force_stated_ = true;
  warn(topic, fmt::format("{:.2f} N while the tool rests (x {:.2f}, y {:.2f}, z {:.2f}): if it "
                          "touches nothing, set the sensor to zero, or import with --tare",
                          mean.norm(), mean.x(), mean.y(), mean.z()));
}

void LiveChecks::on_dropped(std::size_t index, double t, std::uint64_t count) {
  Topic& topic = topics_.at(index);
  topic.last = t;
  topic.has_partial_window = true;
  if (topic.last_dropped && t - *topic.last_dropped < kDropTime) return;
  topic.last_dropped = t;
  warn(topic, fmt::format("{} messages dropped: the disk is too slow", count));
}

void LiveChecks::on_tags(std::size_t index, double t, std::size_t count) {
  Topic& topic = topics_.at(index);
  if (count > 0) {
    if (std::exchange(topic.is_without_tags, false)) warn(topic, "tags are in view again");
    topic.last_tags = t;
    return;
  }
  if (!topic.last_tags) topic.last_tags = t;
  if (topic.is_without_tags || t - *topic.last_tags < kTagTime) return;
  topic.is_without_tags = true;
  warn(topic, fmt::format("no declared tag is in view for {:.0f} s", t - *topic.last_tags));
}

void LiveChecks::check_gap(Topic& topic, double t) {
  if (topic.is_silent || may_pause(topic.role)) return;
  // Said once, as a robot's description is.
  if (topic.role == RecordRole::other && topic.messages == 1) return;
  if (!topic.last) {
    if (t - start_ < kFirstMessage) return;
    topic.is_silent = true;
    return warn(topic, fmt::format("no message in {:.0f} s", t - start_));
  }
  const double interval =
      topic.messages > 1 ? (*topic.last - topic.first) / static_cast<double>(topic.messages - 1)
                         : kFirstMessage / kMinIntervals;
  if (t - *topic.last <= std::max(kMinGap, kMinIntervals * interval)) return;
  topic.is_silent = true;
  warn(topic, fmt::format("no message for {:.1f} s", t - *topic.last));
}

void LiveChecks::check_rate(Topic& topic, double window) {
  const double rate = static_cast<double>(std::exchange(topic.window_messages, 0)) / window;
  const bool is_partial = std::exchange(topic.has_partial_window, false);
  if (!topic.rate || *topic.rate < kMinRate || topic.is_silent || is_partial) return;
  const bool is_slow = rate < kSlow * *topic.rate;
  if (is_slow && !topic.is_slow) {
    warn(topic, fmt::format("{:.0f} Hz, at first {:.0f} Hz", rate, *topic.rate));
  }
  topic.is_slow = is_slow;
}

void LiveChecks::on_time(double t) {
  for (Topic& topic : topics_) check_gap(topic, t);
  const double window = t - window_begin_;
  if (window < kWindow) return;
  for (Topic& topic : topics_) check_rate(topic, window);
  window_begin_ = t;
}

void LiveChecks::warn(const Topic& topic, const std::string& text) {
  if (warnings_.size() < kMaxWaitingWarnings) warnings_.push_back(topic.type.name + ": " + text);
}

std::vector<std::string> LiveChecks::take_warnings() { return std::exchange(warnings_, {}); }

}  // namespace pcavr
