// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// The header of friction_atlas.csv, a line.
inline constexpr char kAtlasHeader[] = "object,support,recordings,key,value,std,unit,origin\n";

/// The rows of one object on one support: mu, F_M, B, the friction radius and the limit surface,
/// each with its std and its origin: identified or given, and "not identified" without a value.
/// `recordings`: number that the values rest on.
[[nodiscard]] std::string format_atlas_rows(const std::string& object, const std::string& support,
                                            std::size_t recordings,
                                            const ObjectParameters& parameters);

}  // namespace pcavr
