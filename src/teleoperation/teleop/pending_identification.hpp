// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "teleoperation/teleop/delayed_result.hpp"
#include "teleoperation/teleop/online_identification.hpp"

namespace pcavr {

/// A contact's samples, copied: those of the site move on. The body that a record refers to must
/// outlive it.
class RecordedSamples {
 public:
  explicit RecordedSamples(const ContactRecord& record)
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
          ObjectMotion{{seen_->body.model, tracked_}, seen_->surface, seen_->tool_radius});
    }
    return record;
  }

 private:
  std::optional<ObjectMotion> seen_;  ///< without its poses
  std::vector<double> t_force_;
  std::vector<Eigen::Vector3d> force_base_;
  std::vector<double> t_tool_;
  std::vector<Eigen::Vector3d> p_base_tip_;
  std::vector<TrackedPose> tracked_;
};

/// The identification of contacts by a thread: some 5 ms of CPU for each, during most of which the
/// robot's site has to run its cycles. The result applies from a fixed time of the data on, so that
/// a replay equals a live site. Not thread-safe.
class PendingIdentification {
 public:
  static constexpr double kDuration =
      0.005;  ///< [s] of the data for each, until the result applies

  struct Contact {
    RecordedSamples samples;
    double begin = 0.0;  ///< [s]
    OnlineIdentification::ContactFacts facts;
  };

  /// Finds what `knowledge` would find at `t` [s], from copies of it and of the contacts, which are
  /// in order; at least one.
  PendingIdentification(const Background& background, double t,
                        const OnlineIdentification& knowledge, std::vector<Contact> contacts)
      : begin_(contacts.back().begin),
        result_(background, kTask, t + kDuration * static_cast<double>(contacts.size()),
                [knowledge = OnlineIdentification(knowledge),
                 contacts = std::move(contacts)]() mutable {
                  for (const Contact& contact : contacts) {
                    static_cast<void>(
                        knowledge.learn(contact.samples.record(), contact.begin, contact.facts));
                  }
                  return std::make_shared<OnlineIdentification>(std::move(knowledge));
                }) {}

  [[nodiscard]] bool is_due(double t) const { return result_.is_due(t); }
  [[nodiscard]] bool would_wait(double t) const { return result_.would_wait(t); }
  /// [s] Begin of the last contact.
  [[nodiscard]] double begin() const { return begin_; }
  /// Waits for the thread. Once. An Error: it failed.
  [[nodiscard]] Expected<OnlineIdentification> take() const {
    const Expected<std::shared_ptr<OnlineIdentification>>& knowledge = result_.get();
    if (!knowledge) return knowledge.error();
    return std::move(**knowledge);
  }
  static constexpr char kTask[] = "the identification of a contact";

 private:
  double begin_;
  DelayedResult<std::shared_ptr<OnlineIdentification>> result_;
};

/// The search for friction in all pushes of an object by a thread. The result applies from a fixed
/// time of the data on, as that of `PendingIdentification`. Not thread-safe.
class PendingSearch {
 public:
  PendingSearch(const Background& background, double t, FrictionSearch search)
      : result_(background, kTask, t + duration(search.pushes.size()),
                [search = std::move(search)] {
                  return std::make_shared<const FrictionSearch::Findings>(search.run());
                }) {}

  [[nodiscard]] bool is_due(double t) const { return result_.is_due(t); }
  [[nodiscard]] bool would_wait(double t) const { return result_.would_wait(t); }
  /// Waits for the thread. An Error: it failed.
  [[nodiscard]] const Expected<std::shared_ptr<const FrictionSearch::Findings>>& get() const {
    return result_.get();
  }
  static constexpr char kTask[] = "the search for friction";

 private:
  /// [s] of the data, until the result applies: twice the longest CPU time of 583 searches. One
  /// push takes 17 ms, at most 44; six take 78, at most 206.
  static double duration(std::size_t pushes) { return 0.1 + 0.05 * static_cast<double>(pushes); }

  DelayedResult<std::shared_ptr<const FrictionSearch::Findings>> result_;
};

}  // namespace pcavr
