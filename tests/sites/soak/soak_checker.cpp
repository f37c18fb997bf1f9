// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "sites/soak/soak_checker.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/core.h>

namespace pcavr {
namespace {

constexpr std::size_t kMaxViolations = 20;
constexpr double kWindow = 0.1;              // [s] of setpoints over which a speed is measured
constexpr double kRest = 0.02;               // [s] without a setpoint, after which the tool rests
constexpr double kRateTolerance = 2e-4;      // of the site's clock, which drifts
constexpr double kDistanceTolerance = 1e-9;  // [m]
constexpr std::size_t kMaxSessions = 8;      // that are remembered
constexpr double kMaxPress = 1e-4;           // [m] against a force above its limit: its noise

}  // namespace

void SoakChecker::violate(double t, const std::string& what) {
  if (violations_.size() < kMaxViolations)
    violations_.push_back(fmt::format("{:.4f} s: {}", t, what));
}

void SoakChecker::mix(std::uint64_t value) {
  for (int i = 0; i < 8; ++i) {
    digest_ = (digest_ ^ (value >> (8 * i) & 0xFFU)) * 1099511628211ULL;  // FNV-1a
  }
}
void SoakChecker::mix(double value) { mix(std::bit_cast<std::uint64_t>(value)); }

void SoakChecker::on_commanded(double t, std::uint32_t session, const LinkCommand& command) {
  mix(t);
  forget_sessions(session);
  auto& sent = sent_[session];
  sent[command.t] = {t, command.p_base_tip};
  const double oldest = command.t - 60.0;
  sent.erase(sent.begin(), sent.lower_bound(oldest));
}

void SoakChecker::forget_sessions(std::uint32_t newest) {
  if (sent_.contains(newest) || sent_.size() < kMaxSessions) return;
  for (auto it = sent_.begin(); it != sent_.end();) {
    it = it->first == session_ ? std::next(it) : sent_.erase(it);
  }
}

void SoakChecker::check_key(double t, const std::string& key, const char* what) {
  if (authorized_.contains(key)) return;
  const auto found = revoked_.find(key);
  if (found == revoked_.end()) return violate(t, fmt::format("{} of an unknown key", what));
  if (t > found->second + options_.revocation + 0.01) {
    violate(t,
            fmt::format("{} of a key that was revoked {:.3f} s before", what, t - found->second));
  }
}

void SoakChecker::on_session(double t, std::uint32_t session, const std::string& key) {
  mix(t);
  mix(std::uint64_t{session});
  if (!authorized_.contains(key)) violate(t, "a session begins with a key that is not authorised");
  session_ = session;
  newest_due_.reset();
}

void SoakChecker::on_executed(double t, std::uint32_t session, const std::string& key,
                              const LinkCommand& command) {
  mix(t);
  mix(command.t);
  ++executed_count_;
  last_command_ = t;
  check_key(t, key, "a command");
  if (session != session_) violate(t, "a command of another session was executed");
  if (newest_due_ && command.t <= *newest_due_) violate(t, "a command was executed out of order");
  newest_due_ = command.t;
  const auto of_session = sent_.find(session);
  if (of_session == sent_.end() || !of_session->second.contains(command.t)) {
    return violate(t, "a command was executed that was not sent, or twice");
  }
  const Sent sent = of_session->second.at(command.t);
  of_session->second.erase(command.t);
  if (sent.p_base_tip != command.p_base_tip) violate(t, "a command was changed under way");
  const double age = t - sent.t_sent;
  max_age_ = std::max(max_age_, age);
  const double limit =
      options_.max_network + options_.commands.max_lead + options_.commands.max_age;
  if (age > limit)
    violate(t, fmt::format("a command was executed {:.3f} s after it was sent", age));
  if (command.is_engaged) last_executed_ = t;
}

void SoakChecker::on_composed(double t, std::uint32_t session, const LinkCorrection& correction) {
  mix(t);
  Corrections& known = corrections_[session];
  known.composed[correction.number] = t;
  known.waiting[correction.number] = correction.bytes;
}

void SoakChecker::on_applied(double t, std::uint32_t session, const LinkCorrection& correction,
                             bool is_valid) {
  mix(t);
  mix(correction.t);
  ++applied_count_;
  if (!is_valid) violate(t, "a correction could not be applied");
  Corrections& known = corrections_[session];
  const std::uint32_t number = correction.number;
  if (number <= known.applied_in_order || known.applied_later.contains(number)) {
    return violate(t, fmt::format("correction {} was applied twice", number));
  }
  const auto found = known.waiting.find(number);
  if (found == known.waiting.end() || found->second != correction.bytes) {
    violate(t, fmt::format("correction {} is another one than was sent", number));
  }
  known.waiting.erase(number);
  // Corrections that arrive together are applied in the order of the time they speak of.
  known.applied_later.insert(number);
  while (known.applied_later.erase(known.applied_in_order + 1) > 0) ++known.applied_in_order;
}

void SoakChecker::on_delivered(double t, double sent) {
  if (sent <= newest_delivered_sent_) return;  // a repetition, or overtaken
  newest_delivered_sent_ = sent;
  const bool is_new = t > last_fresh_delivery_ + options_.commands.timeout;
  if (is_new || authorized_.empty()) connected_since_ = std::max(connected_since_, t);
  last_fresh_delivery_ = t;
}

/// Called in each cycle of the robot's site: one that did not run executes nothing.
void SoakChecker::check_execution(double t) {
  if (setpoints_.empty() || t > setpoints_.back().t + kRest) {
    connected_since_ = std::max(connected_since_, t);
  }
  if (t > last_fresh_delivery_ + options_.commands.timeout) return;
  const double idle = t - std::max(connected_since_, last_command_);
  if (idle < options_.recovery) return;
  violate(t, fmt::format("no command was executed for {:.2f} s, although messages arrive", idle));
  connected_since_ = t;
}

void SoakChecker::on_no_answers(double until) {
  connected_since_ = std::max(connected_since_, until);
}

void SoakChecker::on_robot_start(double t) {
  setpoints_.clear();
  connected_since_ = std::max(connected_since_, t);
  on_force(t, Eigen::Vector3d::Zero());
  last_fresh_delivery_ = std::max(last_fresh_delivery_, t - 1e-3);
  session_.reset();
}

void SoakChecker::on_setpoint(double t, const Eigen::Vector3d& p_base) {
  for (const double value : p_base) mix(value);
  const MotionLimits& limits = options_.limits;
  const bool is_inside =
      p_base.allFinite() &&
      (p_base.array() >= limits.workspace_min().array() - kDistanceTolerance).all() &&
      (p_base.array() <= limits.workspace_max().array() + kDistanceTolerance).all();
  if (!is_inside) violate(t, "the setpoint is outside the workspace");
  check_execution(t);
  check_motion(t, p_base);
  setpoints_.push_back({t, p_base});
  while (setpoints_.front().t < t - kWindow) setpoints_.pop_front();
}

void SoakChecker::check_motion(double t, const Eigen::Vector3d& p_base) {
  if (setpoints_.empty()) return;
  const MotionLimits& limits = options_.limits;
  const double dt = options_.cycle;
  const Setpoint& last = setpoints_.back();
  path_ += (p_base - last.p_base).norm();
  if (p_base != last.p_base &&
      t > last_fresh_delivery_ + options_.commands.timeout + limits.max_hold_time() + 5.0 * dt) {
    violate(
        t, fmt::format("the tool moves {:.3f} s after the last message", t - last_fresh_delivery_));
  }
  check_force(t, p_base - last.p_base);
  // Speeds are by true time: also a site that makes up for missed cycles moves within its limits.
  const Setpoint& first = setpoints_.front();
  const double distance = (p_base - first.p_base).cwiseAbs().maxCoeff();
  const double allowed = max_speed() * ((t - first.t) * (1.0 + kRateTolerance) + 1.5 * dt);
  if (distance > allowed) {
    violate(t, fmt::format("the setpoint moved {:.4f} m in {:.4f} s", distance, t - first.t));
  }
  if (setpoints_.size() < 2) return;
  const Setpoint& before = setpoints_[setpoints_.size() - 2];
  if (t - last.t > kRest || last.t - before.t > kRest) return;  // at rest meanwhile
  const Eigen::Vector3d change = (p_base - last.p_base) - (last.p_base - before.p_base);
  if (change.cwiseAbs().maxCoeff() > limits.max_acceleration * dt * dt + kDistanceTolerance) {
    violate(t, fmt::format("the setpoint's acceleration is {:.3f} m/s^2",
                           change.cwiseAbs().maxCoeff() / (dt * dt)));
  }
}

/// [m/s] A command that is at most `max_step` ahead permits no higher speed than the tool can brake
/// from on this way.
double SoakChecker::max_speed() const {
  const MotionLimits& limits = options_.limits;
  return std::min(limits.max_speed, std::sqrt(2.0 * limits.max_acceleration * limits.max_step) +
                                        limits.max_acceleration * options_.cycle);
}

void SoakChecker::on_force(double t, const Eigen::Vector3d& force_base) {
  force_base_ = force_base;
  if (force_base.norm() <= options_.limits.max_force) return pressed_since_.reset();
  if (pressed_since_ && force_base.dot(pressed_force_base_) > 0.0) return;
  // A force that turns against what it was is new, too, as an outlier of the sensor while the tool
  // leaves what it pressed: the tool has to stop from then on.
  pressed_since_ = t;
  pressed_force_base_ = force_base;
  pressed_on_ = 0.0;
  ++pressed_count_;
}

/// Above the limit of the force the tool comes to rest as in a hold, and does not press on.
void SoakChecker::check_force(double t, const Eigen::Vector3d& motion_base) {
  const double stop = options_.limits.max_hold_time() + 5.0 * options_.cycle;
  if (!pressed_since_ || t < *pressed_since_ + stop) return;
  pressed_on_ = std::max(0.0, pressed_on_ + motion_base.dot(force_base_.normalized()));
  if (pressed_on_ <= kMaxPress) return;
  violate(t, fmt::format("the tool presses on by {:.2f} mm with {:.1f} N", 1e3 * pressed_on_,
                         force_base_.norm()));
  pressed_on_ = 0.0;
}

void SoakChecker::check_recovered(double t) {
  mix(t);
  if (t - last_executed_ > 0.3) {
    violate(t, fmt::format("no command was executed for {:.2f} s, although the faults have ended",
                           t - last_executed_));
  }
  for (const auto& [session, known] : corrections_) {
    if (!known.applied_later.empty()) {
      violate(t, fmt::format("correction {} of session {} was lost", known.applied_in_order + 1,
                             session));
    }
    if (session != session_) continue;
    for (const auto& [number, bytes] : known.waiting) {
      if (t - known.composed.at(number) > options_.correction_time) {
        violate(t, fmt::format("correction {} has not been applied", number));
      }
    }
  }
}

}  // namespace pcavr
