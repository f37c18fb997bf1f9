// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {

/// Combines an object's friction that was identified now with what was identified `before` from
/// other data: both as normal distributions with their correlations, each weighted by its
/// information. A std contains what the two differ by beyond their stds (scatter_of_runs). Where
/// one of them that belong together (mass, coefficient and viscous friction; each other one alone)
/// differs by more than 5 stds, they are not combined: the new values replace the old ones, and a
/// note says so. Values without std and given ones, before or now, are not combined; nor are
/// contact laws.
void combine_with_known(const ObjectParameters& before, ObjectIdentification& found);

}  // namespace pcavr
