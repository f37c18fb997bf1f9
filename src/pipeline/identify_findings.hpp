// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// Fills the table of parameters: value, std, and where a parameter is not identified, the motion
/// that would identify it.
void state_findings(IdentificationGoal goal, const IdentifiableObject& object,
                    ObjectIdentification& found);

}  // namespace pcavr
