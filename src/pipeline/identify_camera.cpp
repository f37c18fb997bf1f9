// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "identify_parts.hpp"

namespace pcavr {
namespace {

constexpr double kStraight = 0.010;  // [m] of lever: farther from its middle, a push turns it
constexpr double kBefore = 0.2;      // [s] of rest: a slide at one speed alone fits any delay
constexpr double kSpeedStep = 0.02;  // [s] over which the speed is taken
constexpr double kLargest = 0.25;    // [s] as for the force
constexpr double kMaxStep = 0.05;
constexpr int kIterations = 8;
constexpr double kMinPoses = 8.0;

/// Sums of a straight fit of the misfit on the speed, contact by contact about their means.
struct Sums {
  double slopes = 0.0;   ///< [m^2/s^2]
  double pull = 0.0;     ///< [m^2/s]
  double squares = 0.0;  ///< [m^2]
  double count = 0.0;

  void add(const ContactEpisode& episode, const std::vector<TrackedPose>& tracked, double offset) {
    std::vector<double> left, speed;
    for (const TrackedPose& pose : tracked) {
      if (pose.t < episode.begin - kBefore || pose.t > episode.end) continue;
      const double at = pose.t - offset;
      left.push_back(pose.T_base_object.translation().dot(episode.direction_base) -
                     way_at(episode, at));
      speed.push_back((way_at(episode, at + kSpeedStep) - way_at(episode, at - kSpeedStep)) /
                      (2.0 * kSpeedStep));
    }
    if (left.size() < 4) return;
    const auto n = static_cast<double>(left.size());
    double mean = 0.0, mean_speed = 0.0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      mean += left[i] / n;
      mean_speed += speed[i] / n;
    }
    for (std::size_t i = 0; i < left.size(); ++i) {
      slopes += std::pow(speed[i] - mean_speed, 2);
      pull -= (speed[i] - mean_speed) * (left[i] - mean);
      squares += std::pow(left[i] - mean, 2);
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
      const bool tells = contact.object && contact.left_out.empty() &&
                         !contact.episode.slides.empty() && std::abs(contact.lever) <= kStraight;
      if (tells) sums.add(contact.episode, input.objects[*contact.object].tracked, result.offset);
    }
    if (sums.count < kMinPoses || sums.slopes <= 0.0) return result;
    result.offset += std::clamp(sums.pull / sums.slopes, -kMaxStep, kMaxStep);
    result.deviation = std::sqrt(sums.squares / sums.count / sums.slopes);
    result.is_known = std::abs(result.offset) < kLargest && result.deviation < 0.1 * kLargest;
  }
  return result;
}

}  // namespace pcavr
