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

/// The identification of contacts by a thread: some 10 ms of CPU for each, during most of which the
/// robot's site has to run its cycles. The result applies from a fixed time of the data on, so that
/// a replay equals a live site. Not thread-safe.
class PendingIdentification {
 public:
  static constexpr double kDuration =
      0.010;  ///< [s] of the data for each, until the result applies

  /// Finds what `knowledge` would find at `t` [s], from copies of it and of the contacts, which are
  /// in order; at least one.
  PendingIdentification(const Background& background, double t,
                        const OnlineIdentification& knowledge, std::vector<ContactSamples> contacts)
      : begin_(contacts.back().begin),
        result_(background, kTask, t + kDuration * static_cast<double>(contacts.size()),
                [knowledge = OnlineIdentification(knowledge),
                 contacts = std::move(contacts)]() mutable {
                  for (const ContactSamples& contact : contacts) {
                    static_cast<void>(knowledge.learn(contact));
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

/// The identification of all parameters of an object by a thread. The result applies from a fixed
/// time of the data on, as that of `PendingIdentification`. Not thread-safe.
class PendingSearch {
 public:
  PendingSearch(const Background& background, double t, ObjectIdentifier identifier)
      : result_(background, kTask, t + duration(identifier.size()),
                [identifier = std::move(identifier)] {
                  return std::make_shared<const ObjectIdentifier::Result>(identifier.result());
                }) {}

  [[nodiscard]] bool is_due(double t) const { return result_.is_due(t); }
  [[nodiscard]] bool would_wait(double t) const { return result_.would_wait(t); }
  /// Waits for the thread. An Error: it failed.
  [[nodiscard]] const Expected<std::shared_ptr<const ObjectIdentifier::Result>>& get() const {
    return result_.get();
  }
  static constexpr char kTask[] = "the search for friction";

 private:
  /// [s] of the data, until the result applies: a site waits for one that takes longer.
  static double duration(std::size_t contacts) {
    return 0.1 + 0.05 * static_cast<double>(contacts);
  }

  DelayedResult<std::shared_ptr<const ObjectIdentifier::Result>> result_;
};

}  // namespace pcavr
