// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "robots/calibration/rig.hpp"

namespace pcavr {

/// Minimises the residuals of the views at these indices, in these units, by a loss that grows with
/// the logarithm of large ones [Cauchy]: wrong views hardly move it. The board's scale is kept.
[[nodiscard]] Rig refine_robustly(const std::vector<RigView>& views,
                                  const std::vector<std::size_t>& indices, const Rig& start,
                                  double position_unit, double rotation_unit);

}  // namespace pcavr
