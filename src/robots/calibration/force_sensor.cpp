// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/robots/calibration/force_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "robots/calibration/force_fit.hpp"

namespace pcavr {
namespace {

/// Seven unknowns are three poses' readings; with one more there is a residual of each.
constexpr std::size_t kMinPoses = 6;
/// Gravity's scatter over the poses along its weakest axis, of its size: less shows no axis.
constexpr double kMinScatter = 0.1;
/// Poses that are further from the model than this many robust stds were touched, or moved.
constexpr double kMaxOutlierRatio = 5.0;
/// A load below this does not show how a sensor is turned, over the noise of its readings.
constexpr double kMinWeightRatio = 3.0;
constexpr double kUnclearRatio = 1.2;  ///< of the residuals in the two axes: the choice is unclear

struct Hypothesis {
  ForceAxes axes = ForceAxes::sensor;
  bool is_pose_inverted = false;
};

GravitySamples force_samples_of(const std::vector<ForceReading>& readings,
                                const Hypothesis& hypothesis, const ForceSensorOptions& options) {
  const Eigen::Vector3d gravity_base = -kStandardGravity * options.up_base.normalized();
  GravitySamples samples;
  for (const ForceReading& reading : readings) {
    const Eigen::Quaterniond R_flange_base =
        hypothesis.is_pose_inverted ? reading.R_base_flange : reading.R_base_flange.conjugate();
    const bool is_base = hypothesis.axes == ForceAxes::base;
    GravitySample sample{reading.force, R_flange_base * gravity_base, reading.torque};
    if (is_base) sample.force = R_flange_base * reading.force;
    if (is_base && reading.torque) sample.torque = R_flange_base * *reading.torque;
    samples.push_back(std::move(sample));
  }
  return samples;
}

void mark_outliers(GravitySamples& samples, const RigidFit& fit) {
  std::vector<double> norms;
  for (const GravitySample& sample : samples) norms.push_back(fit.residual(sample).norm());
  // The median of the norm of three normal components is 1.538 of their std.
  const double limit = kMaxOutlierRatio * median(norms) / 1.538;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].is_used = norms[i] <= limit || limit == 0.0;
  }
}

struct ForceCandidate {
  Hypothesis hypothesis;
  GravitySamples samples = {};
  RigidFit fit = {};
  double rms = 0.0;  ///< [N] per axis, of the used samples, with the freedom that the fit leaves
};

ForceCandidate candidate_of(const std::vector<ForceReading>& readings, const Hypothesis& hypothesis,
                            const ForceSensorOptions& options) {
  ForceCandidate candidate{hypothesis, force_samples_of(readings, hypothesis, options)};
  candidate.fit = rigid_fit(candidate.samples, start_of(linear_fit(candidate.samples)));
  for (int round = 0; round < 3; ++round) {
    GravitySamples marked = candidate.samples;
    mark_outliers(marked, candidate.fit);
    if (used_count(marked) < kMinPoses) break;  // of so few, which one is wrong is not shown
    candidate.samples = std::move(marked);
    candidate.fit = rigid_fit(candidate.samples, start_of(linear_fit(candidate.samples)));
  }
  candidate.rms = std::sqrt(candidate.fit.squares / candidate.fit.freedoms());
  return candidate;
}

/// rms per axis of vectors about their mean.
double scatter_of(const std::vector<Eigen::Vector3d>& vectors) {
  const double count = static_cast<double>(vectors.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : vectors) mean += one / count;
  double squares = 0.0;
  for (const Eigen::Vector3d& one : vectors) squares += (one - mean).squaredNorm();
  return std::sqrt(squares / (3.0 * count));
}

bool has_weight(const ForceCandidate& candidate) {
  return candidate.fit.mass * kStandardGravity > kMinWeightRatio * candidate.rms;
}

std::optional<Error> undetermined_axes(const GravitySamples& samples) {
  const LinearFit fit = linear_fit(samples);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(fit.scatter);
  const double n = static_cast<double>(samples.size());
  const double weakest = std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / n) / kStandardGravity;
  if (weakest >= kMinScatter) return std::nullopt;
  const Eigen::Vector3d axis = solver.eigenvectors().col(0);
  return Error{
      .message = fmt::format(
          "the poses do not show the sensor's axes: along ({:.2f}, {:.2f}, {:.2f}) of the flange "
          "gravity changes by {:.0f} % only",
          axis.x(), axis.y(), axis.z(), 100.0 * weakest),
      .hint = "add poses that tilt the flange by 40 degrees and more about two axes, to and fro"};
}

void set_axes(const Eigen::Matrix3d& signed_rotation, ForceSensorResult& result) {
  for (int row = 0; row < 3; ++row) {
    Eigen::Index axis = 0;
    const double cosine = signed_rotation.row(row).cwiseAbs().maxCoeff(&axis);
    result.read_axes[row] = {.axis = static_cast<int>(axis),
                             .is_reversed = signed_rotation(row, axis) < 0.0,
                             .angle = std::acos(std::min(1.0, cosine))};
  }
}

/// Least squares of torque = bias + centre x weight. The weight is that of the fitted mass and
/// rotation: what is not known of these is not known of the centre either.
void set_centre(const ForceCandidate& found, ForceSensorResult& result) {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  std::size_t count = 0;
  const auto jacobian = [&](const GravitySample& sample) {
    Eigen::Matrix<double, 3, 6> J;
    J << Eigen::Matrix3d::Identity(), -skew(found.fit.weight(sample));
    return J;
  };
  for (const GravitySample& sample : found.samples) {
    if (!sample.is_used || !sample.torque) continue;
    const Eigen::Matrix<double, 3, 6> J = jacobian(sample);
    matrix += J.transpose() * J;
    gradient += J.transpose() * *sample.torque;
    ++count;
  }
  if (count < kMinPoses) return;
  const Vector6d solution = matrix.ldlt().solve(gradient);
  const Matrix6d inverse = matrix.ldlt().solve(Matrix6d::Identity());
  double squares = 0.0;
  Eigen::Matrix<double, 6, 4> by_weight = Eigen::Matrix<double, 6, 4>::Zero();
  for (const GravitySample& sample : found.samples) {
    if (!sample.is_used || !sample.torque) continue;
    const Eigen::Matrix<double, 3, 6> J = jacobian(sample);
    squares += (*sample.torque - J * solution).squaredNorm();
    by_weight += J.transpose() * skew(solution.tail<3>()) * found.fit.weight_slope(sample);
  }
  const double freedoms = 3.0 * static_cast<double>(count) - 6.0;
  const Eigen::Matrix<double, 6, 4> slope = inverse * by_weight;
  const Matrix6d of_weight = found.fit.squares / found.fit.freedoms() * slope *
                             found.fit.inverse.bottomRightCorner<4, 4>() * slope.transpose();
  const Vector6d stds =
      (squares / freedoms * inverse.diagonal() + of_weight.diagonal()).cwiseSqrt();
  result.torque_bias = solution.head<3>();
  result.torque_bias_std = stds.head<3>();
  result.centre = solution.tail<3>();
  result.centre_std = stds.tail<3>();
  result.torque_rms = std::sqrt(squares / (3.0 * static_cast<double>(count)));
}

/// What the ratio of variances of 5 and `freedoms` degrees of freedom exceeds by chance once in
/// 1000 times: the F distribution, between its tabulated values linear in 1 / freedoms.
double chance_limit(double freedoms) {
  constexpr std::array<std::pair<double, double>, 7> kLimits{{{1.0 / 6.0, 20.8},
                                                              {1.0 / 8.0, 13.5},
                                                              {1.0 / 12.0, 8.89},
                                                              {1.0 / 18.0, 6.81},
                                                              {1.0 / 30.0, 5.53},
                                                              {1.0 / 60.0, 4.76},
                                                              {0.0, 4.10}}};
  const double inverse = 1.0 / freedoms;
  for (std::size_t i = 0; i + 1 < kLimits.size(); ++i) {
    const auto& [high, at_high] = kLimits[i];
    const auto& [low, at_low] = kLimits[i + 1];
    if (inverse >= low) return at_low + (at_high - at_low) * (inverse - low) / (high - low);
  }
  return kLimits.back().second;
}

void set_gain(const ForceCandidate& found, ForceSensorResult& result) {
  const LinearFit linear = linear_fit(found.samples);
  const RigidFit& fit = found.fit;
  const double freedoms = std::max(1.0, 3.0 * static_cast<double>(fit.used) - 12.0);
  result.gain = linear.matrix * fit.R_sensor_flange.transpose() / (fit.sign * fit.mass);
  const Eigen::Matrix3d spread = fit.R_sensor_flange *
                                 linear.scatter.ldlt().solve(Eigen::Matrix3d::Identity()) *
                                 fit.R_sensor_flange.transpose();
  const double std = std::sqrt(linear.squares / freedoms) / fit.mass;
  for (int row = 0; row < 3; ++row) {
    result.gain_std.row(row) = std * spread.diagonal().cwiseSqrt().transpose();
  }
  const double ratio = (fit.squares - linear.squares) / 5.0 / (linear.squares / freedoms);
  result.has_cross_talk = linear.squares > 0.0 && ratio > chance_limit(freedoms);
}

/// [N] per axis, each pose by the fit of the others.
double rms_of_each_by_others(const ForceCandidate& found) {
  double squares = 0.0;
  GravitySamples samples = found.samples;
  for (GravitySample& sample : samples) {
    if (!sample.is_used) continue;
    sample.is_used = false;
    squares += rigid_fit(samples, found.fit).residual(sample).squaredNorm();
    sample.is_used = true;
  }
  return std::sqrt(squares / (3.0 * static_cast<double>(found.fit.used)));
}

void set_residuals(const std::vector<ForceReading>& readings, const ForceCandidate& found,
                   ForceSensorResult& result) {
  std::string outliers;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const GravitySample& sample = found.samples[i];
    result.residuals.push_back({readings[i].name, found.fit.residual(sample), !sample.is_used});
    if (!sample.is_used) outliers += (outliers.empty() ? "" : ", ") + readings[i].name;
  }
  if (outliers.empty()) return;
  result.notes.push_back("left out, further from the model than the noise: " + outliers +
                         " (touched, or not at rest)");
}

ForceSensorResult force_result(const std::vector<ForceReading>& readings,
                               const ForceCandidate& found, double other_rms) {
  const RigidFit& fit = found.fit;
  ForceSensorResult result{.axes = found.hypothesis.axes,
                           .is_pose_inverted = found.hypothesis.is_pose_inverted,
                           .sign = fit.sign,
                           .mass = fit.mass};
  const double variance = fit.squares / fit.freedoms();
  const Vector7d stds = (variance * fit.inverse.diagonal()).cwiseSqrt();
  result.mass_std = stds[3];
  result.R_sensor_flange = Eigen::Quaterniond(fit.R_sensor_flange);
  result.rotation_std = stds.tail<3>();
  result.force_bias = fit.bias;
  result.force_bias_std = stds.head<3>();
  result.residual_rms = std::sqrt(fit.squares / (3.0 * static_cast<double>(fit.used)));
  result.held_out_rms = rms_of_each_by_others(found);
  result.other_axes_rms = other_rms;
  set_axes(fit.sign * fit.R_sensor_flange, result);
  set_centre(found, result);
  set_gain(found, result);
  set_residuals(readings, found, result);
  if (result.is_pose_inverted) {
    result.notes.push_back("the poses fit as those of the base in the flange: they are inverted");
  }
  if (other_rms < kUnclearRatio * found.rms) {
    result.notes.push_back(
        "sensor's or base's axes: both fit alike, more poses with other tilts would show it");
  }
  return result;
}

Error no_weight(const std::vector<ForceReading>& readings) {
  std::vector<Eigen::Vector3d> forces;
  for (const ForceReading& one : readings) forces.push_back(one.force);
  return {.message = fmt::format("the readings do not change with the pose, but for {:.2g} N: the "
                                 "load's weight is not in them",
                                 scatter_of(forces)),
          .hint = "give readings that are not compensated, or fix a load of some hundred grams"};
}

/// Whether the torque that was read is the same in all poses, as well as it is that of a weight in
/// front of the sensor, which turns in the base's axes.
bool is_torque_constant(const std::vector<ForceReading>& readings,
                        const ForceSensorResult& result) {
  std::vector<Eigen::Vector3d> torques;
  for (const ForceReading& one : readings) {
    if (one.torque) torques.push_back(*one.torque);
  }
  return result.centre && scatter_of(torques) < kUnclearRatio * result.torque_rms;
}

}  // namespace

Expected<ForceSensorResult> calibrate_force_sensor(const std::vector<ForceReading>& readings,
                                                   const ForceSensorOptions& options) {
  if (readings.size() < kMinPoses) {
    return Error{.message = fmt::format("{} poses at rest are too few", readings.size()),
                 .hint = fmt::format("give {} and more, with different tilts", kMinPoses)};
  }
  if (const auto error = undetermined_axes(force_samples_of(readings, {}, options))) return *error;
  std::vector<ForceCandidate> candidates;
  for (const bool is_inverted : {false, true}) {
    for (const ForceAxes axes : {ForceAxes::sensor, ForceAxes::base}) {
      candidates.push_back(candidate_of(readings, {axes, is_inverted}, options));
    }
  }
  // The first of those that fit alike: poses as they are given, the sensor's axes.
  const ForceCandidate* best = &candidates.front();
  for (const ForceCandidate& candidate : candidates) {
    if (candidate.rms < best->rms / kUnclearRatio) best = &candidate;
  }
  const bool is_constant = !has_weight(*best);
  if (is_constant) {
    // Turned to the base's axes without a bias, the weight is the same in every pose. So is the
    // bias of a sensor without a load: but only a vertical one fits as a weight as well.
    const ForceCandidate& base = candidates[1];
    if (!has_weight(base) || base.rms > kUnclearRatio * best->rms) return no_weight(readings);
    best = &base;
  }
  double other = 0.0;
  for (const ForceCandidate& candidate : candidates) {
    if (candidate.hypothesis.axes == best->hypothesis.axes ||
        candidate.hypothesis.is_pose_inverted != best->hypothesis.is_pose_inverted) {
      continue;
    }
    other = candidate.rms;
  }
  ForceSensorResult result = force_result(readings, *best, other);
  if (is_constant) {
    if (is_torque_constant(readings, result)) return no_weight(readings);
    result.notes.push_back(
        "the readings are the same in all poses: a weight in the base's axes, or else a "
        "compensated sensor with a vertical bias");
  }
  return result;
}

std::string describe_force_axes(const ForceSensorResult& result) {
  std::string text = result.axes == ForceAxes::sensor ? "in the sensor's axes: "
                                                      : "in the base's axes; turned back: ";
  double angle = 0.0;
  for (int row = 0; row < 3; ++row) {
    const ReadAxis& read = result.read_axes[row];
    text += fmt::format("{}{} reads the flange's {}{}", row > 0 ? ", " : "", "xyz"[row],
                        read.is_reversed ? '-' : '+', "xyz"[read.axis]);
    angle = std::max(angle, read.angle);
  }
  text += fmt::format(", within {:.1f} degrees", 180.0 / std::numbers::pi * angle);
  if (result.sign < 0.0) text += "; the sign is reversed, or one axis is mirrored";
  return text;
}

}  // namespace pcavr
