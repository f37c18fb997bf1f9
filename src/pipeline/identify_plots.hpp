// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pcavr/contact/damping.hpp"
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

/// The error of a damping law over the restitution [paper B, figure 6].
struct DampingErrorCurve {
  DampingLaw law = DampingLaw::exact;
  std::vector<double> restitution = {};
  std::vector<double> relative_error = {};
};
/// The seven published laws, then the exact one.
[[nodiscard]] std::vector<DampingErrorCurve> damping_error_curves();
/// With the object's measured restitution marked.
[[nodiscard]] Plot damping_laws_plot(const ObjectIdentification& object);

}  // namespace pcavr
