// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/report/plot.hpp"

namespace pcavr {

/// At most the minimum, the maximum and one break of the points that follow each other in each of
/// `columns` > 0 columns of equal width; unchanged where it has no more points than that.
[[nodiscard]] PlotSeries decimated(const PlotSeries& full, int columns);

/// With as many decimals as a hundred-thousandth of the values' range needs; NaN stays.
[[nodiscard]] std::vector<double> rounded_to_range(std::vector<double> values);

}  // namespace pcavr
