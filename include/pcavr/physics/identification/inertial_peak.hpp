// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/parameter.hpp"

namespace pcavr {

/// Whether the peak of a push is the object's inertia and no friction limit: it was loaded within a
/// tenth of a second, and is further above the sliding friction than a limit is. Where contact law
/// and mass are known, `limit_of_push` takes the inertia off instead.
[[nodiscard]] bool is_inertial_peak(const Breakaway& peak, const IdentifiedParameter& sliding);

}  // namespace pcavr
