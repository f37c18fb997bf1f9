// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "pcavr/base/report/plot.hpp"

#include "findings.hpp"

namespace pcavr {

/// Plots in the page's layout order: a map is as high as the two charts next to it. Times count
/// from `origin`.
[[nodiscard]] std::vector<Plot> plots_of(const CameraFindings& camera, Stamp origin);
[[nodiscard]] std::vector<Plot> plots_of(const ObjectFindings& object, const Findings& findings);
[[nodiscard]] std::vector<Plot> plots_of(const SurfaceFindings& surface);

}  // namespace pcavr
