// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>

#include "teleoperation/teleop/correction_trial.hpp"
#include "teleoperation/teleop/delayed_result.hpp"
#include "teleoperation/teleop/message.hpp"

namespace pcavr {

/// The trial of a correction by a thread: 2 to 20 ms of CPU, during most of which the robot's site
/// has to run its cycles. Its result applies from a fixed time of the data on, so that a replay
/// equals a live site. Uses the trial's world, which must outlive it, alone. Not thread-safe.
class PendingTrial {
 public:
  static constexpr double kDuration = 0.005;  ///< [s] of the data, until the result applies

  PendingTrial(const Background& background, double t, CorrectionTrial& trial,
               CorrectionMessage correction, CorrectionProposal proposal)
      : correction_(std::move(correction)),
        result_(background, kTask, t + kDuration,
                [&trial, proposal = std::move(proposal)] { return trial.evaluate(proposal); }) {}

  [[nodiscard]] std::size_t object() const { return correction_.object; }
  [[nodiscard]] bool is_due(double t) const { return result_.is_due(t); }
  [[nodiscard]] bool would_wait(double t) const { return result_.would_wait(t); }
  /// The correction without what was rejected. Waits for the thread. Once. An Error: it failed.
  [[nodiscard]] Expected<CorrectionMessage> take() {
    const Expected<TrialResult>& tried = result_.get();
    if (!tried) return tried.error();
    const TrialResult& result = *tried;
    if (result.rejects_pose) {
      correction_.pose.reset();
      correction_.twist.reset();
    }
    if (result.rejects_parameters) correction_.parameters = {};
    return std::move(correction_);
  }
  static constexpr char kTask[] = "the trial of a correction";

 private:
  CorrectionMessage correction_;
  DelayedResult<TrialResult> result_;
};

}  // namespace pcavr
