// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "ros2_intake.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/input_ranges.hpp"

namespace pcavr {
namespace {

constexpr double kOffsetWindow = 10.0;         // [s]: clocks drift by some 1e-5
constexpr double kMaxDelay = 1.0;              // [s] of a message of a known clock
constexpr double kMinSampleInterval = 2e-4;    // [s]: 5 kHz, above what robots publish
constexpr double kNoticeInterval = 30.0;       // [s]
constexpr std::size_t kMaxNoticeLines = 1000;  // peers choose the names in them
constexpr std::size_t kMaxLine = 300;          // [bytes]
constexpr std::size_t kMaxFrameName = 255;     // [bytes]
constexpr double kRotationStd = 0.01;          // [rad] of a tracker that states none
constexpr Duration kTransformHistory = std::chrono::seconds(2);

using Role = Ros2Subscription::Role;

void store(const Eigen::Vector3d& v, std::array<double, 7>& values, std::size_t at) {
  for (int i = 0; i < 3; ++i) values[at + static_cast<std::size_t>(i)] = v[i];
}

void store(const Pose& pose, std::array<double, 7>& values) {
  store(pose.translation(), values, 0);
  const Eigen::Quaterniond& q = pose.rotation();
  store(q.vec(), values, 3);
  values[6] = q.w();
}

bool is_in_range(const Eigen::Vector3d& p) {
  return ranges::kCoordinate.contains(p.x()) && ranges::kCoordinate.contains(p.y()) &&
         ranges::kCoordinate.contains(p.z());
}

}  // namespace

double StampOffset::local(double stamp, double now) {
  const double difference = now - stamp;
  if (offset_ && difference - *offset_ > kMaxDelay) {
    offset_.reset();
    ++steps_;
  }
  if (!offset_) {
    offset_ = window_ = difference;
    window_end_ = now + kOffsetWindow;
  }
  window_ = std::min(window_, difference);
  offset_ = std::min(*offset_, difference);
  if (now >= window_end_) {
    offset_ = std::exchange(window_, difference);
    window_end_ = now + kOffsetWindow;
  }
  return stamp + *offset_;
}

bool StampOffset::has_plausible(double stamp, double now) const {
  return offset_ && std::abs(now - stamp - *offset_) < kMaxDelay;
}

void Ros2Notices::add(const std::string& text, double now) {
  const std::string line = text.substr(0, kMaxLine);
  const std::lock_guard lock(mutex_);
  if (next_.size() >= kMaxNoticeLines && !next_.contains(line)) return;
  double& next = next_.try_emplace(line, now).first->second;
  if (now < next) return;
  next = now + kNoticeInterval;
  queue_.push({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, {});
}

Ros2Intake::Ros2Intake(const Ros2Setup& setup, std::vector<std::size_t> objects,
                       RecordQueue& samples, Ros2Notices& notices)
    : setup_(setup),
      subscriptions_(subscriptions_of(setup)),
      objects_(std::move(objects)),
      samples_(samples),
      notices_(notices),
      last_(subscriptions_.size()),
      transforms_(kTransformHistory),
      offsets_(subscriptions_.size()) {}

void Ros2Intake::on_message(std::size_t topic, std::span<const std::uint8_t> message, double now) {
  const Ros2Subscription& subscription = subscriptions_.at(topic);
  if (subscription.role == Role::image || subscription.role == Role::camera_info) {
    if (pictures_) pictures_(topic, subscription.role == Role::image, message, now);
    return;
  }
  const BagTopic type{.name = subscription.topic.name,
                      .type = subscription.topic.type,
                      .encoding = "cdr",
                      .schema_encoding = {},
                      .schema = {}};
  const Expected<RosMessage> decoded = decode_ros_message(type, message);
  if (!decoded) return note(topic, decoded.error().message + ": ignored", now);
  if (const auto* pose = std::get_if<RosPose>(&*decoded)) {
    if (subscription.role == Role::object) return on_object(topic, *pose, now);
    const std::optional<Pose> T_base_tool = in_base(topic, *pose, now);
    if (T_base_tool) on_tool(topic, *T_base_tool, pose->header.stamp, now);
    return;
  }
  if (const auto* state = std::get_if<RosJointState>(&*decoded)) {
    return on_joints(topic, *state, now);
  }
  if (const auto* wrench = std::get_if<RosWrench>(&*decoded)) return on_wrench(topic, *wrench, now);
  if (const auto* transforms = std::get_if<RosTransforms>(&*decoded)) {
    if (transforms->left_out > 0) note(topic, "has transforms that are none: ignored", now);
    on_transforms(*transforms, is_static_tf(subscription.topic.name));
  }
}

std::optional<Pose> Ros2Intake::lookup(const std::string& frame, std::optional<Stamp> stamp) {
  if (frame.empty() || frame == setup_.base_frame) return Pose();
  const std::lock_guard lock(mutex_);
  const auto chain = transforms_.chain(setup_.base_frame, frame);
  if (!chain) return std::nullopt;
  return transforms_.lookup(*chain, stamp.value_or(Stamp()));
}

double Ros2Intake::local_time(std::size_t topic, const std::optional<Stamp>& stamp, double now) {
  if (!stamp) {
    note(topic, "has no stamps: the times of arrival are used", now);
    return now;
  }
  const std::lock_guard lock(mutex_);
  const double seconds = stamp->seconds();
  StampOffset& own = offsets_[topic];
  const bool is_tool = subscriptions_[topic].role == Role::tool;
  if (is_tool || (!own.is_known() && offset_.has_plausible(seconds, now))) {
    const std::size_t steps = offset_.steps();
    const double t = offset_.local(seconds, now);
    if (offset_.steps() != steps) note(topic, "stamps went back: the clock was set", now);
    return t;
  }
  if (!own.is_known()) {
    note(topic,
         fmt::format("stamps are of another clock than those of {}: the fastest message "
                     "shows its offset",
                     setup_.tool.name),
         now);
  }
  return own.local(seconds, now);
}

std::optional<Pose> Ros2Intake::in_base(std::size_t topic, const RosPose& pose, double now) {
  const std::optional<Pose> T_base_frame = lookup(pose.header.frame, pose.header.stamp);
  if (!T_base_frame) {
    note(topic,
         fmt::format("frame {} is not {}, and no transforms connect them: ignored",
                     pose.header.frame, setup_.base_frame),
         now);
    return std::nullopt;
  }
  const Eigen::Quaterniond q = pose.orientation.value_or(Eigen::Quaterniond::Identity());
  const Pose T_base_body = *T_base_frame * Pose(q.normalized(), pose.position);
  if (is_in_range(T_base_body.translation())) return T_base_body;
  note(topic, "position is beyond 10 km: ignored", now);
  return std::nullopt;
}

bool Ros2Intake::advances(std::size_t topic, double t) {
  std::optional<double>& last = last_[topic];
  if (last && t < *last + kMinSampleInterval) return false;
  last = t;
  return true;
}

void Ros2Intake::on_joints(std::size_t topic, const RosJointState& state, double now) {
  if (!joints_) return;
  const Expected<Pose> T_base_tool = joints_->T_base_tool(state);
  if (!T_base_tool) return note(topic, T_base_tool.error().message + ": ignored", now);
  if (!is_in_range(T_base_tool->translation())) {
    return note(topic, "position is beyond 10 km: ignored", now);
  }
  on_tool(topic, *T_base_tool, state.header.stamp, now);
}

void Ros2Intake::on_tool(std::size_t topic, const Pose& T_base_tool,
                         const std::optional<Stamp>& stamp, double now) {
  const double t = local_time(topic, stamp, now);
  if (!advances(topic, t)) return;
  tool_ = Tool{T_base_tool, now};
  Ros2Sample sample{.kind = Ros2Sample::Kind::tool, .t = t};
  store(T_base_tool, sample.values);
  push(sample);
}

void Ros2Intake::on_wrench(std::size_t topic, const RosWrench& wrench, double now) {
  if (!tool_) return;
  const std::string& frame =
      setup_.wrench_frame.empty() ? wrench.header.frame : setup_.wrench_frame;
  // The sensor's frame, or the tool's, whose pose is known without transforms.
  const std::optional<Pose> T_base_frame = !setup_.tool_frame.empty() && frame == setup_.tool_frame
                                               ? std::optional(tool_->T_base_tool)
                                               : lookup(frame, wrench.header.stamp);
  if (!T_base_frame) {
    return note(topic,
                fmt::format("frame {} is neither {} nor the tool's, and no transforms "
                            "connect them: ignored",
                            frame, setup_.base_frame),
                now);
  }
  const double sign = setup_.is_wrench_on_tool ? -1.0 : 1.0;
  const Eigen::Vector3d force = sign * (T_base_frame->rotation() * wrench.force);
  Eigen::Vector3d torque = sign * (T_base_frame->rotation() * wrench.torque);
  if (frame != setup_.base_frame && !frame.empty()) {  // from the sensor's origin to the tip
    torque += (T_base_frame->translation() - tool_->T_base_tool.translation()).cross(force);
  }
  if (!ranges::kForce.contains(force.norm()) || !ranges::kTorque.contains(torque.norm())) {
    return note(topic, "exceeds 100 kN or kN m: ignored", now);
  }
  const double t = local_time(topic, wrench.header.stamp, now);
  if (!advances(topic, t)) return;
  Ros2Sample sample{.kind = Ros2Sample::Kind::wrench, .t = t};
  store(force, sample.values, 0);
  store(torque, sample.values, 3);
  push(sample);
}

void Ros2Intake::on_object(std::size_t topic, const RosPose& pose, double now) {
  if (!tool_) return;
  const std::optional<Pose> T_base_object = in_base(topic, pose, now);
  if (!T_base_object) return;
  const double t = local_time(topic, pose.header.stamp, now);
  if (!advances(topic, t)) return;
  const std::size_t object = subscriptions_[topic].object;
  Ros2Sample sample{.kind = Ros2Sample::Kind::tracked, .object = objects_[object], .t = t};
  store(*T_base_object, sample.values);
  sample.std = {setup_.objects[object].position_std, kRotationStd};
  push(sample);
}

void Ros2Intake::on_transforms(const RosTransforms& transforms, bool is_static) {
  const std::lock_guard lock(mutex_);
  for (const RosTransform& transform : transforms.transforms) {
    const bool is_usable = is_in_range(transform.translation) &&
                           transform.header.frame.size() <= kMaxFrameName &&
                           transform.child_frame.size() <= kMaxFrameName;
    if (!is_usable) continue;
    const Pose pose(transform.rotation.normalized(), transform.translation);
    const Stamp stamp = transform.header.stamp.value_or(Stamp());
    if (is_static)
      transforms_.add_static(transform.header.frame, transform.child_frame, stamp, pose);
    else
      transforms_.add(transform.header.frame, transform.child_frame, stamp, pose);
  }
}

void Ros2Intake::push(const Ros2Sample& sample) {
  samples_.push({reinterpret_cast<const std::uint8_t*>(&sample), sizeof(sample)}, {});
}

void Ros2Intake::note(std::size_t topic, const std::string& text, double now) {
  notices_.add(subscriptions_[topic].topic.name + ": " + text, now);
}

}  // namespace pcavr
