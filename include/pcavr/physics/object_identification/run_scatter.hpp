// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// One parameter in several runs, with a random effect of each run.
struct RunScatter {
  double mean = 0.0;  ///< weighted by 1 / (std^2 + scatter^2)
  double std = 0.0;   ///< of `mean`
  double scatter =
      0.0;  ///< std of the runs' own effects; 0 where their stds explain the differences
};

/// By the scatter under which the weighted squares of the runs' residuals are one less than the
/// runs [Paule and Mandel 1982]. `runs`: in one unit, with stds above 0; at least one. Pure.
[[nodiscard]] RunScatter scatter_of_runs(std::span<const ParameterValue> runs);

/// [stds] By which each run differs from the mean of the others, with the others' scatter; a
/// scatter of `min_scatter` (relative to their mean) is expected at any rate. Zeros for fewer
/// than four runs: three others are needed to know their scatter.
[[nodiscard]] std::vector<double> deviations_of_runs(std::span<const ParameterValue> runs,
                                                     double min_scatter);

}  // namespace pcavr
