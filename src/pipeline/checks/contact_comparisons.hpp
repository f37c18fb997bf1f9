// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/pipeline/consistency.hpp"

namespace pcavr {

/// The force and the tool's path against the objects, by the checks of `identify`: contacts at the
/// objects' surfaces, directions of force and motion, clocks, the force at rest. Adds a
/// contradiction where they find a fault, and warnings of what they put right.
[[nodiscard]] std::vector<InputComparison> compare_contacts(
    const Recording& recording, const PerceptionOptions& options,
    std::vector<ConsistencyFinding>& findings);

}  // namespace pcavr
