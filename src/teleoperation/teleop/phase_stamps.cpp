// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// When a change of the phase happened, which is before it was detected.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "teleoperation/teleop/phase_monitor.hpp"

namespace pcavr {
namespace {

// An onset is extrapolated from two levels of the displacement, this factor apart.
constexpr double kLevels = 4.0;
// Time after which a slide is stamped with the available data [s].
constexpr double kSlideSettled = 0.080;
// Inertial force of a fast push over its friction [identification's README: 12 to 18 %].
constexpr double kInertialRatio = 0.2;
// [s] Time after a stop in which a force above the limit is still that of the slide.
constexpr double kStopTime = 0.020;

}  // namespace

void PhaseMonitor::stamp_contact() {
  if (!line_.is_ready() || contact_.empty()) return;
  const double t_touch = touch_time().value_or(contact_begin_);
  for (std::size_t i = changes_.size(); i-- > 1;) {
    if (changes_[i].phase != MotionPhase::static_contact || changes_[i].t != contact_stamp_)
      continue;
    changes_[i].t = contact_stamp_ = std::max(t_touch, changes_[i - 1].t);
    return;
  }
}

/// Time at which the tip passed the point where the contact line begins, before the force was above
/// its noise.
std::optional<double> PhaseMonitor::touch_time() const {
  const double surface = line_.surface();
  double t_after = contact_.front().t;
  double tip_after = contact_.front().tip;
  for (std::size_t i = approach_.size(); i-- > 0;) {
    const double t = approach_[i].t;
    const double tip = approach_[i].p_base_tip.dot(advance_base_);
    if (t >= t_after) continue;
    if (tip <= surface) {
      const double share = tip_after > tip ? (surface - tip) / (tip_after - tip) : 1.0;
      return std::min(t + std::clamp(share, 0.0, 1.0) * (t_after - t), contact_begin_);
    }
    t_after = t;
    tip_after = tip;
  }
  return std::nullopt;
}

void PhaseMonitor::stamp_slide(bool is_over) {
  const double now = contact_.back().t;
  const double level = min_displacement();
  const bool has_both = displacement(contact_.back()) - rest_displacement_ > kLevels * level;
  if (!has_both && !is_over && now - slide_detected_ < kSlideSettled) return;
  is_slide_stamped_ = true;
  // The last time below each level, so that noise before the onset is ignored.
  double t_low = now, t_high = now;
  for (std::size_t i = contact_.size(); i-- > 0;) {
    const double moved = displacement(contact_[i]) - rest_displacement_;
    if (moved > kLevels * level) t_high = contact_[i].t;
    if (moved > level) t_low = contact_[i].t;
    if (moved <= level || contact_[i].t < rest_since_) break;
  }
  // Extrapolation between a start at constant speed (a third) and an accelerated one (all).
  const double before = has_both ? 0.5 * (t_high - t_low) : 0.0;
  const double t_onset = std::max(t_low - before, rest_since_);
  const MonitoredPhase& previous = changes_[changes_.size() - 2];
  changes_.back().t = std::max(t_onset, previous.t);
  stamp_critical(t_onset);
}

void PhaseMonitor::stamp_critical(double t_onset) {
  double peak = 0.0;
  const std::size_t from = first_after(rest_since_);
  // The peak is not beyond the onset: the force that accelerates the object is not friction.
  for (std::size_t i = from; i < contact_.size() && contact_[i].t <= t_onset; ++i) {
    peak = std::max(peak, contact_[i].friction);
  }
  // Already reported by the known limit, unless the push contradicts that limit by more than the
  // inertial force of a fast push.
  const bool was_reported = changes_[changes_.size() - 2].phase == MotionPhase::critical;
  const bool is_consistent = limit_ && peak > (1.0 - kInertialRatio) * limit_->value &&
                             peak < (1.0 + kInertialRatio) * limit_->value;
  if (was_reported && is_consistent) return;
  double t_critical = t_onset;
  for (std::size_t i = first_after(t_onset); i-- > from;) {
    if (contact_[i].friction < (1.0 - options_.critical_share) * peak) break;
    t_critical = contact_[i].t;
  }
  const MonitoredPhase slide = changes_.back();
  changes_.pop_back();
  // A limit that this slide confirms was right before, too: when a short slip had unloaded the tip.
  const double revised_since = is_consistent ? t_critical : rest_since_;
  while (changes_.back().t > revised_since && changes_.back().phase != MotionPhase::sliding &&
         changes_.size() > 1) {
    changes_.pop_back();
  }
  if (t_critical < slide.t) change_to(t_critical, MotionPhase::critical);
  change_to(slide.t, slide.phase);
}

void PhaseMonitor::end_slide() {
  is_slow_slide_ = false;
  if (!is_slide_stamped_) stamp_slide(true);
  const double now = contact_.back().t;
  const double level = min_displacement();
  const double rest = mean_displacement(now - 0.5 * options_.min_speed_window, now);
  double t_low = now, t_high = now;
  for (std::size_t i = contact_.size(); i-- > 0;) {
    const double left = rest - displacement(contact_[i]);
    if (left < level) t_low = contact_[i].t;
    if (left < kLevels * level) t_high = contact_[i].t;
    if (left >= kLevels * level || contact_[i].t <= changes_.back().t) break;
  }
  const double t_stop = std::min(t_low + 0.5 * (t_low - t_high), now);
  rest_displacement_ = rest;
  rest_since_ = t_stop;
  speed_ = 0.0;
  critical_in_a_row_ = 0;
  change_to(t_stop, MotionPhase::static_contact);
  stamp_rest(t_stop);
}

/// The stop was detected late: evaluates the force since then.
void PhaseMonitor::stamp_rest(double t_stop) {
  if (!limit_) return;
  for (std::size_t i = first_after(t_stop); i < contact_.size(); ++i) {
    const bool is_critical = contact_[i].friction > critical_force();
    if (is_critical && contact_[i].t - t_stop < kStopTime) {
      if (changes_.back().phase == MotionPhase::static_contact && changes_.back().t == t_stop) {
        changes_.back().phase = MotionPhase::critical;
      }
    } else if (!is_critical && changes_.back().phase == MotionPhase::critical) {
      change_to(contact_[i].t, MotionPhase::static_contact);
      return;
    }
  }
}

}  // namespace pcavr
