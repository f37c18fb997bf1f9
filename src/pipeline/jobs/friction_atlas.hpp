// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// The header of friction_atlas.csv, a line.
inline constexpr char kAtlasHeader[] = "object,support,recordings,key,value,std,unit,origin\n";

/// Stds of a limit surface's coefficients in its scales; empty: not known.
using SurfaceStd = std::optional<std::array<double, 15>>;

/// The rows of one object on one support: mu, F_M, B, the friction radius and the limit surface,
/// each with its std and its origin: identified or given, and "not identified" without a value.
/// `recordings`: number that the values rest on.
[[nodiscard]] std::string format_atlas_rows(const std::string& object, const std::string& support,
                                            std::size_t recordings,
                                            const ObjectParameters& parameters,
                                            const SurfaceStd& surface_std);

/// By object, of the report.json of a pooled identification (write_pooled_report).
[[nodiscard]] Expected<std::map<std::string, SurfaceStd>> read_surface_stds(
    const std::filesystem::path& report);

}  // namespace pcavr
