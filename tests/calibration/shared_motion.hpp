// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <vector>

#include "pcavr/base/core/random.hpp"
#include "pcavr/base/geometry/trajectory.hpp"

namespace pcavr {

/// A smooth random motion of one body, seen from two sides with two clocks.
class SharedMotion {
 public:
  explicit SharedMotion(std::uint64_t seed) {
    Random random(seed);
    for (double& phase : phases_) phase = random.uniform(0.0, 6.28);
    for (double& pace : paces_) pace = random.uniform(0.7, 1.3);
    Vector6d frames;
    for (Pose* pose : {&T_a_world_, &T_body_b_}) {
      for (int i = 0; i < 6; ++i) frames[i] = random.normal();
      *pose = Pose::exp(frames);
    }
  }

  [[nodiscard]] Pose at(double t) const {
    Vector6d twist;
    for (int i = 0; i < 6; ++i) {
      const double* phase = phases_ + 2 * i;
      const double size = i < 3 ? 0.2 : 0.4;
      twist[i] = size * (std::sin(paces_[i] * (0.7 + 0.11 * i) * t + phase[0]) +
                         0.5 * std::sin(paces_[i] * (2.1 + 0.23 * i) * t + phase[1]));
    }
    return Pose::exp(twist);
  }

  /// Of the body in a's world, at its stamps.
  [[nodiscard]] std::vector<TimedPose> seen_by_a(double duration, double rate, double noise,
                                                 Random random) const {
    std::vector<TimedPose> rows;
    for (int i = 0; i < static_cast<int>(duration * rate); ++i) {
      const double t = i / rate;
      rows.push_back({Stamp::from_seconds(t), T_a_world_ * at(t) * jitter(noise, random)});
    }
    return rows;
  }
  /// Of another frame of the body in b's world, whose clock is late by `offset` [s].
  [[nodiscard]] std::vector<TimedPose> seen_by_b(double duration, double rate, double noise,
                                                 double offset, double drift, Random random) const {
    std::vector<TimedPose> rows;
    for (int i = 0; i < static_cast<int>(duration * rate); ++i) {
      const double t_b = i / rate;
      const double t = t_b + offset + drift * (t_b - 0.5 * duration);
      rows.push_back({Stamp::from_seconds(t_b), at(t) * T_body_b_ * jitter(noise, random)});
    }
    return rows;
  }

 private:
  static Pose jitter(double noise, Random& random) {
    Vector6d twist;
    for (int i = 0; i < 6; ++i) twist[i] = noise * random.normal();
    return Pose::exp(twist);
  }

  double phases_[12] = {};
  double paces_[6] = {};
  Pose T_a_world_, T_body_b_;
};

}  // namespace pcavr
