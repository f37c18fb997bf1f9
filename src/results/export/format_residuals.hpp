// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/results/export/exported_world.hpp"

namespace pcavr::detail {

/// Of formats with one coefficient: limiting static friction that they do not have. Nothing for
/// fixed bodies.
void add_static_friction_residual(const ExportedBody& body, const std::string& remark,
                                  ExportedWorld& world);

/// Of formats with a linear stiffness: the penetration under the working force.
void add_penetration_residual(const ExportedBody& body, double stiffness, ExportedWorld& world);

/// Error where an object has a name that the format reserves.
[[nodiscard]] Expected<void> check_reserved_name(const ExportedWorld& world,
                                                 const std::string& reserved,
                                                 const std::string& format);

}  // namespace pcavr::detail
