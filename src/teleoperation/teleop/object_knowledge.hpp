// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

#include "teleoperation/teleop/background.hpp"
#include "teleoperation/teleop/online_identification.hpp"
#include "teleoperation/teleop/pending_identification.hpp"

namespace pcavr {

/// What the robot's site knows of one object's parameters, and when they are identified again. At
/// most one identification of contacts and one search run at a time, both in the background, and
/// each is used once, when it is due; one that fails, or that `forget` has overtaken, leaves what
/// was known. Not thread-safe.
class ObjectKnowledge {
 public:
  /// `given`: what is known at the start.
  ObjectKnowledge(const OnlineIdentification& given, const LearningOptions& options)
      : given_(given), current_(given), options_(options) {}

  [[nodiscard]] const OnlineIdentification& current() const { return current_; }
  [[nodiscard]] const ObjectParameters& parameters() const { return current_.known(); }
  /// Discards what was identified here, and what is being identified: the data were wrong.
  void forget();

  /// Plans the next identification where a slide has begun or stopped, or the contact has ended.
  void plan(bool begins_slide, bool ends_slide, bool ends_contact, double t);
  void plan_no_later_than(double t);
  [[nodiscard]] std::optional<double> planned() const { return planned_; }  ///< [s]
  /// Whether a contact is to be identified at `t` [s]; one in progress is of the data before: it is
  /// not waited for, but used first.
  [[nodiscard]] bool is_due(double t) const;
  /// A contact is identified as planned; the next time is set if the object slides.
  void begin_planned(double t, bool is_sliding);
  [[nodiscard]] bool was_planned_within(double t, double duration) const;  ///< [s]
  /// Whether the first law is to be looked for at `t` [s] in a press that began at `begin` [s];
  /// true at growing intervals: longer contacts take longer, so that all together cost a few times
  /// the last.
  [[nodiscard]] bool take_first_law_due(double t, double begin);

  /// A contact that is used to identify, on the tool's clock.
  struct UsedContact {
    double begin = 0.0, until = 0.0;  ///< [s]
    ContactFacts facts;
  };
  /// The newest of them.
  [[nodiscard]] const std::deque<UsedContact>& used() const { return used_; }
  /// In place of the last one if that began then.
  void use(const UsedContact& contact);
  /// Identifies the contacts from what is known. `ceiling` [N]: the force sensor's.
  void identify(const Background& background, double t, std::optional<double> ceiling,
                std::vector<ContactSamples> contacts);
  /// The same from what is given, where the clock was wrong: `old` is better than nothing until
  /// then.
  void identify_again(const Background& background, double t, std::optional<double> ceiling,
                      std::vector<ContactSamples> contacts, OnlineIdentification old);
  [[nodiscard]] bool has_identification() const { return identification_.has_value(); }
  [[nodiscard]] bool is_identification_due(double t) const {
    return identification_ && identification_->is_due(t);
  }
  /// A contact is being identified, or will be.
  [[nodiscard]] bool is_identifying() const { return planned_ || identification_; }
  /// Uses the result from now on; waits for the thread. Returns the last contact's begin [s].
  [[nodiscard]] Expected<double> apply_identification();

  /// Begins a search for friction if it would find another result than the last, and none is in
  /// progress. `suspected_turn` [rad]: of the force.
  void begin_search(const Background& background, double t, double suspected_turn);
  [[nodiscard]] bool has_search() const { return search_.has_value(); }
  [[nodiscard]] bool is_search_due(double t) const { return search_ && search_->pending.is_due(t); }
  /// Uses the result from now on; waits for the thread. False: it was obsolete.
  [[nodiscard]] Expected<bool> apply_search();
  /// Whether the use of a result at `t` [s] would wait for a thread.
  [[nodiscard]] bool would_wait(double t) const;

  /// The object has rested at `t` [s] under `friction` [N], more than the operator's site supposes
  /// possible; empty: it has not. After some time F_M is taken to be higher.
  void update_static_limit(double t, std::optional<double> friction);
  /// Why the limiting friction of the contact that began at `begin` [s] is not used, once for each.
  [[nodiscard]] std::optional<std::string> take_contradiction(double begin);

 private:
  /// Its pushes are by a clock that was wrong if it `is_obsolete`.
  struct Search {
    PendingSearch pending;
    bool is_obsolete = false;
  };

  OnlineIdentification given_;
  OnlineIdentification current_;
  LearningOptions options_;
  std::deque<UsedContact> used_ = {};
  std::optional<double> planned_ = {};               ///< [s]
  std::optional<double> last_planned_ = {};          ///< [s] that was identified
  std::optional<double> first_law_tried_ = {};       ///< [s]
  std::optional<double> above_limit_since_ = {};     ///< [s]
  std::optional<double> contradicted_contact_ = {};  ///< [s] the last one's begin
  // Last: their threads use what they refer to.
  std::optional<PendingIdentification> identification_ = {};
  std::optional<Search> search_ = {};
};

}  // namespace pcavr
