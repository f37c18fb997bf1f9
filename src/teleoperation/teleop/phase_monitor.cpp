// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/phase_monitor.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

// Time after which the line's start is known well enough to estimate the time of contact [s].
constexpr double kStampAfter = 0.150;
// [s] Longest time from the touch of a soft surface until its force is above the noise.
constexpr double kMaxTouchTime = 0.4;
// [s] Time in which the tip must advance: one that has just stopped relaxes its contact, which also
// looks like motion.
constexpr double kRecentTime = 0.020;
// An apparent speed below this ratio of the tool's is the line's fit error, not motion.
constexpr double kToolSpeedRatio = 0.35;
// A press whose force falls below this share of its maximum is unloaded.
constexpr double kUnloadedShare = 0.7;

}  // namespace

PhaseMonitor::PhaseMonitor(double t_start, const SensorProperties& sensors,
                           const PhaseMonitorOptions& options, bool is_movable)
    : sensors_(sensors),
      options_(options),
      is_movable_(is_movable),
      window_(options.min_speed_window) {
  changes_.push_back({t_start, MotionPhase::free});
}

void PhaseMonitor::change_to(double t, MotionPhase phase) {
  if (changes_.back().phase == phase) return;
  changes_.push_back({std::max(t, changes_.back().t), phase});
}

void PhaseMonitor::update_from_camera(double t, bool is_moving, bool is_near) {
  if (is_touched_) return;
  const MotionPhase at_rest = is_near ? MotionPhase::static_contact : MotionPhase::free;
  change_to(t, is_moving ? MotionPhase::sliding : at_rest);
}

std::optional<double> PhaseMonitor::displacement_at(double t) const {
  if (!is_touched_ || is_press_ || !line_.is_usable()) return std::nullopt;
  if (t < contact_.front().t || t > contact_.back().t) return std::nullopt;
  return displacement(contact_[first_after(t)]);
}

void PhaseMonitor::step(const MonitorSample& sample,
                        const std::optional<ParameterValue>& limiting_friction, double damping) {
  const double size = sample.force_base.norm();
  if (!is_touched_) {
    approach_.push_back({sample.t, sample.p_base_tip});
    while (approach_.front().t < sample.t - kMaxTouchTime) approach_.pop_front();
    const bool is_above = sample.is_within_reach && size > sensors_.enter_force;
    if (is_above && in_a_row_ == 0) above_since_ = sample.t;
    in_a_row_ = is_above ? in_a_row_ + 1 : 0;
    if (in_a_row_ == 0) opposite_base_.reset();
    if (in_a_row_ < options_.debounce_samples) return;
    begin_contact(sample);
  }
  if (has_turned(sample)) {
    opposite_base_ = -inward_base_;
    end_contact();
    return;
  }
  const double tip = sample.p_base_tip.dot(advance_base_);
  if (size > options_.leave_ratio * sensors_.enter_force) {
    last_loaded_ = sample.t;
    loaded_tip_ = tip;
  }
  // A tip that has drawn back has left; and so has one that goes on without a force: it has slipped
  // off an edge, or the object has gone ahead of it. The object may have been taken from a tip that
  // stays where it last pressed: a force that is low for a moment looks the same at first.
  const bool has_left =
      std::abs(tip - loaded_tip_) > std::max(options_.retraction, sensors_.tip_noise);
  if (!has_left) last_near_ = sample.t;
  const double unloaded = sample.t - last_loaded_;
  if (unloaded > (has_left ? options_.leave_time : options_.unloaded_time)) {
    if (!has_left) last_near_ = last_loaded_;
    end_contact();
    return;
  }
  const double force = sample.force_base.dot(direction_base_);
  process({sample.t, tip, without_damping(sample.t, tip, force, damping),
           sample.force_base.head<2>().norm()},
          limiting_friction);
}

bool PhaseMonitor::has_turned(const MonitorSample& sample) {
  const double force = sample.force_base.dot(direction_base_);
  const bool pulls = !is_press_ && force < -sensors_.enter_force;
  turned_in_a_row_ = pulls ? turned_in_a_row_ + 1 : 0;
  return turned_in_a_row_ >= options_.debounce_samples;
}

double PhaseMonitor::without_damping(double t, double tip, double force, double damping) const {
  if (damping <= 0.0 || force <= 0.0 || contact_.empty()) return force;
  if (!line_.is_ready()) {
    // The object is taken as static: the penetration grows with the tip's displacement.
    const Point& past = contact_[first_after(t - options_.rate_window)];
    const double rate = t > past.t ? (tip - past.tip) / (t - past.t) : 0.0;
    return force / std::max(1.0 + damping * rate, 0.5);
  }
  // Implicit in the penetration d: line(d) (1 + damping (d - before) / dt) = force. Bisection: the
  // left side grows with d, and d lies between the previous penetration and that of the whole
  // force.
  const double before = line_.penetration(contact_.back().force);
  const double per_step = damping / std::max(t - contact_.back().t, 1e-6);
  double low = std::min(before, line_.penetration(force));
  double high = std::max(before, line_.penetration(force));
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
  in_a_row_ = turned_in_a_row_ = 0;
  contact_begin_ = above_since_;
  last_loaded_ = last_near_ = sample.t;
  inward_base_ = opposite_base_.value_or(sample.direction_base);
  opposite_base_.reset();
  const double level = inward_base_.head<2>().norm();
  is_press_ = !is_movable_ || std::abs(inward_base_.z()) > level;
  direction_base_ = advance_base_ = inward_base_;
  if (!is_press_) {
    direction_base_ = Eigen::Vector3d(inward_base_.x(), inward_base_.y(), 0.0) / level;
    advance_base_ = inward_base_ / level;
  }
  touch_force_ = std::max(sample.force_base.dot(direction_base_), sensors_.enter_force);
  line_ = ContactLine(sample.p_base_tip.dot(advance_base_), touch_force_);
  is_line_final_ = has_slid_ = is_slow_slide_ = false;
  max_force_ = 0.0;
  contact_stamp_ = above_since_;
  next_for_line_ = 0;
  contact_.clear();
  speed_ = 0.0;
  fast_in_a_row_ = critical_in_a_row_ = 0;
  rest_since_ = above_since_;
  loaded_tip_ = sample.p_base_tip.dot(advance_base_);
  change_to(above_since_, MotionPhase::static_contact);
}

void PhaseMonitor::end_contact() {
  if (phase() == MotionPhase::sliding) end_slide();
  stamp_contact();
  is_touched_ = false;
  speed_ = 0.0;
  change_to(std::max(last_loaded_, last_near_), MotionPhase::free);
}

void PhaseMonitor::lose_force() {
  if (is_touched_) end_contact();
}

/// Its line is needed for its begin only, and a force that falls is on another one.
void PhaseMonitor::end_line_of_press(double force) {
  max_force_ = std::max(max_force_, force);
  if (is_line_final_ || force > kUnloadedShare * max_force_) return;
  is_line_final_ = true;
  stamp_contact();
}

void PhaseMonitor::process(const Point& point,
                           const std::optional<ParameterValue>& limiting_friction) {
  contact_.push_back(point);
  while (!is_line_final_ && contact_[next_for_line_].t < point.t - options_.line_guard) {
    const Point& past = contact_[next_for_line_++];
    if (past.force > sensors_.enter_force) line_.add(past.tip, past.force, sensors_.correlated);
  }
  if (!is_line_final_ && point.t - contact_.front().t > kStampAfter) stamp_contact();
  if (is_press_) return end_line_of_press(point.force);
  if (!line_.is_usable()) {
    if (!is_slow_slide_) update_static_phase(limiting_friction);
    return;
  }
  measure_speed();
  if (is_slow_slide_) {
    // Twice: at that speed force and motion show it now and then only.
    if (is_fast() && speed_ > 2.0 * options_.slide_speed) {
      is_slow_slide_ = false;
      has_slid_ = true;
    }
    return;
  }
  if (phase() == MotionPhase::sliding) {
    if (!is_slide_stamped_) stamp_slide();
    if (speed_ < std::max(0.4 * options_.slide_speed, 2.0 * speed_noise_)) end_slide();
    return;
  }
  if (is_fast()) begin_slide();
  if (phase() != MotionPhase::sliding) update_static_phase(limiting_friction);
}

bool PhaseMonitor::is_fast() {
  const Point& now = contact_.back();
  const double fast = std::max(options_.slide_speed, 4.0 * speed_noise_);
  const Point& recent = contact_[first_after(now.t - kRecentTime)];
  const bool advances = now.tip - recent.tip > 0.5 * fast * (now.t - recent.t);
  const bool is_moving = speed_ > std::max(fast, kToolSpeedRatio * tip_speed_) && advances;
  fast_in_a_row_ = is_moving ? fast_in_a_row_ + 1 : 0;
  return fast_in_a_row_ >= options_.debounce_samples;
}

void PhaseMonitor::begin_slow_slide(double t_onset) {
  if (!is_touched_ || is_press_ || phase() == MotionPhase::sliding || contact_.empty()) return;
  const double onset = std::max(t_onset, rest_since_);
  if (!is_line_final_) {
    // Samples of the slide are in the line: a soft contact.
    line_ = ContactLine(contact_.front().tip, touch_force_);
    for (const Point& past : contact_) {
      if (past.t > onset) break;
      if (past.force > sensors_.enter_force) line_.add(past.tip, past.force, sensors_.correlated);
    }
    is_line_final_ = true;
  }
  stamp_contact();
  is_slow_slide_ = is_slide_stamped_ = true;
  fast_in_a_row_ = 0;
  slide_detected_ = contact_.back().t;
  rest_displacement_ = displacement(contact_[std::min(first_after(onset), contact_.size() - 1)]);
  change_to(contact_.back().t, MotionPhase::sliding);
  const MonitoredPhase& previous = changes_[changes_.size() - 2];
  changes_.back().t = std::max(onset, previous.t);
  stamp_critical(onset);
}

void PhaseMonitor::end_slow_slide() {
  if (is_slow_slide_) end_slide();
}

void PhaseMonitor::update_static_phase(const std::optional<ParameterValue>& limiting_friction) {
  limit_ = limiting_friction;
  if (!limiting_friction) return;
  const double limit = limiting_friction->value;
  const Point& now = contact_.back();
  critical_in_a_row_ = now.friction > critical_force() ? critical_in_a_row_ + 1 : 0;
  const double noise = sensors_.force_noise;
  if (critical_in_a_row_ >= options_.debounce_samples) {
    change_to(contact_[contact_.size() - static_cast<std::size_t>(options_.debounce_samples)].t,
              MotionPhase::critical);
  } else if (phase() == MotionPhase::critical &&
             now.friction < critical_force() - std::max(0.02 * limit, noise)) {
    change_to(now.t, MotionPhase::static_contact);
  }
}

double PhaseMonitor::displacement(const Point& point) const {
  return point.tip - line_.surface() - line_.penetration(point.force);
}

std::size_t PhaseMonitor::first_after(double t) const {
  const auto found = std::lower_bound(contact_.begin(), contact_.end(), t,
                                      [](const Point& p, double at) { return p.t < at; });
  return static_cast<std::size_t>(found - contact_.begin());
}

double PhaseMonitor::mean_displacement(double from, double to) const {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = first_after(from); i < contact_.size() && contact_[i].t <= to; ++i) {
    sum += displacement(contact_[i]);
    count += 1.0;
  }
  return count > 0.0 ? sum / count : displacement(contact_.back());
}

double PhaseMonitor::min_displacement() const {
  return std::max(options_.min_displacement, 2.0 * displacement_noise(contact_.back().force));
}

double PhaseMonitor::displacement_noise(double force) const {
  // Noise of one raw sample: the tip's, and the force's through the line's slope.
  const double slope =
      (line_.penetration(force + 0.5) - line_.penetration(std::max(force - 0.5, 0.0)));
  return std::hypot(sensors_.tip_noise, slope * sensors_.force_noise);
}

void PhaseMonitor::measure_speed() {
  const double noise = displacement_noise(contact_.back().force);
  const auto speed_std = [&](double window) {
    return noise * std::sqrt(12.0 * sensors_.interval / window) / window;
  };
  // Least-squares slope over the shortest window that the noise allows.
  window_ = options_.min_speed_window;
  while (window_ < options_.max_speed_window && 4.0 * speed_std(window_) > options_.slide_speed)
    window_ += 0.01;
  speed_noise_ = speed_std(window_);
  const double end = contact_.back().t;
  double n = 0.0, t = 0.0, tt = 0.0, s = 0.0, st = 0.0, x = 0.0, xt = 0.0;
  const double surface = contact_.back().tip;
  for (std::size_t i = first_after(end - window_); i < contact_.size(); ++i) {
    const double at = contact_[i].t - end;
    const double tip = contact_[i].tip - surface;
    const double object = tip - line_.penetration(contact_[i].force);
    n += 1.0, t += at, tt += at * at, s += object, st += object * at, x += tip, xt += tip * at;
  }
  const double determinant = n * tt - t * t;
  if (n < 5.0 || determinant <= 0.0) return;
  speed_ = (n * st - t * s) / determinant;
  tip_speed_ = (n * xt - t * x) / determinant;
}

void PhaseMonitor::begin_slide() {
  const double now = contact_.back().t;
  const double rest_from = std::max(rest_since_, now - 2.0 * window_);
  const double rest = mean_displacement(rest_from, std::max(rest_from, now - window_));
  const double level = min_displacement();
  if (displacement(contact_.back()) - rest < level) return;
  rest_displacement_ = rest;
  is_line_final_ = has_slid_ = true;
  stamp_contact();
  is_slide_stamped_ = false;
  slide_detected_ = now;
  fast_in_a_row_ = 0;
  change_to(now, MotionPhase::sliding);
  stamp_slide();
}

double PhaseMonitor::critical_force() const {
  const double band = std::max(limit_->std.value_or(0.0), options_.critical_share * limit_->value);
  return limit_->value - band;
}

}  // namespace pcavr
