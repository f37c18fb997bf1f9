// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

constexpr double kMaxLever = 0.010;  // [m]: with a larger lever arm, a push rotates the object
constexpr double kRestBefore = 0.2;  // [s] included: a slide at constant speed alone fits any delay
constexpr double kSpeedStep = 0.02;  // [s] of the central difference for the speed
constexpr double kMaxOffset = 0.25;  // [s] as for the force
constexpr double kMaxOffsetStep = 0.05;
constexpr int kIterations = 8;
constexpr double kMinPoses = 8.0;

/// Sums of a linear least-squares fit of the residual on the speed, about each contact's means: one
/// Gauss-Newton step of the offset.
struct Sums {
  double speed_squares = 0.0;     ///< [m^2/s^2]
  double gradient = 0.0;          ///< [m^2/s]
  double residual_squares = 0.0;  ///< [m^2]
  double count = 0.0;

  void add(const ContactEpisode& episode, const std::vector<TrackedPose>& tracked, double offset) {
    std::vector<double> residual, speed;
    for (const TrackedPose& pose : tracked) {
      if (pose.t < episode.begin - kRestBefore || pose.t > episode.end) continue;
      const double at = pose.t - offset;
      residual.push_back(pose.T_base_object.translation().dot(episode.direction_base) -
                         displacement_at(episode, at));
      speed.push_back(
          (displacement_at(episode, at + kSpeedStep) - displacement_at(episode, at - kSpeedStep)) /
          (2.0 * kSpeedStep));
    }
    if (residual.size() < 4) return;
    const auto n = static_cast<double>(residual.size());
    double mean = 0.0, mean_speed = 0.0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
      mean += residual[i] / n;
      mean_speed += speed[i] / n;
    }
    for (std::size_t i = 0; i < residual.size(); ++i) {
      speed_squares += std::pow(speed[i] - mean_speed, 2);
      gradient -= (speed[i] - mean_speed) * (residual[i] - mean);
      residual_squares += std::pow(residual[i] - mean, 2);
    }
    count += n;
  }
};

}  // namespace

TimeOffset camera_offset(const IdentificationInput& input,
                         const std::vector<IdentifiedContact>& contacts) {
  TimeOffset result;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Sums sums;
    for (const IdentifiedContact& contact : contacts) {
      const bool is_usable = contact.object && contact.left_out.empty() &&
                             !contact.episode.slides.empty() &&
                             std::abs(contact.lever) <= kMaxLever;
      if (is_usable)
        sums.add(contact.episode, input.objects[*contact.object].tracked, result.offset);
    }
    if (sums.count < kMinPoses || sums.speed_squares <= 0.0) return result;
    result.offset +=
        std::clamp(sums.gradient / sums.speed_squares, -kMaxOffsetStep, kMaxOffsetStep);
    result.std = std::sqrt(sums.residual_squares / sums.count / sums.speed_squares);
    result.is_known = std::abs(result.offset) < kMaxOffset && result.std < 0.1 * kMaxOffset;
  }
  return result;
}

}  // namespace pcavr
