// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/simulation/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pcavr/core/random.hpp"
#include "pcavr/robot/robot_dynamics.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kStepsPerSample = 2;  ///< of the plant's steps: 500 Hz
constexpr double kFrameRate = 30.0;         ///< [Hz]

// Independent random streams of one seed.
constexpr std::uint64_t kToolStream = 6;
constexpr std::uint64_t kWrenchStream = 7;
constexpr std::uint64_t kTrackingStream = 50;
constexpr std::uint64_t kJointStream = 8;

Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

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

/// Draws a tracker's pose errors frame by frame.
class TrackerError {
 public:
  explicit TrackerError(const Random& random) : random_(random) { draw_bias(); }

  /// Of a body at rest: a constant bias plus a little noise.
  [[nodiscard]] Vector6d at_rest() {
    if (was_moving_) draw_bias();
    was_moving_ = false;
    return bias_ + noise_twist(1.5e-5, 0.005);
  }

  [[nodiscard]] Vector6d in_motion() {
    was_moving_ = true;
    // 0.3 mm over all three axes.
    const double scale = random_.uniform() < 0.02 ? random_.uniform(1.5, 3.5) : 1.0;
    return scale * noise_twist(0.3e-3 / std::numbers::sqrt3, 0.07 / std::numbers::sqrt3);
  }

 private:
  /// Standard deviations per axis [m], [deg].
  [[nodiscard]] Vector6d noise_twist(double position, double degrees) {
    Vector6d noise;
    noise << position * normal_vector(random_),
        degrees * std::numbers::pi / 180.0 * normal_vector(random_);
    return noise;
  }

  void draw_bias() {
    bias_ << random_.uniform(0.5e-4, 1.7e-4) * normal_vector(random_).normalized(),
        0.03 * std::numbers::pi / 180.0 * normal_vector(random_);
  }

  Random random_;
  Vector6d bias_ = Vector6d::Zero();
  bool was_moving_ = false;
};

/// Whether a body was at rest over the last 0.1 s, which a tracker requires before it averages.
bool is_resting(const PlantRun& run, std::size_t index, double t) {
  const auto step = static_cast<std::size_t>(t / PlantRun::kStep);
  const std::size_t now = std::min(step, run.p_base_tip.size() - 1);
  const PlantBodyState& a = run.bodies[index][now > 100 ? now - 100 : 0];
  const PlantBodyState& b = run.bodies[index][now];
  return (a.p_base - b.p_base).norm() < 2e-4 && std::abs(a.yaw - b.yaw) < 2e-3;
}

}  // namespace

Trajectory measured_tool(const PlantRun& run, std::uint64_t seed) {
  Random random = Random(seed).fork(kToolStream);
  const Eigen::Quaterniond pointing_down(0.0, 1.0, 0.0, 0.0);
  Trajectory T_base_tool;
  for (std::size_t i = 0; i < run.p_base_tip.size(); i += kStepsPerSample) {
    Vector6d noise;
    noise << 5e-5 * normal_vector(random), 2e-4 * normal_vector(random);
    T_base_tool.append(stamp_of_step(i), Pose(pointing_down, run.p_base_tip[i]) * Pose::exp(noise));
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
  // The bias drifts as a first-order Gauss-Markov (Ornstein-Uhlenbeck) process.
  constexpr double kBiasStd = 0.1;          // [N]
  constexpr double kCorrelationTime = 3.0;  // [s]
  constexpr double kPeriod = kStepsPerSample * PlantRun::kStep;
  constexpr double kOutlierProbability = 1e-3;  // per sample
  const double decay = std::exp(-kPeriod / kCorrelationTime);
  Random random = Random(seed).fork(kWrenchStream);
  Eigen::Vector3d bias = kBiasStd * normal_vector(random);
  std::vector<WrenchSample> samples;
  for (std::size_t i = 0; i + 1 < run.force_base.size(); i += kStepsPerSample) {
    Eigen::Vector3d force = 0.5 * (run.force_base[i] + run.force_base[i + 1]);
    force += bias + normal_vector(random).cwiseProduct(Eigen::Vector3d(0.20, 0.20, 0.26));
    if (random.uniform() < kOutlierProbability) {
      force += random.uniform(6.0, 35.0) * normal_vector(random).normalized();
    }
    bias = decay * bias + kBiasStd * std::sqrt(1.0 - decay * decay) * normal_vector(random);
    const Eigen::Vector3d torque =
        0.5 * (run.torque_base[i] + run.torque_base[i + 1]) + 0.005 * normal_vector(random);
    const double t = PlantRun::kStep * static_cast<double>(i + 1) + faults.clock_offset;
    if (t < 0.0) continue;
    constexpr double kTorqueArm = 0.1;  // [m]: a sensor rated for N newtons is rated for N / 10 N m
    const double limit = faults.saturation.value_or(0.0);
    samples.push_back({.stamp = Stamp::from_seconds(t),
                       .force = reported(force, faults, limit),
                       .torque = reported(torque, faults, kTorqueArm * limit)});
  }
  return samples;
}

std::vector<SimulatedMeasurement> simulated_tracking(const PlantRun& run, const PlantBody& body,
                                                     std::size_t index, std::uint64_t seed,
                                                     const SensorFaults& faults) {
  TrackerError error(Random(seed).fork(kTrackingStream + index));
  std::vector<SimulatedMeasurement> measurements;
  const auto frames = static_cast<long>(run.duration() * kFrameRate);
  for (long i = 0; i <= frames; ++i) {
    // In whole microseconds, as in the image lists.
    const Stamp stamp{std::llround(1e6 * static_cast<double>(i) / kFrameRate) * 1000};
    const double t = stamp.seconds();
    SimulatedMeasurement measurement;
    measurement.stamp = stamp;
    measurement.is_at_rest = is_resting(run, index, t);
    const Vector6d noise = measurement.is_at_rest ? error.at_rest() : error.in_motion();
    measurement.is_seen =
        !faults.lost_tracking || t < faults.lost_tracking->begin || t > faults.lost_tracking->end;
    measurement.T_base_object = T_base_object_at(run, body, index, t) * Pose::exp(noise);
    measurement.position_std = measurement.is_at_rest ? 2e-4 : 4e-4;
    measurement.rotation_std = measurement.is_at_rest ? 1e-3 : 2e-3;
    measurements.push_back(measurement);
  }
  return measurements;
}

}  // namespace pcavr
