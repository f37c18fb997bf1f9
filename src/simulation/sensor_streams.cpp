// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/sensor_streams.hpp"

#include <cmath>
#include <numbers>

#include "pcavr/simulation/plant.hpp"

namespace pcavr::simulation {
namespace {

// Independent random streams of one seed.
constexpr std::uint64_t kToolStream = 6;
constexpr std::uint64_t kWrenchStream = 7;
constexpr std::uint64_t kTrackingStream = 50;

// The bias drifts as a first-order Gauss-Markov (Ornstein-Uhlenbeck) process.
constexpr double kBiasStd = 0.1;          // [N]
constexpr double kCorrelationTime = 3.0;  // [s]
constexpr double kPeriod = kStepsPerSample * PlantRun::kStep;
constexpr double kOutlierProbability = 1e-3;  // per sample

Eigen::Vector3d normal_vector(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

}  // namespace

ToolSensor::ToolSensor(std::uint64_t seed) : random_(Random(seed).fork(kToolStream)) {}

Pose ToolSensor::measure(const Eigen::Vector3d& p_base_tip) {
  const Eigen::Quaterniond pointing_down(0.0, 1.0, 0.0, 0.0);
  Vector6d noise;
  noise << 5e-5 * normal_vector(random_), 2e-4 * normal_vector(random_);
  return Pose(pointing_down, p_base_tip) * Pose::exp(noise);
}

WrenchSensor::WrenchSensor(std::uint64_t seed)
    : random_(Random(seed).fork(kWrenchStream)), bias_(kBiasStd * normal_vector(random_)) {}

WrenchSensor::Sample WrenchSensor::measure(const Eigen::Vector3d& force,
                                           const Eigen::Vector3d& torque) {
  static const double decay = std::exp(-kPeriod / kCorrelationTime);
  Sample sample;
  sample.force =
      force + (bias_ + normal_vector(random_).cwiseProduct(Eigen::Vector3d(0.20, 0.20, 0.26)));
  if (random_.uniform() < kOutlierProbability) {
    sample.force += random_.uniform(6.0, 35.0) * normal_vector(random_).normalized();
  }
  bias_ = decay * bias_ + kBiasStd * std::sqrt(1.0 - decay * decay) * normal_vector(random_);
  sample.torque = torque + 0.005 * normal_vector(random_);
  return sample;
}

TrackerError::TrackerError(std::uint64_t seed, std::size_t body)
    : random_(Random(seed).fork(kTrackingStream + body)) {
  draw_bias();
}

Vector6d TrackerError::at_rest() {
  if (was_moving_) draw_bias();
  was_moving_ = false;
  return bias_ + noise_twist(1.5e-5, 0.005);
}

Vector6d TrackerError::in_motion() {
  was_moving_ = true;
  // 0.3 mm over all three axes.
  const double scale = random_.uniform() < 0.02 ? random_.uniform(1.5, 3.5) : 1.0;
  return scale * noise_twist(0.3e-3 / std::numbers::sqrt3, 0.07 / std::numbers::sqrt3);
}

Vector6d TrackerError::noise_twist(double position, double degrees) {
  Vector6d noise;
  noise << position * normal_vector(random_),
      degrees * std::numbers::pi / 180.0 * normal_vector(random_);
  return noise;
}

void TrackerError::draw_bias() {
  bias_ << random_.uniform(0.5e-4, 1.7e-4) * normal_vector(random_).normalized(),
      0.03 * std::numbers::pi / 180.0 * normal_vector(random_);
}

bool is_resting(const Eigen::Vector2d& p_before, double yaw_before, const Eigen::Vector2d& p_now,
                double yaw_now) {
  return (p_before - p_now).norm() < 2e-4 && std::abs(yaw_before - yaw_now) < 2e-3;
}

}  // namespace pcavr::simulation
