// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_clock.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr double kBin = 1.0;            // [s] of which the fastest round trip is kept
constexpr std::size_t kMaxBins = 60;    // a minute: drift by temperature is slower
constexpr double kDriftStd = 1e-4;      // of two quartz clocks, before any measurement
constexpr double kMinOffsetStd = 2e-5;  // [s] of the fastest round trip: scheduling of a process
// A true offset lies within half a round trip; a step is noticed beyond this [s], ...
constexpr double kStepMargin = 1e-3;
// ... by this many consecutive round trips: a single one may be a fault of the sender.
constexpr std::size_t kStepTrips = 4;
// A round trip that takes this much longer than the fastest [s], and this many variations, was
// delayed by a stalled network or a site that did not run; ...
constexpr double kMinStall = 0.1;
constexpr double kStallVariations = 8.0;
// ... if all do so for this long [s], the network has become slower.
constexpr double kMaxStall = 1.0;

bool is_plausible(const LinkClock::RoundTrip& trip) {
  const bool is_finite = std::isfinite(trip.sent) && std::isfinite(trip.received) &&
                         std::isfinite(trip.replied) && std::isfinite(trip.returned);
  return is_finite && trip.delay() >= 0.0 && trip.replied >= trip.received;
}

}  // namespace

void LinkClock::add(const RoundTrip& trip) {
  if (!is_plausible(trip)) return;
  if (is_known() && trip.delay() + kMinStall < min_delay_) restart();  // all before were stalled
  if (is_stalled(trip)) return;
  if (is_known() && contradicts(trip)) {
    contradicting_.push_back(trip);
    if (contradicting_.size() < kStepTrips) return;
    restart();
    ++steps_;
    for (const RoundTrip& later : contradicting_) keep(later);
    contradicting_.clear();
  } else {
    contradicting_.clear();
    const bool is_first = !is_known();
    const double variation = std::abs(trip.delay() - mean_delay_);
    mean_delay_ += (is_first ? 1.0 : 0.125) * (trip.delay() - mean_delay_);
    delay_variation_ += (is_first ? 0.0 : 0.25) * (variation - delay_variation_);
    if (is_first) delay_variation_ = 0.5 * trip.delay();
    keep(trip);
  }
  estimate();
}

bool LinkClock::is_stalled(const RoundTrip& trip) {
  const double margin = std::max(kMinStall, kStallVariations * delay_variation_);
  if (!is_known() || trip.delay() <= min_delay_ + margin) {
    stalled_since_.reset();
    return false;
  }
  if (!stalled_since_) stalled_since_ = trip.returned;
  return trip.returned - *stalled_since_ <= kMaxStall;
}

void LinkClock::restart() {
  fastest_.clear();
  stalled_since_.reset();
}

bool LinkClock::contradicts(const RoundTrip& trip) const {
  const double expected = shared_at(trip.returned) - trip.returned;
  const double age = std::abs(trip.returned - fastest_.back().returned);
  const double tolerance =
      0.5 * trip.delay() + max_asymmetry() + 3.0 * std_ + kDriftStd * age + kStepMargin;
  return std::abs(trip.offset() - expected) > tolerance;
}

void LinkClock::keep(const RoundTrip& trip) {
  if (fastest_.empty() ||
      std::floor(trip.returned / kBin) != std::floor(fastest_.back().returned / kBin)) {
    fastest_.push_back(trip);
    if (fastest_.size() > kMaxBins) fastest_.pop_front();
  } else if (trip.delay() < fastest_.back().delay()) {
    fastest_.back() = trip;
  }
}

void LinkClock::estimate() {
  min_delay_ = fastest_.front().delay();
  for (const RoundTrip& trip : fastest_) min_delay_ = std::min(min_delay_, trip.delay());
  reference_ = fastest_.back().returned;
  const double first = fastest_.front().offset();
  // Weighted least squares of offset - first = a + b x, with b of the drift's prior.
  double s = 0.0, sx = 0.0, sy = 0.0, sxy = 0.0, sxx = 1.0 / (kDriftStd * kDriftStd);
  for (const RoundTrip& trip : fastest_) {
    const double std = kMinOffsetStd + 0.5 * (trip.delay() - min_delay_);
    const double weight = 1.0 / (std * std);
    const double x = trip.returned - reference_;
    const double y = trip.offset() - first;
    s += weight;
    sx += weight * x;
    sy += weight * y;
    sxx += weight * x * x;
    sxy += weight * x * y;
  }
  const double determinant = s * sxx - sx * sx;
  offset_ = first + (sxx * sy - sx * sxy) / determinant;
  drift_ = (s * sxy - sx * sy) / determinant;
  std_ = std::sqrt(sxx / determinant);
}

double LinkClock::shared_at(double local) const {
  PCAVR_REQUIRE(is_known());
  return local + offset_ + drift_ * (local - reference_);
}

double LinkClock::local_at(double shared) const {
  PCAVR_REQUIRE(is_known());
  return (shared - offset_ + drift_ * reference_) / (1.0 + drift_);
}

}  // namespace pcavr
