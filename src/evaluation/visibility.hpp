// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/core/parallel.hpp"
#include "pcavr/evaluation/surface_errors.hpp"
#include "pcavr/model/cad_model.hpp"

#include "surface_samples.hpp"

namespace pcavr {

/// For each sample of the truth, 1 if some view could measure it, otherwise 0.
[[nodiscard]] std::vector<std::uint8_t> seen_by_any(const std::vector<SurfaceSample>& samples_base,
                                                    const SurfaceQuery& truth_base,
                                                    const Views& views, Parallelism parallelism);

}  // namespace pcavr
