// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// Every number of an object: what is known of it, and what was assumed.
[[nodiscard]] std::vector<ExportedNumber> numbers_of(const std::string& object,
                                                     const ObjectParameters& known,
                                                     const CompletedPhysics& completed);

}  // namespace pcavr::detail
