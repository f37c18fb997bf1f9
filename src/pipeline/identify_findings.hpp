// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// Fills the table of parameters: value, std, and where a parameter is not identified, the motion
/// that would identify it. `slid` [s]: how long pushes moved the object.
void state_findings(IdentificationGoal goal, const IdentifiableObject& object, double slid,
                    ObjectIdentification& found);

}  // namespace pcavr
