// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/free_noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/signals.hpp"

namespace pcavr {
namespace {

constexpr double kAroundContact = 0.3;    // [s] not free: a contact's slow rise, a filter's decay
constexpr std::size_t kMinRun = 50;       // samples without contact in a row
constexpr std::size_t kMinSamples = 250;  // of an axis: correlations within 0.06
constexpr double kMaxRepeated = 0.3;      // share of equal neighbours: rounded, or held
constexpr double kMaxCorrelation = 0.1;   // of noise that counts as white
constexpr double kWhiteStds = 4.0;        // of a correlation, where there are few samples

}  // namespace

std::array<FreeRuns, 3> free_runs(std::span<const double> t, const Segmentation& found,
                                  std::span<const Eigen::Vector3d> force) {
  std::array<FreeRuns, 3> runs;
  const double max_step = 2.5 * mean_interval(t);  // more is a row that is missing
  std::vector<Eigen::Vector3d> run;
  const auto end_run = [&] {
    for (std::size_t axis = 0; axis < 3 && run.size() >= kMinRun; ++axis) {
      runs[axis].push_back(axis_of(run, static_cast<int>(axis)));
    }
    run.clear();
  };
  auto next = found.contacts.begin();
  for (std::size_t i = 0; i < t.size(); ++i) {
    while (next != found.contacts.end() && t[i] > next->end + kAroundContact) ++next;
    const bool is_free = next == found.contacts.end() || t[i] < next->begin - kAroundContact;
    if (!is_free || (i > 0 && t[i] - t[i - 1] > max_step)) end_run();
    if (is_free) run.push_back(force[i] - found.bias_base[i]);
  }
  end_run();
  return runs;
}

double samples_of(const FreeRuns& runs) {
  double samples = 0.0;
  for (const std::vector<double>& run : runs) samples += static_cast<double>(run.size());
  return samples;
}

bool is_noisy(const FreeRuns& runs) {
  double equal = 0.0;
  for (const std::vector<double>& run : runs) {
    for (std::size_t i = 1; i < run.size(); ++i) equal += run[i] == run[i - 1] ? 1.0 : 0.0;
  }
  const double samples = samples_of(runs);
  return samples >= static_cast<double>(kMinSamples) && equal < kMaxRepeated * samples;
}

FreeRuns innovations(const FreeRuns& runs, const std::vector<double>& coefficients) {
  FreeRuns result;
  for (const std::vector<double>& run : runs) {
    std::vector<double>& left = result.emplace_back();
    for (std::size_t i = coefficients.size(); i < run.size(); ++i) {
      double value = run[i];
      for (std::size_t k = 0; k < coefficients.size(); ++k) {
        value -= coefficients[k] * run[i - 1 - k];
      }
      left.push_back(value);
    }
  }
  return result;
}

double std_of(const FreeRuns& runs) {
  std::vector<double> sizes;
  for (const std::vector<double>& run : runs) {
    for (const double value : run) sizes.push_back(std::abs(value));
  }
  return kStdOverMad * median(std::move(sizes));
}

std::vector<double> correlations_of(const FreeRuns& runs, std::size_t lags) {
  const double limit = kSpikeStds * std_of(runs);
  std::vector<double> correlations;
  double variance = 0.0;
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    double sum = 0.0, count = 0.0;
    for (const std::vector<double>& run : runs) {
      for (std::size_t i = lag; i < run.size(); ++i) {
        if (std::abs(run[i]) > limit || std::abs(run[i - lag]) > limit) continue;
        sum += run[i] * run[i - lag], count += 1.0;
      }
    }
    if (lag == 0) variance = sum / std::max(count, 1.0);
    if (lag > 0 && variance > 0.0) correlations.push_back(sum / std::max(count, 1.0) / variance);
  }
  return correlations;
}

double correlation_limit(const FreeRuns& runs) {
  return std::max(kMaxCorrelation, kWhiteStds / std::sqrt(samples_of(runs)));
}

}  // namespace pcavr
