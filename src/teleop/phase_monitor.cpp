// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/phase_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

// Samples in a row that must say the same before it counts.
constexpr int kInARow = 3;
// Share of the entering force below which a contact ends, and for how long [s].
constexpr double kLeaveShare = 0.5;
constexpr double kLeaveTime = 0.008;
// A tip has gone back from where it pressed [m].
constexpr double kRetreat = 1e-4;
// The newest stretch, in which the object may already move, is kept out of the line [s].
constexpr double kGuard = 0.080;
// By then the line's beginning is known well enough to say when the tip touched [s].
constexpr double kStampAfter = 0.150;
// Over which the tip's speed is taken where damping is looked at [s].
constexpr double kRateWindow = 0.012;
// Shortest and longest stretch over which the object's speed is measured [s].
constexpr double kShortWindow = 0.060;
constexpr double kLongWindow = 0.120;
// An onset is stamped by two levels of the way, this factor apart.
constexpr double kLevels = 4.0;
constexpr double kLately = 0.020;  // [s]
constexpr double kShareOfTool = 0.35;
constexpr double kMinLevel = 1e-4;  // [m]
// After this long a slide is stamped with what there is [s].
constexpr double kSlideSettled = 0.080;
constexpr double kInertialShare = 0.2;
// The format's share of the limit from which friction counts as critical.
constexpr double kCriticalShare = 0.9;

}  // namespace

PhaseMonitor::PhaseMonitor(double t_start, const MonitorOptions& options) : options_(options) {
  changes_.push_back({t_start, MotionPhase::free});
}

void PhaseMonitor::change_to(double t, MotionPhase phase) {
  if (changes_.back().phase == phase) return;
  changes_.push_back({std::max(t, changes_.back().t), phase});
}

void PhaseMonitor::see(double t, bool is_moving, bool is_near) {
  if (is_touched_) return;
  const MotionPhase at_rest = is_near ? MotionPhase::held : MotionPhase::free;
  change_to(t, is_moving ? MotionPhase::sliding : at_rest);
}

std::optional<double> PhaseMonitor::way_at(double t) const {
  if (!is_touched_ || is_press_ || !line_.is_usable()) return std::nullopt;
  if (t < contact_.front().t || t > contact_.back().t) return std::nullopt;
  return way(contact_[first_after(t)]);
}

void PhaseMonitor::step(const MonitorSample& sample,
                        const std::optional<ParameterValue>& limiting_friction, double damping) {
  const double size = sample.force_base.norm();
  if (!is_touched_) {
    const bool is_above = sample.is_within_reach && size > options_.enter_force;
    if (is_above && in_a_row_ == 0) above_since_ = sample.t;
    in_a_row_ = is_above ? in_a_row_ + 1 : 0;
    if (in_a_row_ < kInARow) return;
    begin_contact(sample);
  }
  const double tip = sample.p_base_tip.dot(direction_base_);
  if (size > kLeaveShare * options_.enter_force) {
    last_loaded_ = sample.t;
    loaded_tip_ = tip;
  }
  // A tip that stays where it last pressed still touches, if with less than the noise.
  const bool has_left = tip < loaded_tip_ - std::max(kRetreat, options_.tip_noise);
  if (!has_left) last_near_ = sample.t;
  if (has_left && sample.t - last_loaded_ > kLeaveTime) {
    end_contact();
    return;
  }
  const double force = sample.force_base.dot(direction_base_);
  follow({sample.t, tip, without_damping(sample.t, tip, force, damping),
          sample.force_base.head<2>().norm()},
         limiting_friction);
}

double PhaseMonitor::without_damping(double t, double tip, double force, double damping) const {
  if (damping <= 0.0 || force <= 0.0 || contact_.empty()) return force;
  if (!line_.is_ready()) {
    // The object stands, as far as is known: the depth grows as the tip goes.
    const Point& past = contact_[first_after(t - kRateWindow)];
    const double rate = t > past.t ? (tip - past.tip) / (t - past.t) : 0.0;
    return force / std::max(1.0 + damping * rate, 0.5);
  }
  // Implicit in the depth d: line(d) (1 + damping (d - before) / dt) = force; the left side grows
  // with d, and d lies between the depth before and the one that the whole force would hold.
  const double before = line_.depth(contact_.back().force);
  const double per_step = damping / std::max(t - contact_.back().t, 1e-6);
  double low = std::min(before, line_.depth(force));
  double high = std::max(before, line_.depth(force));
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    const bool is_above =
        line_.force(middle) * std::max(1.0 + per_step * (middle - before), 0.0) > force;
    (is_above ? high : low) = middle;
  }
  return line_.force(0.5 * (low + high));
}

double PhaseMonitor::resting_force() const {
  return contact_.empty() ? 0.0 : contact_.back().force;
}

void PhaseMonitor::begin_contact(const MonitorSample& sample) {
  is_touched_ = true;
  in_a_row_ = 0;
  contact_begin_ = above_since_;
  last_loaded_ = last_near_ = sample.t;
  const Eigen::Vector3d& inward = sample.direction_base;
  is_press_ = std::abs(inward.z()) > inward.head<2>().norm();
  direction_base_ = inward;
  if (!is_press_) direction_base_ = Eigen::Vector3d(inward.x(), inward.y(), 0.0).normalized();
  line_ = ContactLine(sample.p_base_tip.dot(direction_base_),
                      std::max(sample.force_base.dot(direction_base_), options_.enter_force));
  is_line_final_ = is_contact_stamped_ = false;
  next_for_line_ = 0;
  contact_.clear();
  speed_ = 0.0;
  fast_in_a_row_ = critical_in_a_row_ = 0;
  rest_since_ = above_since_;
  loaded_tip_ = sample.p_base_tip.dot(direction_base_);
  change_to(above_since_, MotionPhase::held);
}

void PhaseMonitor::end_contact() {
  if (phase() == MotionPhase::sliding) end_slide();
  stamp_contact();
  is_touched_ = false;
  speed_ = 0.0;
  change_to(std::max(last_loaded_, last_near_), MotionPhase::free);
}

void PhaseMonitor::follow(const Point& point,
                          const std::optional<ParameterValue>& limiting_friction) {
  contact_.push_back(point);
  if (is_press_) return;
  while (!is_line_final_ && contact_[next_for_line_].t < point.t - kGuard) {
    const Point& past = contact_[next_for_line_++];
    if (past.force > options_.enter_force) line_.add(past.tip, past.force, options_.correlated);
  }
  if (point.t - contact_.front().t > kStampAfter) stamp_contact();
  if (!line_.is_usable()) {
    judge_rest(limiting_friction);
    return;
  }
  measure_speed();
  if (phase() == MotionPhase::sliding) {
    if (!is_slide_stamped_) stamp_slide();
    if (speed_ < std::max(0.4 * options_.slide_speed, 2.0 * speed_noise_)) end_slide();
    return;
  }
  const double fast = std::max(options_.slide_speed, 4.0 * speed_noise_);
  // Slower than a good part of the tool's advance is the line's misfit, not the object.
  // A tip that has just come to rest relaxes the contact, which looks like a way, too.
  const Point& lately = contact_[first_after(point.t - kLately)];
  const bool advances = point.tip - lately.tip > 0.5 * fast * (point.t - lately.t);
  const bool is_fast = speed_ > std::max(fast, kShareOfTool * tip_speed_) && advances;
  fast_in_a_row_ = is_fast ? fast_in_a_row_ + 1 : 0;
  if (fast_in_a_row_ >= kInARow) begin_slide();
  if (phase() != MotionPhase::sliding) judge_rest(limiting_friction);
}

void PhaseMonitor::judge_rest(const std::optional<ParameterValue>& limiting_friction) {
  limit_ = limiting_friction;
  if (!limiting_friction) return;
  const double limit = limiting_friction->value;
  const Point& now = contact_.back();
  critical_in_a_row_ = now.friction > critical_force() ? critical_in_a_row_ + 1 : 0;
  const double noise = options_.force_noise;
  if (critical_in_a_row_ >= kInARow) {
    change_to(contact_[contact_.size() - static_cast<std::size_t>(kInARow)].t,
              MotionPhase::critical);
  } else if (phase() == MotionPhase::critical &&
             now.friction < critical_force() - std::max(0.02 * limit, noise)) {
    change_to(now.t, MotionPhase::held);
  }
}

double PhaseMonitor::way(const Point& point) const {
  return point.tip - line_.surface() - line_.depth(point.force);
}

std::size_t PhaseMonitor::first_after(double t) const {
  const auto found = std::lower_bound(contact_.begin(), contact_.end(), t,
                                      [](const Point& p, double at) { return p.t < at; });
  return static_cast<std::size_t>(found - contact_.begin());
}

double PhaseMonitor::mean_way(double from, double to) const {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = first_after(from); i < contact_.size() && contact_[i].t <= to; ++i) {
    sum += way(contact_[i]);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : way(contact_.back());
}

double PhaseMonitor::way_noise(double force) const {
  // Of one raw sample: the tip's, and the force's through the line's slope.
  const double slope = (line_.depth(force + 0.5) - line_.depth(std::max(force - 0.5, 0.0)));
  return std::hypot(options_.tip_noise, slope * options_.force_noise);
}

void PhaseMonitor::measure_speed() {
  const double noise = way_noise(contact_.back().force);
  const auto deviation = [&](double window) {
    return noise * std::sqrt(12.0 * options_.interval / window) / window;
  };
  // As short as the noise allows.
  window_ = kShortWindow;
  while (window_ < kLongWindow && 4.0 * deviation(window_) > options_.slide_speed) window_ += 0.01;
  speed_noise_ = deviation(window_);
  const double end = contact_.back().t;
  double n = 0.0, t = 0.0, tt = 0.0, s = 0.0, st = 0.0, x = 0.0, xt = 0.0;
  const double surface = contact_.back().tip;
  for (std::size_t i = first_after(end - window_); i < contact_.size(); ++i) {
    const double at = contact_[i].t - end;
    const double tip = contact_[i].tip - surface;
    const double object = tip - line_.depth(contact_[i].force);
    n += 1.0, t += at, tt += at * at, s += object, st += object * at, x += tip, xt += tip * at;
  }
  const double spread = n * tt - t * t;
  if (n < 5.0 || spread <= 0.0) return;
  speed_ = (n * st - t * s) / spread;
  tip_speed_ = (n * xt - t * x) / spread;
}

void PhaseMonitor::begin_slide() {
  const double now = contact_.back().t;
  const double rest_from = std::max(rest_since_, now - 2.0 * window_);
  const double rest = mean_way(rest_from, std::max(rest_from, now - window_));
  const double level = std::max(kMinLevel, 2.0 * way_noise(contact_.back().force));
  if (way(contact_.back()) - rest < level) return;
  rest_way_ = rest;
  is_line_final_ = true;
  stamp_contact();
  is_slide_stamped_ = false;
  seen_since_ = now;
  fast_in_a_row_ = 0;
  change_to(now, MotionPhase::sliding);
  stamp_slide();
}

void PhaseMonitor::stamp_slide() {
  const double now = contact_.back().t;
  const double level = std::max(kMinLevel, 2.0 * way_noise(contact_.back().force));
  const bool has_both = way(contact_.back()) - rest_way_ > kLevels * level;
  if (!has_both && now - seen_since_ < kSlideSettled) return;
  is_slide_stamped_ = true;
  // Last time below each level, so that noise before the onset does not count.
  double t_low = now, t_high = now;
  for (std::size_t i = contact_.size(); i-- > 0;) {
    const double gone = way(contact_[i]) - rest_way_;
    if (gone > kLevels * level) t_high = contact_[i].t;
    if (gone > level) t_low = contact_[i].t;
    if (gone <= level || contact_[i].t < rest_since_) break;
  }
  // Between an even start (a third) and an accelerated one (the whole).
  const double before = has_both ? 0.5 * (t_high - t_low) : 0.0;
  const double t_onset = std::max(t_low - before, rest_since_);
  const MonitoredPhase& previous = changes_[changes_.size() - 2];
  changes_.back().t = std::max(t_onset, previous.t);
  stamp_critical(t_onset);
}

void PhaseMonitor::stamp_critical(double t_onset) {
  double peak = 0.0;
  const std::size_t from = first_after(rest_since_);
  // Not beyond the onset: what accelerates the object is no friction.
  for (std::size_t i = from; i < contact_.size() && contact_[i].t <= t_onset; ++i) {
    peak = std::max(peak, contact_[i].friction);
  }
  // A known limit has already told it, unless the push speaks against it by more than the force
  // that accelerates an object adds to a fast one [identification's README: 12 to 18 %].
  const bool was_told = changes_[changes_.size() - 2].phase == MotionPhase::critical;
  const bool is_borne_out = limit_ && peak > (1.0 - kInertialShare) * limit_->value &&
                            peak < (1.0 + kInertialShare) * limit_->value;
  if (was_told && is_borne_out) return;
  double t_critical = t_onset;
  for (std::size_t i = first_after(t_onset); i-- > from;) {
    if (contact_[i].friction < kCriticalShare * peak) break;
    t_critical = contact_[i].t;
  }
  const MonitoredPhase slide = changes_.back();
  changes_.pop_back();
  while (changes_.back().t > rest_since_ && changes_.back().phase != MotionPhase::sliding &&
         changes_.size() > 1) {
    changes_.pop_back();
  }
  if (t_critical < slide.t) change_to(t_critical, MotionPhase::critical);
  change_to(slide.t, slide.phase);
}

void PhaseMonitor::end_slide() {
  if (!is_slide_stamped_) {
    seen_since_ = -1e300;
    stamp_slide();
  }
  const double now = contact_.back().t;
  const double level = std::max(kMinLevel, 2.0 * way_noise(contact_.back().force));
  const double rest = mean_way(now - 0.5 * kShortWindow, now);
  double t_low = now, t_high = now;
  for (std::size_t i = contact_.size(); i-- > 0;) {
    const double left = rest - way(contact_[i]);
    if (left < level) t_low = contact_[i].t;
    if (left < kLevels * level) t_high = contact_[i].t;
    if (left >= kLevels * level || contact_[i].t <= changes_.back().t) break;
  }
  const double t_stop = std::min(t_low + 0.5 * (t_low - t_high), now);
  rest_way_ = rest;
  rest_since_ = t_stop;
  speed_ = 0.0;
  critical_in_a_row_ = 0;
  change_to(t_stop, MotionPhase::held);
  stamp_rest(t_stop);
}

/// The stop was noticed late: what the force has said since.
void PhaseMonitor::stamp_rest(double t_stop) {
  if (!limit_) return;
  for (std::size_t i = first_after(t_stop); i < contact_.size(); ++i) {
    const bool is_critical = contact_[i].friction > critical_force();
    if (is_critical && contact_[i].t - t_stop < kLately) {
      if (changes_.back().phase == MotionPhase::held && changes_.back().t == t_stop) {
        changes_.back().phase = MotionPhase::critical;
      }
    } else if (!is_critical && changes_.back().phase == MotionPhase::critical) {
      change_to(contact_[i].t, MotionPhase::held);
      return;
    }
  }
}

double PhaseMonitor::critical_force() const {
  const double band =
      std::max(limit_->deviation.value_or(0.0), (1.0 - kCriticalShare) * limit_->value);
  return limit_->value - band;
}

void PhaseMonitor::stamp_contact() {
  if (is_contact_stamped_ || !line_.is_ready()) return;
  is_contact_stamped_ = true;
  // Back from the first sample known to be in contact to where the tip met the surface; the speed
  // there is that of the first samples.
  const std::size_t early = std::min<std::size_t>(contact_.size() - 1, 20);
  const double passed = contact_[early].t - contact_.front().t;
  const double advance = contact_[early].tip - contact_.front().tip;
  if (passed <= 0.0 || advance <= 0.0) return;
  const double inside = std::max(contact_.front().tip - line_.surface(), 0.0);
  const double back = std::min(inside * passed / advance, kGuard);
  const double t_touch = contact_.front().t - back;
  for (std::size_t i = changes_.size(); i-- > 1;) {
    if (changes_[i].phase != MotionPhase::held || changes_[i].t < contact_begin_) continue;
    if (changes_[i].t == contact_begin_) {
      changes_[i].t = std::max(std::min(t_touch, contact_begin_), changes_[i - 1].t);
    }
  }
}

}  // namespace pcavr
