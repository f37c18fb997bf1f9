// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "findings.hpp"
#include "svg_plot.hpp"

namespace pcavr {

/// In the order in which the page sets them: beside two charts stands a map as high as both. Times
/// count from `origin`.
[[nodiscard]] std::vector<Plot> plots_of(const CameraFindings& camera, Stamp origin);
[[nodiscard]] std::vector<Plot> plots_of(const ObjectFindings& object, const Findings& findings);
[[nodiscard]] std::vector<Plot> plots_of(const SurfaceFindings& surface);

}  // namespace pcavr
