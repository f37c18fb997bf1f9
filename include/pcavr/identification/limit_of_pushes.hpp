// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/identification/breakaway_motion.hpp"
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

/// F_M with what the slides say of it: limiting friction is not below Coulomb friction. Both are
/// Gaussian, the part of their distribution where F_M is below is cut off, and mean and std of the
/// rest are returned [moments of the truncated normal distribution: Johnson, Kotz & Balakrishnan
/// 1994, ch. 13]. Not excited where next to nothing would remain: where F_M is below by more than
/// `kLimitContradiction` stds, the two contradict each other.
[[nodiscard]] IdentifiedParameter limit_above_sliding(const IdentifiedParameter& limit,
                                                      const IdentifiedParameter& coulomb);
inline constexpr double kLimitContradiction = 3.0;

/// [N] Std of F_M, shared by all pushes of a body, where a force beside the centre turns the object
/// as it breaks away. The places of the support then slip one after the other, and the first have
/// fallen to sliding friction before the last ones hold their most: the peak is below F_M by up to
/// what it exceeds Coulomb friction by, `excess` [N]: on simulated LuGre plants by nothing up to a
/// twentieth of the friction radius, by 0.3 to 1.5 of the excess beyond a tenth, too different from
/// body to body to be added. `lever_share`: arm over friction radius.
[[nodiscard]] double turning_limit_std(double excess, double lever_share,
                                       const BreakawayPriors& priors = {});

}  // namespace pcavr
