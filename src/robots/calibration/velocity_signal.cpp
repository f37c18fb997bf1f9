// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "velocity_signal.hpp"

#include <algorithm>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr {
namespace {

constexpr double kMinHalfWindow = 0.05;   ///< [s] of a velocity: shorter ones are noise
constexpr double kWindowIntervals = 2.0;  ///< half of it, in intervals of the slower stream
constexpr double kGapIntervals = 6.0;     ///< over which a stream is not interpolated
constexpr std::size_t kMaxFine = 12000;   ///< samples of the estimate
/// Step of the estimate's samples, in intervals of the faster stream: by the golden section they
/// fall on all phases between its rows alike. On one phase alone the errors of interpolation at a
/// window's two ends differ by a part of the slope: 0.4 ms of offset at 50 Hz.
constexpr double kSampleStep = 0.618034;

}  // namespace

double velocity_half_window(double slow_interval) {
  return std::max(kWindowIntervals * slow_interval, kMinHalfWindow);
}

double max_interpolated_gap(double interval) { return kGapIntervals * interval; }

VelocitySignal::VelocitySignal(const PoseStream& stream, Velocity kind, double half_window,
                               double slow_interval)
    : stream_(stream),
      kind_(kind),
      half_window_(half_window),
      max_gap_(duration_from_seconds(max_interpolated_gap(slow_interval))) {}

std::optional<Eigen::Vector3d> VelocitySignal::at(double t) const {
  const auto before = stream_.poses.at(Stamp::from_seconds(t - half_window_), max_gap_);
  const auto after = stream_.poses.at(Stamp::from_seconds(t + half_window_), max_gap_);
  if (!before || !after) return std::nullopt;
  const Eigen::Vector3d change =
      kind_ == Velocity::angular ? Eigen::Vector3d((before->inverse() * *after).log().tail<3>())
                                 : Eigen::Vector3d(after->translation() - before->translation());
  return Eigen::Vector3d(change / (2.0 * half_window_));
}

VelocitySamples samples_of(const VelocitySignal& b, double interval) {
  const double step =
      std::max(kSampleStep * interval, (b.end() - b.begin()) / static_cast<double>(kMaxFine));
  VelocitySamples samples;
  for (double t = b.begin(); t <= b.end(); t += step) {
    const auto value = b.at(t);
    if (!value) continue;
    samples.t.push_back(t);
    samples.b.push_back(*value);
  }
  return samples;
}

Eigen::Matrix3d turn_of(const Eigen::Matrix3d& sum) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d sign = Eigen::Matrix3d::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

}  // namespace pcavr
