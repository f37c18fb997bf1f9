// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "pcavr/physics/object_identification/object_identification.hpp"

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

/// Adds a std of `share` of each sliding force, in the parameters and in what the report states.
inline void widen_sliding_forces(double share, ObjectIdentification& found) {
  for (std::vector<SlidingForce>* forces :
       {&found.parameters.sliding_force, &found.friction.sliding_force}) {
    for (SlidingForce& sliding : *forces) {
      sliding.std = std::hypot(sliding.std, share * sliding.force);
    }
  }
}

}  // namespace pcavr
