// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// A row of the friction atlas.
struct AtlasRow {
  std::string object;
  std::string support;
  std::size_t recordings = 0;  ///< number that the value rests on
  std::string key = {};        ///< as in the parameter file
  std::optional<double> value = {};
  std::optional<double> std = {};
  std::string unit = {};    ///< of both
  std::string origin = {};  ///< "identified", "given" or "not identified"
};

/// Stds of a limit surface's coefficients in its scales; empty: not known.
using SurfaceStd = std::optional<std::array<double, 15>>;

/// The rows of one object on one support: mu, F_M, B, the friction radius and the limit surface,
/// each with its std and its origin.
[[nodiscard]] std::vector<AtlasRow> atlas_rows_of(const std::string& object,
                                                  const std::string& support,
                                                  std::size_t recordings,
                                                  const ObjectParameters& parameters,
                                                  const SurfaceStd& surface_std);

/// Writes friction_atlas.csv and friction_atlas.parquet, the same rows with the columns of
/// AtlasRow, into a folder that exists.
[[nodiscard]] Expected<void> write_atlas(const std::vector<AtlasRow>& rows,
                                         const std::filesystem::path& folder);

/// By object, of the report.json of a pooled identification (write_pooled_report).
[[nodiscard]] Expected<std::map<std::string, SurfaceStd>> read_surface_stds(
    const std::filesystem::path& report);

}  // namespace pcavr
