// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/object_identification/run_scatter.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/check.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMinRuns = 4;  // three others, to know their scatter
constexpr int kBisections = 60;      // to the last digits of a double

struct WeighedRuns {
  double mean = 0.0;
  double information = 0.0;
  double squares = 0.0;  ///< weighted, of the residuals
};

WeighedRuns weigh_runs(std::span<const ParameterValue> runs, double scatter) {
  WeighedRuns result;
  const auto weight = [scatter](const ParameterValue& run) {
    return 1.0 / (*run.std * *run.std + scatter * scatter);
  };
  for (const ParameterValue& run : runs) {
    result.information += weight(run);
    result.mean += weight(run) * run.value;
  }
  result.mean /= result.information;
  for (const ParameterValue& run : runs) {
    result.squares += weight(run) * std::pow(run.value - result.mean, 2);
  }
  return result;
}

double solve_scatter(std::span<const ParameterValue> runs) {
  const double expected = static_cast<double>(runs.size()) - 1.0;
  if (weigh_runs(runs, 0.0).squares <= expected) return 0.0;
  const auto [least, most] = std::minmax_element(
      runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  double low = 0.0;
  // More than the range of the values explains any residual.
  double high = most->value - least->value;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (weigh_runs(runs, middle).squares > expected ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

RunScatter scatter_of_runs(std::span<const ParameterValue> runs) {
  PCAVR_REQUIRE(!runs.empty());
  PCAVR_REQUIRE(std::all_of(runs.begin(), runs.end(), [](const ParameterValue& run) {
    return run.std && *run.std > 0.0 && std::isfinite(*run.std) && std::isfinite(run.value);
  }));
  const double scatter = solve_scatter(runs);
  const WeighedRuns found = weigh_runs(runs, scatter);
  return {found.mean, 1.0 / std::sqrt(found.information), scatter};
}

std::vector<double> deviations_of_runs(std::span<const ParameterValue> runs, double min_scatter) {
  std::vector<double> deviations(runs.size(), 0.0);
  if (runs.size() < kMinRuns) return deviations;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    std::vector<ParameterValue> others(runs.begin(), runs.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const RunScatter found = scatter_of_runs(others);
    const double scatter = std::max(found.scatter, min_scatter * std::abs(found.mean));
    const double std =
        std::sqrt(std::pow(*runs[i].std, 2) + scatter * scatter + found.std * found.std);
    deviations[i] = (runs[i].value - found.mean) / std;
  }
  return deviations;
}

}  // namespace pcavr
