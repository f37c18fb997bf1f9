// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "recordings/bag_import/csv_layout.hpp"

namespace pcavr {

/// The series that a header's columns make, by the names that programs give to quantities. The
/// first has no name; `remarks` gets what was assumed of units. Fails where a known column has an
/// unknown unit; the error has no file. `names`: the columns as the header has them.
[[nodiscard]] Expected<std::vector<CsvLayout::Series>> series_of(
    const std::vector<CsvColumn>& columns, const std::vector<std::string>& names,
    std::vector<std::string>& remarks);

/// The series of a position and a rotation vector [rad] in columns such as tx, ty, tz, rx, ry, rz.
/// Apart from series_of, since other programs name Euler angles so. No numbers: there is none.
[[nodiscard]] Expected<CsvLayout::Series> rotation_vector_series(
    const std::vector<CsvColumn>& columns, const std::vector<std::string>& names);

/// An Error for a column whose unit is not known; `known`: "lengths in m, ...".
[[nodiscard]] Error unknown_unit(const std::string& name, const std::string& unit,
                                 const char* known);

}  // namespace pcavr
