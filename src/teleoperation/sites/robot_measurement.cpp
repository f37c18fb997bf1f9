// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "robot_measurement.hpp"

#include <cmath>
#include <vector>

#include "pcavr/base/core/caught.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxUnsensed = 2000;  // commands: of a robot that gives no samples
constexpr double kSameTime = 1e-9;          // [s]

bool is_finite(const RobotSamples::Tool& tool) {
  return std::isfinite(tool.t) && tool.p_base_tip.allFinite() &&
         tool.q_base_tool.coeffs().allFinite();
}

bool is_finite(const RobotSamples::Wrench& wrench) {
  return std::isfinite(wrench.t) && wrench.force_base.allFinite() && wrench.torque_base.allFinite();
}

bool is_finite(const RobotSamples::Tracked& tracked) {
  const TrackedPose& pose = tracked.pose;
  return std::isfinite(pose.t) && pose.T_base_object.translation().allFinite() &&
         pose.T_base_object.rotation().coeffs().allFinite() && std::isfinite(pose.position_std) &&
         std::isfinite(pose.rotation_std);
}

/// True if there was one.
template <typename Sample>
bool erase_faulty(std::vector<Sample>& samples) {
  return std::erase_if(samples, [](const Sample& sample) { return !is_finite(sample); }) > 0;
}

}  // namespace

/// A robot may report anything: a simulation that diverges, a controller's uninitialised memory.
void RobotMeasurement::leave_out_faulty() {
  samples_.has_fault |= erase_faulty(samples_.tool);
  samples_.has_fault |= erase_faulty(samples_.wrench);
  samples_.has_fault |= erase_faulty(samples_.tracked);
}

void RobotMeasurement::advance(double now, double start, RobotInterface& robot, LiveRobotSite& site,
                               SiteLog& log) {
  samples_.clear();
  const auto measured = caught([&] {
    robot.advance(now - start, samples_);
    return true;
  });
  failure_.reset();
  if (!measured) failure_ = measured.error();
  leave_out_faulty();
  site.set_arrival(now - start);
  for (const RobotSamples::Tool& tool : samples_.tool) {
    response_.add_tip(tool.t, tool.p_base_tip);
    site.add_tool(tool.t, tool.p_base_tip, tool.q_base_tool);
    tool_ = tool;
    log.on_tool(start + tool.t, tool);
  }
  for (const RobotSamples::Wrench& wrench : samples_.wrench) {
    response_.add_force(wrench.t, wrench.force_base);
    site.add_wrench(wrench.t, wrench.force_base);
    force_base_ = wrench.force_base;
    torque_base_ = wrench.torque_base;
    log.on_wrench(start + wrench.t, wrench);
  }
  for (const RobotSamples::Tracked& tracked : samples_.tracked) {
    site.add_tracked(tracked.object, tracked.pose);
    if (tracked_.size() <= tracked.object) tracked_.resize(tracked.object + 1);
    tracked_[tracked.object] = tracked.pose;
    log.on_tracked(start + tracked.pose.t, tracked);
  }
}

/// A sample at `t` contains nothing of a command that became the setpoint later.
void RobotMeasurement::sense(double t) {
  for (; !unsensed_.empty(); unsensed_.pop_front()) {
    const bool is_sensed = unsensed_.front().applied <= t + kSameTime;
    if (!is_sensed && unsensed_.size() <= kMaxUnsensed) return;
    if (is_sensed) sensed_ = unsensed_.front();
  }
}

void RobotMeasurement::describe(double now, std::optional<double> start, const LiveRobotSite& site,
                                LinkState& state) {
  state.t = start ? *start + tool_.t : now;
  sense(state.t);
  state.executed = sensed_.t;
  state.received = sensed_.received;
  state.applied = sensed_.applied;
  state.p_base_tip = tool_.p_base_tip.cast<float>();
  state.q_base_tool = tool_.q_base_tool.cast<float>();
  state.force_base = force_base_.cast<float>();
  state.torque_base = torque_base_.cast<float>();
  state.tool_response = response_.value().value_or(TipResponse{});
  for (std::size_t i = 0; i < site.objects(); ++i) {
    LinkTrackedObject& object = state.objects.emplace_back();
    object.phase = site.phase(i);
    if (i >= tracked_.size() || !tracked_[i]) continue;
    object.is_tracked = true;
    object.position = tracked_[i]->T_base_object.translation().cast<float>();
    object.orientation = tracked_[i]->T_base_object.rotation().cast<float>();
    object.position_std = static_cast<float>(tracked_[i]->position_std);
    object.age = static_cast<float>(now - *start - tracked_[i]->t);
  }
}

}  // namespace pcavr
