// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// Attributes each contact to a body and a direction, and excludes unusable ones.
[[nodiscard]] std::vector<AttributedContact> attribute_contacts(
    const InputSeries& series, const Segmentation& found, std::span<const double> t_force,
    const PathView& tip, std::span<const UnusableInterval> bad, const InputOptions& options,
    BodyPoses& poses);

}  // namespace pcavr
