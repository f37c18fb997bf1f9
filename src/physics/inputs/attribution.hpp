// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"

#include "physics/inputs/body_poses.hpp"

namespace pcavr {

/// The contacts of a segmentation, each attributed to a body and a direction; unusable ones are
/// excluded.
[[nodiscard]] std::vector<Contact> attribute_contacts(
    const InputSeries& series, std::vector<Contact> contacts, const PathView& tip,
    std::span<const UnusableInterval> bad, const InputOptions& options, BodyPoses& poses);

}  // namespace pcavr
