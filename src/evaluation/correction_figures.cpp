// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "correction_figures.hpp"

#include <algorithm>

namespace pcavr {
namespace {

bool is_good(const PoseError& error) { return error.translation < kGoodPosition; }

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

CorrectionEffect effect_of(const RunCorrection& correction, const std::vector<PoseError>& shown) {
  const auto then =
      std::lower_bound(shown.begin(), shown.end(), correction.stamp,
                       [](const PoseError& error, Stamp stamp) { return error.stamp < stamp; });
  CorrectionEffect effect;
  if (then == shown.end()) return effect;
  effect.error_then = then->translation;
  const auto good = std::find_if(then, shown.end(), is_good);
  if (good == shown.end()) return effect;
  effect.seconds_until_good = good == then ? 0.0 : to_seconds(good->stamp - correction.stamp);
  return effect;
}

Settling settling_of(const std::string& object, const std::vector<RunCorrection>& corrections,
                     const std::vector<PoseError>& shown, Duration round_trip) {
  Settling settling;
  if (shown.empty()) return settling;
  const auto arrived_by = [&](Stamp stamp) {
    return static_cast<std::size_t>(
        std::count_if(corrections.begin(), corrections.end(), [&](const RunCorrection& one) {
          return one.object == object && !one.is_lost && one.stamp + round_trip <= stamp;
        }));
  };
  settling.begins_good = is_good(shown.front());
  const auto first_good = std::find_if(shown.begin(), shown.end(), is_good);
  if (first_good == shown.end()) return settling;
  settling.corrections_until_good = arrived_by(first_good->stamp);
  settling.seconds_until_good = to_seconds(first_good->stamp - shown.front().stamp);
  const auto last_bad = std::find_if_not(shown.rbegin(), shown.rend(), is_good);
  if (last_bad == shown.rbegin()) return settling;
  settling.corrections_until_settled = last_bad == shown.rend() ? 0 : arrived_by(last_bad->stamp);
  return settling;
}

}  // namespace pcavr
