// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"

namespace pcavr {

/// The contacts with an object, each with the path and the poses up to the middle of the time until
/// the next. `tracked` on the tool's clock.
[[nodiscard]] std::vector<std::shared_ptr<const Contact>> contacts_with_motion(
    const std::vector<Contact>& contacts, std::size_t object, const TipPath& tip,
    const std::vector<TrackedPose>& tracked);

/// The poses of an object on the tool's clock, which is `offset` [s] behind theirs.
[[nodiscard]] std::vector<TrackedPose> on_clock(std::vector<TrackedPose> tracked, double offset);

}  // namespace pcavr
