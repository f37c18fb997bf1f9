// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// The table of what was sought: value, deviation, and what motion would tell it where this one
/// did not.
void state_findings(IdentificationGoal goal, const IdentifiableObject& object,
                    ObjectIdentification& found);

}  // namespace pcavr
