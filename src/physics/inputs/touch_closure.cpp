// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/touch_closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace pcavr {
namespace {

// Force at which a contact begins and ends: a share of its peak, above noise.
constexpr double kLevel = 0.2;
constexpr double kLevelStds = 6.0;
constexpr double kStep = 0.01;     // [s] of the delays that are tried
constexpr int kRateSteps = 2;      // over which the gap's rate is taken, on either side
constexpr double kMinRate = 1e-3;  // [m/s] of an approach and of a retreat: slower is a rest
// The difference of the gaps at touch and separation that a sound contact leaves: noise of tip and
// tracking, faces that are not flat [m]; and a share of the depth, by which soft surfaces lag
// behind the tip.
constexpr double kClosureError = 0.001;
constexpr double kClosureShare = 0.1;
constexpr double kMargin = 0.1;         // [s] recorded before and after a contact
constexpr double kTrackingDelay = 0.1;  // [s] of cameras and trackers that is not corrected yet
/// Squares of a contact that does not fit at all, over their variance [m^2/m^2].
constexpr double kMaxSquare = 25.0;
constexpr double kMaxMeanSquare = 4.0;    // of contacts that fit
constexpr double kDecisiveSquares = 9.0;  // 3 stds: by which another delay fits worse
constexpr double kMinDelayStds = 3.0;     // of a delay that is one
constexpr double kMinDelayStd = 0.010;    // [s] by the force's threshold
constexpr double kSameDelay = 0.1;        // [s] closer delays are the same minimum

/// [s] First and last time of a contact at which its force has a level. The tip is equally deep
/// then; where the contact begins is extrapolated with the tip, whose clock is not known.
struct LoadedTimes {
  double begin = 0.0, end = 0.0;
};

std::optional<LoadedTimes> loaded_times(const Contact& contact, double noise) {
  const double level = std::max(kLevel * contact.peak_force, kLevelStds * noise);
  const auto is_loaded = [level](double force) { return force > level; };
  const auto first = std::find_if(contact.force.begin(), contact.force.end(), is_loaded);
  const auto last = std::find_if(contact.force.rbegin(), contact.force.rend(), is_loaded);
  if (first == contact.force.end()) return std::nullopt;
  const auto begin = static_cast<std::size_t>(first - contact.force.begin());
  const auto end = static_cast<std::size_t>(contact.force.rend() - last) - 1;
  return LoadedTimes{contact.t[begin], contact.t[end]};
}

/// Gaps of one contact's body at its begin and its end, for the tried delays of the force.
struct GapsOfContact {
  std::vector<double> begin, end;  ///< [m]
  double std = kClosureError;      ///< [m] of their difference
};

std::size_t count_of(double max_delay) {
  return 2 * static_cast<std::size_t>(std::lround(max_delay / kStep)) + 1;
}

class Closure {
 public:
  Closure(const Segmentation& found, const InputSeries& series, const PathView& tip,
          const BodyPoses& poses, double max_delay)
      : series_(series), tip_(tip), poses_(poses), max_delay_(max_delay) {
    for (const Contact& contact : found.contacts) {
      const std::optional<LoadedTimes> times = loaded_times(contact, found.noise);
      if (!contact.impact && times && is_whole(*times)) add(contact, *times);
    }
  }

  [[nodiscard]] std::size_t contacts() const { return contacts_.size(); }
  [[nodiscard]] double delay(std::size_t k) const {
    return kStep * static_cast<double>(k) - max_delay_;
  }

  /// Squares over their variance, summed over the contacts.
  [[nodiscard]] double squares(std::size_t k) const {
    double sum = 0.0;
    for (const GapsOfContact& contact : contacts_) sum += square(contact, k);
    return sum;
  }
  /// [s] Std of the delay there.
  [[nodiscard]] double std(std::size_t k) const {
    double information = 0.0;
    for (const GapsOfContact& contact : contacts_) {
      if (square(contact, k) >= kMaxSquare) continue;
      const double rate = rate_of(contact.end, k) - rate_of(contact.begin, k);
      information += std::pow(rate / contact.std, 2);
    }
    return std::hypot(kMinDelayStd, 1.0 / std::sqrt(information));
  }

 private:
  /// Whether force and tool were recorded before and after the contact: one that is cut shows no
  /// approach, or no retreat.
  [[nodiscard]] bool is_whole(const LoadedTimes& times) const {
    const auto is_within = [&times](std::span<const double> t) {
      return t.empty() || (t.front() + kMargin < times.begin && times.end < t.back() - kMargin);
    };
    return is_within(series_.t_force) && is_within(tip_.t());
  }
  void add(const Contact& contact, const LoadedTimes& times) {
    const std::optional<std::size_t> body = touched(contact);
    if (!body) return;
    const InputBody& of = series_.bodies[*body];
    // Without tracking, the place to which a push has moved the object is not known.
    const bool is_known =
        poses_.is_tracked(*body) || !of.is_movable || contact.kind == ContactKind::press;
    if (!is_known) return;
    GapsOfContact gaps;
    double deepest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < count_of(max_delay_); ++k) {
      // As the gap changes with time: the delay goes the other way.
      gaps.begin.push_back(gap(*body, times.begin - delay(k)));
      gaps.end.push_back(gap(*body, times.end - delay(k)));
      deepest = std::min({deepest, gaps.begin.back(), gaps.end.back()});
    }
    const std::size_t now = count_of(max_delay_) / 2;
    const double depth = std::max(0.0, gaps.begin[now] - deepest);
    gaps.std = std::hypot(kClosureError, kClosureShare * depth, moved_at(*body, times.end));
    contacts_.push_back(std::move(gaps));
  }
  /// The body that is closest to the tip during a contact.
  [[nodiscard]] std::optional<std::size_t> touched(const Contact& contact) const {
    const double middle = 0.5 * (contact.begin + contact.end);
    std::optional<std::size_t> body;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < series_.bodies.size(); ++i) {
      const double distance = gap(i, middle);
      if (distance < nearest) nearest = distance, body = i;
    }
    return body;
  }
  /// Length by which the body moves about `t` [m]: an error of its place where its tracking is
  /// late.
  [[nodiscard]] double moved_at(std::size_t body, double t) const {
    const Eigen::Vector3d p_base = tip_.at(t);
    const Pose before = poses_.at(body, t - kTrackingDelay);
    const Pose after = poses_.at(body, t + kTrackingDelay);
    return (after * (before.inverse() * p_base) - p_base).norm();
  }
  [[nodiscard]] double gap(std::size_t body, double t) const {
    return poses_.touch(body, t, tip_.at(t), series_.tool_radius).gap;
  }
  /// Rate of the gap over time [m/s].
  static double rate_of(const std::vector<double>& gaps, std::size_t k) {
    const std::size_t before = k + kRateSteps, after = k - kRateSteps;
    return (gaps[after] - gaps[before]) / (2.0 * kRateSteps * kStep);
  }
  static double square(const GapsOfContact& contact, std::size_t k) {
    const bool approaches = rate_of(contact.begin, k) < -kMinRate;
    const bool leaves = rate_of(contact.end, k) > kMinRate;
    const double difference = contact.end[k] - contact.begin[k];
    if (!approaches || !leaves || !std::isfinite(difference)) return kMaxSquare;
    return std::min(std::pow(difference / contact.std, 2), kMaxSquare);
  }

  const InputSeries& series_;
  const PathView& tip_;
  const BodyPoses& poses_;
  double max_delay_;
  std::vector<GapsOfContact> contacts_;
};

}  // namespace

TouchClosure touch_closure(const Segmentation& found, const InputSeries& series,
                           const PathView& tip, const BodyPoses& poses, double max_delay) {
  TouchClosure result;
  const Closure closure(found, series, tip, poses, max_delay);
  if (closure.contacts() == 0) return result;
  const std::size_t first = kRateSteps, last = count_of(max_delay) - kRateSteps;
  const auto count = static_cast<double>(closure.contacts());
  std::size_t best = first;
  for (std::size_t k = first; k < last; ++k) {
    if (closure.squares(k) < closure.squares(best)) best = k;
  }
  const double squares = closure.squares(best);
  const std::size_t now = count_of(max_delay) / 2;
  result.fits_as_written = closure.squares(now) <= kMaxMeanSquare * count;
  result.delay = {closure.delay(best), closure.std(best), 0.0, false};
  bool is_only_one = best > first && best + 1 < last;
  for (std::size_t k = first; k < last; ++k) {
    const double distance = std::abs(closure.delay(k) - result.delay.offset);
    const double same = std::max(kSameDelay, 5.0 * result.delay.std);
    if (distance > same && closure.squares(k) < squares + kDecisiveSquares) is_only_one = false;
  }
  result.delay.is_known = is_only_one && squares <= kMaxMeanSquare * count;
  result.is_decisive = result.delay.is_known && closure.squares(now) > squares + kDecisiveSquares &&
                       std::abs(result.delay.offset) > kMinDelayStds * result.delay.std;
  return result;
}

}  // namespace pcavr
