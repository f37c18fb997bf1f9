// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/parameter.hpp"

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

/// The excess of F_M over the peak [N] where the object turns as it breaks away, with its std,
/// which all pushes of a body share. The places of the support then slip one after the other, and
/// the first have fallen to sliding friction before the last ones hold their most: of what F_M
/// exceeds Coulomb friction `coulomb` [N] by, e, the peak has shown only `excess` = e (1 - s) > 0
/// [N], with s uniform from 0 to the share that turning allows, and e log-normal
/// (BreakawayPriors::excess): the posterior of e by quadrature. Where all of it may be hidden, a
/// small excess says little, so that the prior decides. `turning`: travel of the support's rim, at
/// the friction radius, by the rotation over that of the centre, >= 0. Not excited where nothing is
/// hidden: 0 then.
[[nodiscard]] IdentifiedParameter excess_hidden_by_turning(double excess, double coulomb,
                                                           double turning,
                                                           const BreakawayPriors& priors = {});

}  // namespace pcavr
