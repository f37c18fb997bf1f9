// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/pipeline/identify.hpp"
#include "pcavr/report/plot.hpp"

namespace pcavr {

inline constexpr double kMillimetres = 1e3;  ///< per metre
inline constexpr double kPercent = 1e2;

[[nodiscard]] std::string name_of(EstimationMethod method);

/// Paper C's figures 8 and 9: force and parameters over time, by estimator.
[[nodiscard]] std::vector<Plot> contact_plots(const ObjectIdentification& object);
/// Force and displacement with the phases shaded, and each push's breakaway.
[[nodiscard]] std::vector<Plot> push_plots(const Identification& found, std::size_t object);
/// Sliding parameters over time with their std bands.
[[nodiscard]] std::vector<Plot> sliding_plots(const ObjectIdentification& object);
/// The limit surface and the wrenches it was fitted to.
[[nodiscard]] std::vector<Plot> surface_plots(const ObjectIdentification& object);

}  // namespace pcavr
