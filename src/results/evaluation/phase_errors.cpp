// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "phase_errors.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pcavr {
namespace {

Duration distance(Stamp a, Stamp b) { return a < b ? b - a : a - b; }

struct Candidate {
  Duration distance;
  std::size_t reference = 0;
  std::size_t estimate = 0;
};

/// Every pair of one kind within kMaxMatchDistance, the nearest first.
std::vector<Candidate> candidates(const std::vector<TimedEvent>& reference,
                                  const std::vector<TimedEvent>& estimate) {
  std::vector<Candidate> pairs;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const Stamp stamp = reference[i].stamp;
    const auto first =
        std::lower_bound(estimate.begin(), estimate.end(), stamp + -kMaxMatchDistance,
                         [](const TimedEvent& event, Stamp value) { return event.stamp < value; });
    for (auto it = first; it != estimate.end() && it->stamp <= stamp + kMaxMatchDistance; ++it) {
      if (it->event != reference[i].event) continue;
      pairs.push_back(
          {distance(stamp, it->stamp), i, static_cast<std::size_t>(it - estimate.begin())});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.distance, a.reference, a.estimate) <
           std::tie(b.distance, b.reference, b.estimate);
  });
  return pairs;
}

/// Greedy nearest-neighbour matching.
void match_events(const std::vector<TimedEvent>& reference, const std::vector<TimedEvent>& estimate,
                  Stamp begin, Stamp end, PhaseErrors& errors) {
  std::vector<std::optional<std::size_t>> match(reference.size());
  std::vector<bool> is_matched(estimate.size(), false);
  for (const Candidate& pair : candidates(reference, estimate)) {
    if (match[pair.reference] || is_matched[pair.estimate]) continue;
    match[pair.reference] = pair.estimate;
    is_matched[pair.estimate] = true;
  }
  const auto is_inside = [&](Stamp stamp) { return stamp >= begin && stamp <= end; };
  for (std::size_t i = 0; i < reference.size(); ++i) {
    if (!match[i] && !is_inside(reference[i].stamp)) continue;
    MatchedEvent& event = errors.events.emplace_back(MatchedEvent{reference[i]});
    if (match[i]) event.estimate = estimate[*match[i]].stamp;
  }
  for (std::size_t j = 0; j < estimate.size(); ++j) {
    if (!is_matched[j] && is_inside(estimate[j].stamp)) errors.surplus.push_back(estimate[j]);
  }
}

/// Adds up the confusion matrix over both timelines.
void add_seconds(const PhaseTimeline& reference, const PhaseTimeline& estimate, Stamp begin,
                 Stamp end, PhaseErrors& errors) {
  std::vector<Stamp> boundaries = {begin, end};
  for (const PhaseTimeline* timeline : {&reference, &estimate}) {
    for (const PhaseChange& change : *timeline) {
      if (change.stamp > begin && change.stamp < end) boundaries.push_back(change.stamp);
    }
  }
  std::sort(boundaries.begin(), boundaries.end());
  for (std::size_t i = 1; i < boundaries.size(); ++i) {
    const auto row = static_cast<std::size_t>(*phase_at(reference, boundaries[i - 1]));
    const auto column = static_cast<std::size_t>(*phase_at(estimate, boundaries[i - 1]));
    errors.seconds.at(row).at(column) += to_seconds(boundaries[i] - boundaries[i - 1]);
  }
}

}  // namespace

PhaseErrors phase_errors(const PhaseTimeline& reference, const PhaseTimeline& estimate, Stamp end) {
  PhaseErrors errors;
  if (reference.empty() || estimate.empty()) return errors;
  const Stamp begin = std::max(reference.front().stamp, estimate.front().stamp);
  match_events(events_of(reference), events_of(estimate), begin, end, errors);
  if (begin < end) add_seconds(reference, estimate, begin, end, errors);
  return errors;
}

std::vector<double> event_errors(const PhaseErrors& errors, std::optional<PhaseEvent> kind) {
  std::vector<double> seconds;
  for (const MatchedEvent& event : errors.events) {
    if (!event.estimate || (kind && event.reference.event != *kind)) continue;
    seconds.push_back(to_seconds(distance(event.reference.stamp, *event.estimate)));
  }
  return seconds;
}

std::size_t count_missed(const PhaseErrors& errors, std::optional<PhaseEvent> kind) {
  return static_cast<std::size_t>(
      std::count_if(errors.events.begin(), errors.events.end(), [&](const MatchedEvent& event) {
        return !event.estimate && (!kind || event.reference.event == *kind);
      }));
}

std::size_t count_surplus(const PhaseErrors& errors, std::optional<PhaseEvent> kind) {
  return static_cast<std::size_t>(
      std::count_if(errors.surplus.begin(), errors.surplus.end(),
                    [&](const TimedEvent& event) { return !kind || event.event == *kind; }));
}

PhaseErrors merged(const std::vector<PhaseErrors>& errors) {
  PhaseErrors sum;
  for (const PhaseErrors& one : errors) {
    sum.events.insert(sum.events.end(), one.events.begin(), one.events.end());
    sum.surplus.insert(sum.surplus.end(), one.surplus.begin(), one.surplus.end());
    for (std::size_t row = 0; row < kPhaseCount; ++row) {
      for (std::size_t column = 0; column < kPhaseCount; ++column) {
        sum.seconds.at(row).at(column) += one.seconds.at(row).at(column);
      }
    }
  }
  return sum;
}

double agreement(const PhaseErrors& errors, bool touched) {
  double same = 0.0;
  double all = 0.0;
  for (std::size_t row = 0; row < kPhaseCount; ++row) {
    for (std::size_t column = 0; column < kPhaseCount; ++column) {
      if (touched && row == 0 && column == 0) continue;  // free on both sides
      all += errors.seconds.at(row).at(column);
      if (row == column) same += errors.seconds.at(row).at(column);
    }
  }
  return all > 0.0 ? same / all : 0.0;
}

}  // namespace pcavr
