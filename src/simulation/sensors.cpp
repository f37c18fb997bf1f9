// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/random.hpp"
#include "pcavr/robots/robot/robot_dynamics.hpp"

#include "simulation/sensor_streams.hpp"

namespace pcavr {
namespace {

using namespace simulation;

constexpr std::uint64_t kWorkshopStream = 9;
constexpr std::uint64_t kJointStream = 8;  ///< of the seed; see sensor_streams.cpp for the others

Stamp stamp_of_step(std::size_t step) {
  return Stamp::from_seconds(PlantRun::kStep * static_cast<double>(step));
}

/// A force or torque as the sensor reports it, with faults.
Eigen::Vector3d reported(const Eigen::Vector3d& exact, const SensorFaults& faults,
                         double saturation) {
  Eigen::Vector3d value = faults.is_force_flipped ? Eigen::Vector3d(-exact) : exact;
  if (faults.saturation) value = value.cwiseMax(-saturation).cwiseMin(saturation);
  return value;
}

/// Whether a body was at rest over the last 0.1 s, which a tracker requires before it averages.
bool is_resting_at(const PlantRun& run, std::size_t index, double t) {
  const auto step = static_cast<std::size_t>(t / PlantRun::kStep);
  const std::size_t now = std::min(step, run.p_base_tip.size() - 1);
  const PlantBodyState& a = run.bodies[index][now > kRestingSteps ? now - kRestingSteps : 0];
  const PlantBodyState& b = run.bodies[index][now];
  return is_resting(a.p_base, a.yaw, b.p_base, b.yaw);
}

}  // namespace

SensorFaults with_workshop_faults(SensorFaults faults, std::uint64_t seed) {
  Random random = Random(seed).fork(kWorkshopStream);
  faults.tracking_delay = random.uniform(0.01, 0.06);
  faults.cable_stiffness = random.uniform(0.5, 2.0);
  return faults;
}

Trajectory measured_tool(const PlantRun& run, std::uint64_t seed) {
  ToolSensor sensor(seed);
  Trajectory T_base_tool;
  for (std::size_t i = 0; i < run.p_base_tip.size(); i += kStepsPerSample) {
    T_base_tool.append(stamp_of_step(i), sensor.measure(run.p_base_tip[i]));
  }
  return T_base_tool;
}

JointLog measured_joints(const PlantRun& run, const PlantArm& arm, std::uint64_t seed) {
  Random random = Random(seed).fork(kJointStream);
  JointLog log;
  for (const std::size_t joint : arm.described.coordinate_joints()) {
    log.joints.push_back(arm.described.joints[joint].name);
  }
  const auto rows =
      static_cast<Eigen::Index>((run.arm.size() + kStepsPerSample - 1) / kStepsPerSample);
  const Eigen::Index dof = arm.q_start.size();
  log.position.resize(rows, dof);
  log.velocity.resize(rows, dof);
  log.torque.resize(rows, dof);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const std::size_t step = static_cast<std::size_t>(row) * kStepsPerSample;
    const PlantArmState& state = run.arm[step];
    log.stamps.push_back(stamp_of_step(step));
    log.t.push_back(log.stamps.back().seconds());
    for (const std::size_t joint : arm.described.coordinate_joints()) {
      const auto k = static_cast<Eigen::Index>(arm.described.joints[joint].coordinate);
      const double effort = arm.described.joints[joint].limits.effort.value_or(0.0);
      log.position(row, k) = state.q[k] + 1e-5 * random.normal();
      log.velocity(row, k) = state.dq[k] + 1e-3 * random.normal();
      log.torque(row, k) = state.tau[k] + 2e-3 * effort * random.normal();
    }
  }
  return log;
}

Trajectory measured_tool(const JointLog& log, const PlantArm& arm) {
  RobotDynamics kinematics(arm.described);
  Trajectory T_base_tool;
  for (Eigen::Index row = 0; row < log.position.rows(); ++row) {
    kinematics.forward_kinematics(log.position.row(row).transpose());
    T_base_tool.append(log.stamps[static_cast<std::size_t>(row)],
                       arm.T_base_robot * kinematics.T_base_link(arm.tip));
  }
  return T_base_tool;
}

std::vector<WrenchSample> measured_wrench(const PlantRun& run, std::uint64_t seed,
                                          const SensorFaults& faults) {
  WrenchSensor sensor(seed);
  std::vector<WrenchSample> samples;
  for (std::size_t i = 0; i + 1 < run.force_base.size(); i += kStepsPerSample) {
    // The cable's pull on the tool appears as its opposite in the force on the surroundings.
    const Eigen::Vector3d pull =
        faults.cable_stiffness * (run.p_base_tip[i] - run.p_base_tip.front());
    const WrenchSensor::Sample measured =
        sensor.measure(0.5 * (run.force_base[i] + run.force_base[i + 1]) + pull,
                       0.5 * (run.torque_base[i] + run.torque_base[i + 1]));
    const double t = PlantRun::kStep * static_cast<double>(i + 1) + faults.clock_offset;
    if (t < 0.0) continue;
    constexpr double kTorqueArm = 0.1;  // [m]: a sensor rated for N newtons is rated for N / 10 N m
    const double limit = faults.saturation.value_or(0.0);
    samples.push_back({.stamp = Stamp::from_seconds(t),
                       .force = reported(measured.force, faults, limit),
                       .torque = reported(measured.torque, faults, kTorqueArm * limit)});
  }
  return samples;
}

std::vector<SimulatedMeasurement> simulated_tracking(const PlantRun& run, const PlantBody& body,
                                                     std::size_t index, std::uint64_t seed,
                                                     const SensorFaults& faults) {
  TrackerError error(seed, index);
  std::vector<SimulatedMeasurement> measurements;
  const auto frames = static_cast<long>(run.duration() * kFrameRate);
  for (long i = 0; i <= frames; ++i) {
    // Stamps are whole microseconds, as in the image lists.
    const Stamp stamp{std::llround(1e6 * static_cast<double>(i) / kFrameRate) * 1000};
    const double t = stamp.seconds();
    SimulatedMeasurement measurement;
    measurement.stamp = Stamp::from_seconds(t + faults.tracking_delay);
    measurement.is_at_rest = is_resting_at(run, index, t);
    const Vector6d noise = measurement.is_at_rest ? error.at_rest() : error.in_motion();
    measurement.is_seen =
        !faults.lost_tracking || t < faults.lost_tracking->begin || t > faults.lost_tracking->end;
    measurement.T_base_object = T_base_object_at(run, body, index, t) * Pose::exp(noise);
    measurement.position_std = measurement.is_at_rest ? kRestingPositionStd : kMovingPositionStd;
    measurement.rotation_std = measurement.is_at_rest ? kRestingRotationStd : kMovingRotationStd;
    measurements.push_back(measurement);
  }
  return measurements;
}

}  // namespace pcavr
