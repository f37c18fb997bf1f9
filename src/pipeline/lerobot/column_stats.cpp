// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "column_stats.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/results/evaluation/trajectory_errors.hpp"

namespace pcavr {
namespace {

constexpr std::array<std::pair<const char*, double>, 5> kQuantiles{
    {{"q01", 0.01}, {"q10", 0.1}, {"q50", 0.5}, {"q90", 0.9}, {"q99", 0.99}}};

/// In the order of ColumnStats, without the count.
std::vector<double> stats_of(std::vector<double> values) {
  if (values.empty()) return std::vector<double>(4 + kQuantiles.size(), 0.0);
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  double mean = 0.0;
  for (const double value : values) mean += value / count;
  double variance = 0.0;
  for (const double value : values) variance += (value - mean) * (value - mean) / count;
  std::vector<double> stats{values.front(), values.back(), mean, std::sqrt(variance)};
  for (const auto& [name, share] : kQuantiles) stats.push_back(quantile(values, share));
  return stats;
}

}  // namespace

ColumnStats column_stats(const std::vector<std::vector<double>>& rows, std::size_t width) {
  ColumnStats stats;
  for (const char* name : {"min", "max", "mean", "std"}) stats.emplace_back(name, width);
  for (const auto& [name, share] : kQuantiles) stats.emplace_back(name, width);
  for (std::size_t component = 0; component < width; ++component) {
    std::vector<double> values;
    for (const std::vector<double>& row : rows) {
      if (!std::isnan(row[component])) values.push_back(row[component]);
    }
    const std::vector<double> found = stats_of(std::move(values));
    for (std::size_t i = 0; i < found.size(); ++i) stats[i].second[component] = found[i];
  }
  stats.emplace_back("count", std::vector<double>{static_cast<double>(rows.size())});
  return stats;
}

}  // namespace pcavr
