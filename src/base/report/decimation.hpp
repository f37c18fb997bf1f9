// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/report/plot.hpp"

namespace pcavr {

/// The series reduced to the minimum, the maximum and at most one break of the successive points in
/// each of `columns` > 0 columns of equal width; unchanged where it has no more points than that.
[[nodiscard]] PlotSeries decimated(const PlotSeries& full, int columns);

/// The values with as many decimals as a hundred-thousandth of their range needs; NaN stays.
[[nodiscard]] std::vector<double> rounded_to_range(std::vector<double> values);

}  // namespace pcavr
