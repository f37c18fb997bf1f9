// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "correction_metrics.hpp"

#include <algorithm>

namespace pcavr {
namespace {

bool is_within_tolerance(const PoseError& error) { return error.translation < kPositionTolerance; }

bool has_parameters(const RunCorrection& correction) {
  return std::any_of(correction.what.begin(), correction.what.end(), [](const std::string& what) {
    return what == "contact parameters" || what == "friction parameters";
  });
}

}  // namespace

CorrectionCounts count_corrections(const std::vector<RunCorrection>& corrections) {
  CorrectionCounts counts;
  for (const RunCorrection& correction : corrections) {
    ++counts.count;
    counts.lost += correction.is_lost ? 1 : 0;
    counts.bytes += correction.bytes;
    ++counts.by_case[correction.which];
    for (const std::string& what : correction.what) ++counts.by_what[what];
  }
  return counts;
}

std::optional<Stamp> first_parameters(const std::string& object,
                                      const std::vector<RunCorrection>& corrections,
                                      Duration round_trip) {
  std::optional<Stamp> first;
  for (const RunCorrection& one : corrections) {
    if (one.object != object || one.is_lost || !has_parameters(one)) continue;
    const Stamp arrival = one.stamp + round_trip;
    first = first ? std::min(*first, arrival) : arrival;
  }
  return first;
}

CorrectionEffect effect_of(const RunCorrection& correction, const std::vector<PoseError>& errors) {
  const auto start =
      std::lower_bound(errors.begin(), errors.end(), correction.stamp,
                       [](const PoseError& error, Stamp stamp) { return error.stamp < stamp; });
  CorrectionEffect effect;
  if (start == errors.end()) return effect;
  effect.initial_error = start->translation;
  const auto recovered = std::find_if(start, errors.end(), is_within_tolerance);
  if (recovered == errors.end()) return effect;
  effect.seconds_to_tolerance =
      recovered == start ? 0.0 : to_seconds(recovered->stamp - correction.stamp);
  return effect;
}

Settling settling_of(const std::string& object, const std::vector<RunCorrection>& corrections,
                     const std::vector<PoseError>& errors, Duration round_trip) {
  Settling settling;
  if (errors.empty()) return settling;
  const auto arrived_by = [&](Stamp stamp) {
    return static_cast<std::size_t>(
        std::count_if(corrections.begin(), corrections.end(), [&](const RunCorrection& one) {
          return one.object == object && !one.is_lost && one.stamp + round_trip <= stamp;
        }));
  };
  settling.starts_in_tolerance = is_within_tolerance(errors.front());
  const auto first_inside = std::find_if(errors.begin(), errors.end(), is_within_tolerance);
  if (first_inside == errors.end()) return settling;
  settling.corrections_to_tolerance = arrived_by(first_inside->stamp);
  settling.seconds_to_tolerance = to_seconds(first_inside->stamp - errors.front().stamp);
  const auto last_outside = std::find_if_not(errors.rbegin(), errors.rend(), is_within_tolerance);
  if (last_outside == errors.rbegin()) return settling;
  settling.corrections_until_settled =
      last_outside == errors.rend() ? 0 : arrived_by(last_outside->stamp);
  return settling;
}

}  // namespace pcavr
