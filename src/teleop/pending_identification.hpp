// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "teleop/delayed_result.hpp"
#include "teleop/object_learner.hpp"

namespace pcavr {

/// The identification of a contact by a thread: some 5 ms of CPU, during most of which the robot's
/// site has to run its cycles. What is found applies from a fixed time of the data on, so that a
/// replay equals a live site. The body that a record refers to must outlive it. Not thread-safe.
class PendingIdentification {
 public:
  static constexpr double kDuration = 0.005;  ///< [s] of the data, until the result applies

  /// As `learner` would find at `t` [s], from copies of both.
  PendingIdentification(std::launch policy, double t, const ObjectLearner& learner,
                        const ContactRecord& record, double begin,
                        const ObjectLearner::ContactFacts& facts)
      : begin_(begin),
        result_(policy, t + kDuration,
                [learner = ObjectLearner(learner), data = Data(record), begin, facts]() mutable {
                  static_cast<void>(learner.learn(data.record(), begin, facts));
                  return std::make_shared<ObjectLearner>(std::move(learner));
                }) {}

  [[nodiscard]] bool is_due(double t) const { return result_.is_due(t); }
  [[nodiscard]] bool would_wait(double t) const { return result_.would_wait(t); }
  /// [s] Begin of the contact.
  [[nodiscard]] double begin() const { return begin_; }
  /// Waits for the thread. Once.
  [[nodiscard]] ObjectLearner take() const { return std::move(*result_.get()); }

 private:
  /// A record's samples: those of the site move on.
  class Data {
   public:
    explicit Data(const ContactRecord& record)
        : seen_(record.seen),
          t_force_(record.t_force.begin(), record.t_force.end()),
          force_base_(record.force_base.begin(), record.force_base.end()),
          t_tool_(record.t_tool.begin(), record.t_tool.end()),
          p_base_tip_(record.p_base_tip.begin(), record.p_base_tip.end()) {
      if (!record.seen) return;
      tracked_.assign(record.seen->body.tracked.begin(), record.seen->body.tracked.end());
    }
    [[nodiscard]] ContactRecord record() const {
      ContactRecord record{t_force_, force_base_, t_tool_, p_base_tip_, {}};
      if (seen_) {
        record.seen.emplace(
            SeenMotion{{seen_->body.model, tracked_}, seen_->surface, seen_->tool_radius});
      }
      return record;
    }

   private:
    std::optional<SeenMotion> seen_;  ///< without its poses
    std::vector<double> t_force_;
    std::vector<Eigen::Vector3d> force_base_;
    std::vector<double> t_tool_;
    std::vector<Eigen::Vector3d> p_base_tip_;
    std::vector<TrackedPose> tracked_;
  };

  double begin_;
  DelayedResult<std::shared_ptr<ObjectLearner>> result_;
};

}  // namespace pcavr
