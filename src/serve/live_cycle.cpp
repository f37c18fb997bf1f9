// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "live_cycle.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kMinTimeScale = 0.1;
/// [s] in which the tool's weight comes and goes with the clutch, so that the hand is not jerked.
constexpr double kWeightRiseTime = 0.2;

std::vector<std::string> names_of(const HapticWorld& world) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < world.size(); ++i) names.push_back(world.name(i));
  return names;
}

WorldSnapshot first_snapshot(const HapticWorld& world, const LiveArm* arm) {
  WorldSnapshot snapshot;
  snapshot.world = world.state();
  snapshot.speeds.assign(world.size(), 0.0);
  if (arm != nullptr) {
    snapshot.arm = arm->follower.state();
    snapshot.arm_meets_scan = arm->has_scan;
  }
  return snapshot;
}

std::uint32_t cycles_per_slice(double cycle) {
  PCAVR_REQUIRE(cycle > 0.0 && cycle <= 0.1, cycle);
  return static_cast<std::uint32_t>(std::lround(0.1 / cycle));
}

}  // namespace

LiveCycle::LiveCycle(HapticWorld world, std::unique_ptr<Device> device,
                     const LiveWorldOptions& options, std::unique_ptr<LiveArm> arm)
    : world_(std::move(world)),
      device_(std::move(device)),
      page_device_(dynamic_cast<RemoteDevice*>(device_.get())),
      arm_(std::move(arm)),
      options_(options),
      names_(names_of(world_)),
      pulses_(world_.size(), options.full_scale_force, options.vibration),
      histogram_(cycles_per_slice(options.cycle)),
      buffer_((world_.reset(options.p_base_tool_start), first_snapshot(world_, arm_.get()))),
      speeds_(world_.size(), 0.0) {
  PCAVR_REQUIRE(device_ != nullptr);
  command_.p_base_tip = options.p_base_tool_start;
  set_time_scale(options.time_scale);
  cycle_scale_ = time_scale();
  for (const HapticBodyState& body : world_.state().bodies) {
    positions_.push_back(body.T_base_object.translation());
  }
}

ToolCommand LiveCycle::command_from(const DeviceSample& sample, bool is_on_hold) noexcept {
  if (is_stopped()) must_open_ = true;
  if (!sample.is_present || !sample.is_engaged) {
    if (!is_stopped()) must_open_ = false;
    p_tip_offset_.setZero();
    return {world_.state().p_base_hip, false};
  }
  if (must_open_) return {world_.state().p_base_hip, false};
  if (!is_on_hold) return {sample.p_base_tip + p_tip_offset_, true};
  // A clutch that closes on hold does not engage the tool. The offset absorbs the device's motion
  // during the hold, so that the tool does not jump when it resumes.
  const Eigen::Vector3d frozen =
      command_.is_engaged ? command_.p_base_tip : world_.state().p_base_hip;
  p_tip_offset_ = frozen - sample.p_base_tip;
  return {frozen, command_.is_engaged};
}

/// The tool's motion as a robot with these limits can follow it.
ToolCommand LiveCycle::limited(ToolCommand wanted) noexcept {
  if (!limits_) return wanted;
  if (wanted.is_engaged) {
    if (!limiter_) limiter_.emplace(*limits_, world_.state().p_base_hip);
    wanted.p_base_tip = limiter_->step(wanted.p_base_tip, Eigen::Vector3d::Zero(), options_.cycle);
  } else if (limiter_ && !limiter_->v_base().isZero(0.0) && !is_stopped()) {
    wanted.p_base_tip = limiter_->step(std::nullopt, Eigen::Vector3d::Zero(), options_.cycle);
    wanted.is_engaged = true;
  } else {
    limiter_.reset();
  }
  return wanted;
}

void LiveCycle::reset_if_requested() noexcept {
  const std::uint32_t resets = resets_.load(std::memory_order_relaxed);
  const std::uint32_t undos = undos_.load(std::memory_order_relaxed);
  const bool is_reset = resets != resets_done_;
  const bool is_undone = undos != undos_done_ && world_.state().can_undo_reset;
  resets_done_ = resets;
  undos_done_ = undos;
  if (is_reset) {
    restart(options_.p_base_tool_start);
  } else if (is_undone) {
    world_.undo_reset(options_.p_base_tool_start);
    begin_anew();
  }
}

void LiveCycle::restart(const Eigen::Vector3d& p_base_tool) noexcept {
  world_.reset(p_base_tool);
  begin_anew();
}

void LiveCycle::begin_anew() noexcept {
  pulses_.reset();
  limiter_.reset();
  if (arm_) arm_->follower.reset();
  if (arm_ && arm_->driven) arm_->driven->reset(arm_->follower.state().q);
  command_.p_base_tip = world_.state().p_base_hip;
  p_tip_offset_ = command_.p_base_tip - sample_.p_base_tip;
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = world_.state().bodies[i].T_base_object.translation();
  }
}

void LiveCycle::set_time_scale(double scale) noexcept {
  if (!std::isfinite(scale)) return;
  time_scale_.store(std::clamp(scale, kMinTimeScale, 1.0), std::memory_order_relaxed);
}

/// The wrench on the hand: of the force at the tip and of the tool's weight, about the grip.
DeviceFeedback LiveCycle::feedback() noexcept {
  const HapticWorldState& state = world_.state();
  const HandToolOptions& tool = options_.tool;
  const double change = options_.cycle / kWeightRiseTime;
  weight_share_ = std::clamp(weight_share_ + (state.is_engaged ? change : -change), 0.0, 1.0);
  const Eigen::Vector3d force = cycle_scale_ * state.force_base;
  const Eigen::Vector3d weight(0.0, 0.0, -weight_share_ * tool.weight());
  const Eigen::Vector3d grip_to_tip = q_base_tool_ * Eigen::Vector3d(0.0, 0.0, tool.length);
  return {.p_base_tool = state.p_base_proxy,
          .force_base = force + weight,
          .pulse = pulses_.amplitude(),
          .torque_base = grip_to_tip.cross(force + tool.centre_share * weight)};
}

void LiveCycle::measure_speeds() noexcept {
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const Eigen::Vector3d& now = world_.state().bodies[i].T_base_object.translation();
    speeds_[i] = (now - positions_[i]).norm() / (options_.cycle * cycle_scale_);
    positions_[i] = now;
  }
}

void LiveCycle::move_arm(const Eigen::Vector3d& p_base_tip) noexcept {
  const Pose T_robot_base = arm_->T_base_robot.inverse();
  const std::size_t first_body = arm_->has_scan ? 1 : 0;
  const HapticWorldState& state = world_.state();
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    arm_->follower.place_surface(first_body + i, T_robot_base * state.bodies[i].T_base_object);
  }
  arm_->follower.follow(T_robot_base * p_base_tip, options_.cycle);
}

/// The follower's joints are the command of the torque-driven arm, on whose tip the tool's force
/// of the last cycle acts; returns its tip, in base.
Eigen::Vector3d LiveCycle::drive_arm() noexcept {
  move_arm(command_.p_base_tip);
  DrivenArm& arm = *arm_->driven;
  RobotDynamics& dynamics = arm.dynamics();
  dynamics.jacobian(arm.q(), arm_->tip, arm_->jacobian);
  const Eigen::Vector3d force_robot =
      arm_->T_base_robot.rotation().conjugate() * world_.state().force_base;
  arm_->external.noalias() = arm_->jacobian.topRows<3>().transpose() * force_robot;
  arm.step(arm_->follower.state().q, arm_->external, options_.cycle * cycle_scale_);
  dynamics.forward_kinematics(arm.q());
  return arm_->T_base_robot * dynamics.T_base_link(arm_->tip).translation();
}

void LiveCycle::step(double t) noexcept {
  const HapticWorldState& state = world_.state();
  sample_ = device_->exchange(t, options_.cycle, feedback());
  if (sample_.is_stop_pressed) emergency_stop();
  if (sample_.is_present) q_base_tool_ = sample_.q_base_tool;
  reset_if_requested();
  was_on_hold_ = is_on_hold_.load(std::memory_order_relaxed);
  command_ = limited(command_from(sample_, was_on_hold_));
  // Faster only while no force acts: else the hand would get back more energy than it put in.
  const double wanted = time_scale();
  if (wanted < cycle_scale_ || state.force_base.isZero(0.0)) cycle_scale_ = wanted;
  const bool is_driven = arm_ && arm_->driven;
  ToolCommand tool = command_;
  if (is_driven) tool.p_base_tip = drive_arm();
  world_.step(tool, options_.cycle * cycle_scale_);
  if (arm_ && !is_driven) move_arm(state.p_base_proxy);
  ++cycles_;
  simulated_cycles_ += cycle_scale_;
  pulses_.step(state, options_.cycle);
  measure_speeds();
}

void LiveCycle::add_to_switched_recorder(double t) noexcept {
  SessionRecorder* const recorder = switched_.load();
  // A hazard pointer [Michael 2004]: whoever has switched away sees it, or this sees that.
  used_.store(recorder);
  if (recorder != nullptr && switched_.load() == recorder) recorder->add(t, world_.state());
  used_.store(nullptr);
}

void LiveCycle::publish(double duration, std::uint32_t late_cycles, double now) noexcept {
  histogram_.add(duration);
  WorldSnapshot& snapshot = buffer_.back();
  snapshot.t = options_.cycle * simulated_cycles_;
  snapshot.published = now;
  snapshot.world = world_.state();
  snapshot.world.force_base *= cycle_scale_;
  snapshot.world.p_base_proxy += shown_offset_;
  snapshot.speeds = speeds_;
  snapshot.is_on_hold = was_on_hold_;
  snapshot.is_stopped = is_stopped();
  snapshot.link = link_;
  snapshot.time_scale = cycle_scale_;
  snapshot.pulse = pulses_.amplitude();
  snapshot.pulses = pulses_.count();
  snapshot.cycles = cycles_;
  snapshot.late_cycles = late_cycles;
  snapshot.times = histogram_.times();
  if (arm_) *snapshot.arm = arm_->follower.state();
  if (arm_ && arm_->driven) snapshot.arm->q = arm_->driven->q();
  if (page_device_ != nullptr) snapshot.page = page_device_->status();
  if (recorder_ != nullptr) recorder_->add(snapshot.t, world_.state());
  add_to_switched_recorder(snapshot.t);
  buffer_.publish();
}

}  // namespace pcavr
