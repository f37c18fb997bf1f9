// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// Adds a std of `share` of the value to those of `fields` that are not the values known before.
inline void widen_new(std::span<std::optional<ParameterValue> ObjectParameters::*const> fields,
                      double share, const ObjectParameters& known, ObjectParameters& parameters) {
  for (const auto field : fields) {
    std::optional<ParameterValue>& value = parameters.*field;
    const std::optional<ParameterValue>& before = known.*field;
    if (!value || !value->std || (before && before->value == value->value)) continue;
    value->std = std::hypot(*value->std, share * value->value);
  }
}

/// Adds a std of `share` of each sliding force.
inline void widen_sliding_forces(double share, ObjectParameters& parameters) {
  for (SlidingForce& sliding : parameters.sliding_force) {
    sliding.std = std::hypot(sliding.std, share * sliding.force);
  }
}

}  // namespace pcavr
