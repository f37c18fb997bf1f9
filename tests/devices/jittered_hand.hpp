// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"

namespace pcavr::test {

inline constexpr double kCycle = 0.001;  // [s]

/// A hand that moves on a circle of 10 cm radius: 0.31 m/s, 0.99 m/s^2.
struct CirclingHand {
  static constexpr double kRadius = 0.1;         // [m]
  static constexpr double kAngularSpeed = M_PI;  // [rad/s]
  static constexpr double kSpeed = kRadius * kAngularSpeed;
  static constexpr double kAcceleration = kRadius * kAngularSpeed * kAngularSpeed;

  Eigen::Vector3d operator()(double t) const {
    return {kRadius * std::cos(kAngularSpeed * t), kRadius * std::sin(kAngularSpeed * t), 0.3};
  }
};

struct Link {
  double interval = 1.0 / 60.0;  // [s]
  double latency = 0.002;        // [s] minimum
  double jitter = 0.006;         // [s] on top, uniform
  double clock_offset = 1000.0;  // [s] sender's clock - ours
};

/// The samples of CirclingHand over `duration` [s], in order of arrival.
inline std::vector<RemoteSample> sent_over(const Link& link, double duration, std::uint64_t seed) {
  Random random(seed);
  std::vector<RemoteSample> samples;
  double last_arrival = 0.0;
  for (int i = 0; i * link.interval < duration; ++i) {
    const double t = i * link.interval;
    // Messages arrive in order, as by TCP.
    last_arrival = std::max(last_arrival, t + link.latency + random.uniform(0.0, link.jitter));
    samples.push_back({.p_base_tip = CirclingHand()(t),
                       .is_engaged = true,
                       .sender_clock = t + link.clock_offset,
                       .arrival = last_arrival});
  }
  return samples;
}

/// Runs a cycle every millisecond, each sample pushed on arrival; `at_cycle(t, sample)`.
template <typename AtCycle>
void run(RemoteDevice& device, const std::vector<RemoteSample>& samples, double duration,
         const DeviceFeedback& feedback, const AtCycle& at_cycle) {
  std::size_t next = 0;
  for (int i = 0; i * kCycle < duration; ++i) {
    const double t = i * kCycle;
    while (next < samples.size() && samples[next].arrival <= t) (void)device.push(samples[next++]);
    at_cycle(t, device.exchange(t, kCycle, feedback));
  }
}

}  // namespace pcavr::test
