// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/physics/inputs/input_series.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// What the input's checks examine; keeps references to the input's models and tracks.
[[nodiscard]] InputSeries series_of(const IdentificationInput& input);

}  // namespace pcavr
