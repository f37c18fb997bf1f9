// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace pcavr {

/// min, max, mean, std (of the population), q01, q10, q50, q90 and q99 of each component of a
/// feature, as policies are normalised by, and the number of rows ("count"). Rows that are NaN in a
/// component do not count there; of nothing all are 0.
using ColumnStats = std::vector<std::pair<std::string, std::vector<double>>>;

/// `rows` have equally many components, `width` of them.
[[nodiscard]] ColumnStats column_stats(const std::vector<std::vector<double>>& rows,
                                       std::size_t width);

}  // namespace pcavr
