// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/pipeline/consistency.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// The force while the tool touches nothing, which should be 0: its bias, its drift, and the mass
/// of a tool whose weight would explain its vertical part. Adds a warning from 1 N on, and is then
/// contradicted by it. `input` has tool and force.
[[nodiscard]] InputComparison compare_force_at_rest(const IdentificationInput& input,
                                                    std::vector<ConsistencyFinding>& findings);

}  // namespace pcavr
