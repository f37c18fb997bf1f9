// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/contact_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pcavr/physics/identification/segmentation.hpp"

#include "physics/inputs/body_poses.hpp"
#include "physics/inputs/clock_offsets.hpp"
#include "physics/inputs/touch_closure.hpp"

namespace pcavr {
namespace {

constexpr double kMaxTriedDelay = 0.6;  ///< [s] that is searched
constexpr double kMinChangeStds = 4.0;  ///< of a step, which is the best of several instants
constexpr double kMinChange = 0.010;    ///< [s] over the record: less is the contacts' own
constexpr double kMaxClockRate = 1e-3;  ///< clocks without a common reference differ by 1e-4
constexpr std::size_t kMinForDrift = 4;

/// A weighted line through delays, or two levels; what either leaves, in variances.
struct DelayFit {
  double change = 0.0, std = 0.0, squares = 0.0;
};

/// Sums of a weighted mean.
struct Level {
  double weight = 0.0, sum = 0.0, squares = 0.0;

  void add(const ContactDelay& one) {
    const double w = 1.0 / (one.std * one.std);
    weight += w, sum += w * one.delay, squares += w * one.delay * one.delay;
  }
  [[nodiscard]] double mean() const { return sum / weight; }
  [[nodiscard]] double rest() const { return std::max(squares - sum * sum / weight, 0.0); }
};

/// Stds are larger where the delays scatter by more than theirs.
double inflation(double squares, std::size_t count, std::size_t parameters) {
  if (count <= parameters) return 1.0;
  return std::sqrt(std::max(1.0, squares / static_cast<double>(count - parameters)));
}

DelayFit fit_levels(std::span<const ContactDelay> delays, std::size_t split) {
  Level before, after;
  for (std::size_t i = 0; i < delays.size(); ++i) (i < split ? before : after).add(delays[i]);
  const double squares = before.rest() + after.rest();
  return {
      after.mean() - before.mean(),
      inflation(squares, delays.size(), 2) * std::sqrt(1.0 / before.weight + 1.0 / after.weight),
      squares};
}

DelayFit fit_line(std::span<const ContactDelay> delays) {
  Level level, times;
  for (const ContactDelay& one : delays) {
    level.add(one);
    times.add({one.t, one.t, one.std});
  }
  double product = 0.0;
  for (const ContactDelay& one : delays) {
    product += (one.t - times.mean()) * (one.delay - level.mean()) / (one.std * one.std);
  }
  const double rate = product / times.rest(), squares = level.rest() - rate * product;
  return {rate, inflation(squares, delays.size(), 2) / std::sqrt(times.rest()), squares};
}

bool is_significant_change(double change, double std) {
  return std::abs(change) > kMinChangeStds * std && std::abs(change) > kMinChange;
}

double middle_of(const Contact& contact) { return 0.5 * (contact.begin + contact.end); }

/// By the contact law where the tip presses, else by where the tip touches and leaves the surface.
std::optional<ContactDelay> force_delay(const Contact& contact, double noise,
                                        const InputSeries& series, const PathView& tip,
                                        const BodyPoses& poses) {
  Segmentation alone;
  alone.contacts = {contact};
  alone.noise = noise;
  if (contact.kind == ContactKind::press && !contact.impact) {
    const TimeOffset fine = force_offset(alone, series.t_force, tip);
    if (fine.is_known) return ContactDelay{middle_of(contact), fine.offset, fine.std};
  }
  const TimeOffset touches = touch_closure(alone, series, tip, poses, kMaxTriedDelay).delay;
  if (!touches.is_known) return std::nullopt;
  return ContactDelay{middle_of(contact), touches.offset, touches.std};
}

TrackDelays track_delays(std::size_t body, const InputSeries& series,
                         const std::vector<BodySurface>& surfaces, const PathView& tip,
                         std::span<const Contact> contacts, const InputOptions& options) {
  std::vector<Contact> with_body;
  std::ranges::copy_if(contacts, std::back_inserter(with_body),
                       [body](const Contact& contact) { return contact.object == body; });
  const auto delay = [&](std::span<const Contact> of) {
    return camera_offset(series, surfaces, tip, of, options.segmentation.slide_half_width);
  };
  const TrackingOffset by_all = delay(with_body);
  TrackDelays track{.body = body, .offset = by_all, .may_be_shifted = by_all.is_ambiguous};
  for (const Contact& contact : with_body) {
    const TimeOffset late = delay(std::span(&contact, 1));
    if (late.is_known) track.contacts.push_back({middle_of(contact), late.offset, late.std});
  }
  return track;
}

}  // namespace

std::optional<DelayDrift> fit_delay_drift(std::span<const ContactDelay> delays) {
  if (delays.size() < kMinForDrift) return std::nullopt;
  const DelayFit line = fit_line(delays);
  return DelayDrift{line.change, line.std};
}

DelayChange find_delay_change(std::span<const ContactDelay> delays) {
  if (delays.size() < 2) return {};
  DelayStep best;
  DelayFit levels;
  for (std::size_t split = 1; split < delays.size(); ++split) {
    const DelayFit fit = fit_levels(delays, split);
    if (best.std > 0.0 && fit.squares >= levels.squares) continue;
    levels = fit;
    best = {delays[split - 1].t, delays[split].t, fit.change, fit.std};
  }
  const double span = delays.back().t - delays.front().t;
  const DelayFit drift = delays.size() < kMinForDrift ? DelayFit() : fit_line(delays);
  const bool is_drift = drift.std > 0.0 && std::abs(drift.change) < kMaxClockRate &&
                        is_significant_change(drift.change * span, drift.std * span);
  DelayChange change{.min_step = std::max(kMinChange, kMinChangeStds * best.std)};
  const bool is_step = is_significant_change(best.size, best.std);
  if (is_drift && (!is_step || drift.squares <= levels.squares)) {
    change.drift = DelayDrift{drift.change, drift.std};
  } else if (is_step) {
    change.step = best;
  }
  return change;
}

ContactDelays contact_delays(const InputSeries& series, std::span<const Contact> contacts,
                             const InputOptions& options) {
  ContactDelays delays;
  if (series.bodies.empty() || series.t_tool.size() < 2) return delays;
  std::vector<BodySurface> surfaces;
  for (const InputBody& body : series.bodies) surfaces.emplace_back(*body.model);
  const PathView tip(series.t_tool, series.p_base_tip);
  const BodyPoses poses(series.bodies, surfaces);
  const Segmentation found = segment_contacts(series.t_force, series.force_base, series.t_tool,
                                              series.p_base_tip, options.segmentation);
  for (const Contact& contact : found.contacts) {
    const auto one = force_delay(contact, found.noise, series, tip, poses);
    if (one) delays.force.push_back(*one);
  }
  for (std::size_t body = 0; body < series.bodies.size(); ++body) {
    TrackDelays track = track_delays(body, series, surfaces, tip, contacts, options);
    if (track.offset.std > 0.0) delays.tracks.push_back(std::move(track));
  }
  return delays;
}

}  // namespace pcavr
