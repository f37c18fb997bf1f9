// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/results/evaluation/surface_errors.hpp"

#include "surface_samples.hpp"

namespace pcavr {

/// 1 for each sample of the truth that some view could measure, 0 for the others.
[[nodiscard]] std::vector<std::uint8_t> seen_by_any(const std::vector<SurfaceSample>& samples_base,
                                                    const SurfaceQuery& truth_base,
                                                    const Views& views, Parallelism parallelism);

}  // namespace pcavr
