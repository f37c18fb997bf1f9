// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "recordings/bag_import/csv_layout.hpp"

namespace pcavr {

/// The layout of a take that Motive exported as CSV, format versions 1.2x [OptiTrack, Data Export:
/// CSV]: a series for each rigid body; y is up unless the options say otherwise. nullopt where the
/// text is no such take. Fails where the take is not in quaternions or has an unknown unit of
/// length, a body without all its columns, or no body; the error has no file.
[[nodiscard]] Expected<std::optional<CsvLayout>> motive_layout(std::string_view text,
                                                               const CsvOptions& options);

}  // namespace pcavr
