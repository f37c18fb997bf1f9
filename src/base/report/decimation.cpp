// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "decimation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

namespace pcavr {
namespace {

struct ValueRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

ValueRange finite_range(const std::vector<double>& values) {
  ValueRange range;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    range.low = std::min(range.low, value);
    range.high = std::max(range.high, value);
  }
  return range;
}

bool is_break(const PlotSeries& series, std::size_t i) {
  return !std::isfinite(series.x[i]) || !std::isfinite(series.y[i]);
}

/// The points kept of those that follow each other in one column.
class Column {
 public:
  void add(const PlotSeries& series, std::size_t i) {
    if (is_break(series, i)) {
      break_ = i;
      return;
    }
    if (!low_ || series.y[i] < series.y[*low_]) low_ = i;
    if (!high_ || series.y[i] > series.y[*high_]) high_ = i;
  }

  void move_to(const PlotSeries& full, PlotSeries& kept) {
    std::vector<std::size_t> rows;
    for (const auto& row : {low_, high_, break_}) {
      if (row) rows.push_back(*row);
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (const std::size_t row : rows) {
      kept.x.push_back(full.x[row]);
      kept.y.push_back(full.y[row]);
    }
    *this = Column();
  }

 private:
  std::optional<std::size_t> low_, high_, break_;
};

}  // namespace

PlotSeries decimated(const PlotSeries& full, int columns) {
  if (full.x.size() <= 3 * static_cast<std::size_t>(columns)) return full;
  const ValueRange range = finite_range(full.x);
  if (!(range.high > range.low)) return full;
  PlotSeries kept{.label = full.label, .color = full.color, .dashed = full.dashed};
  Column column;
  double number = 0.0;  // of the column; a break without x belongs to the point before it
  for (std::size_t i = 0; i < full.x.size(); ++i) {
    if (std::isfinite(full.x[i])) {
      const double next = std::floor((full.x[i] - range.low) / (range.high - range.low) * columns);
      if (next != number) column.move_to(full, kept);
      number = next;
    }
    column.add(full, i);
  }
  column.move_to(full, kept);
  return kept;
}

std::vector<double> rounded_to_range(std::vector<double> values) {
  constexpr double kDigits = 5.0;
  const ValueRange range = finite_range(values);
  double span = range.high - range.low;
  if (!(span > 0.0)) span = std::abs(range.high);  // a constant
  if (!(span > 0.0) || !std::isfinite(span)) return values;
  const double decimals = std::clamp(kDigits - std::floor(std::log10(span)), 0.0, 15.0);
  const double scale = std::pow(10.0, decimals);
  // Divided, not multiplied: the quotient is the double nearest to the decimal number.
  for (double& value : values) value = std::round(value * scale) / scale + 0.0;  // no "-0"
  return values;
}

}  // namespace pcavr
