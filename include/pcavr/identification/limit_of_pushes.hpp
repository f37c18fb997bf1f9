// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/identification/parameter.hpp"

namespace pcavr {

/// F_M of all pushes.
struct LimitOfPushes {
  IdentifiedParameter limit;  ///< [N] its std is that of the mean
  double scatter = 0.0;       ///< [N] from push to push [paper C, eq. 10: STD]
};

/// The mean over pushes that scatter about it, by a prior of the scatter as a share
/// (FrictionPriors) and its likelihood, both marginalised on a grid. Those that are not excited do
/// not count.
[[nodiscard]] LimitOfPushes combine_limits(std::span<const IdentifiedParameter> limits,
                                           double scatter_share, double scatter_factor);

}  // namespace pcavr
