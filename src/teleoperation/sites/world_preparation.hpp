// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <future>
#include <utility>

#include <Eigen/Core>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {

/// The world of the next session: it takes as long to make as a session lasts without messages, so
/// it is made by a thread, or with `at_once` within is_ready().
class WorldPreparation {
 public:
  explicit WorldPreparation(bool at_once) : at_once_(at_once) {}

  /// [s] that making it is expected to take.
  [[nodiscard]] double expected_duration() const { return duration_; }
  [[nodiscard]] bool has_begun() const { return future_.valid(); }
  /// `world` must outlive it. The tip is at `p_base_tip` at `start` [s].
  void begin(double now, const TeleopInput& world, TeleopOptions options, double start,
             const Eigen::Vector3d& p_base_tip) {
    began_ = now;
    const std::launch policy = at_once_ ? std::launch::deferred : std::launch::async;
    future_ = std::async(policy, [&world, options = std::move(options), start, p_base_tip] {
      return caught([&] { return LiveOperatorSite::create(world, options, start, p_base_tip); });
    });
  }
  [[nodiscard]] bool is_ready() const {
    return at_once_ || future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  /// An Error also where making it threw.
  [[nodiscard]] Expected<LiveOperatorSite> take(double now) {
    duration_ = std::max(duration_, kMargin * (now - began_));
    Expected<Expected<LiveOperatorSite>> made = future_.get();
    if (!made) return made.error();
    return *std::move(made);
  }
  /// Waits for a thread that makes one.
  void cancel() { future_ = {}; }

 private:
  static constexpr double kMargin = 1.5;  // of the time that the last one took

  bool at_once_;
  std::future<Expected<Expected<LiveOperatorSite>>> future_;
  double began_ = 0.0;
  double duration_ = 0.1;
};

}  // namespace pcavr
