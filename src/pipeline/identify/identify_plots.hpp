// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/report/plot.hpp"
#include "pcavr/base/report/report_page.hpp"
#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

inline constexpr double kMillimetres = 1e3;  ///< per metre
inline constexpr double kPercent = 1e2;

[[nodiscard]] std::string name_of(EstimationMethod method);

/// Paper C's figures 8 and 9: force and parameters over time, by estimator.
[[nodiscard]] std::vector<Plot> contact_plots(const ObjectIdentification& object);
/// Time that each push's force is in the critical band, paper C's and ours; no rows for fewer than
/// two pushes.
[[nodiscard]] ReportTable critical_band_table(const Identification& found, std::size_t object);
/// Force and displacement with the phases shaded, and each push's breakaway.
[[nodiscard]] std::vector<Plot> push_plots(const Identification& found, std::size_t object);

/// Paper C's figure 5 of one push: the force of an object at rest by two lines, over the measured
/// one, from before the touch until after the breakaway.
struct ForceLines {
  std::vector<double> t = {};             ///< [s]
  std::vector<double> measured = {};      ///< [N]
  std::vector<double> push_line = {};     ///< [N] fitted in the push itself
  std::vector<double> press_line = {};    ///< [N] by a press's law; empty where there is none
  double t_breakaway = 0.0;               ///< [s] the force's peak
  double t_alarm = 0.0;                   ///< [s] the force left the push's own line
  std::optional<double> t_mutation = {};  ///< [s] ... left the press's line
};
/// The lines of the object's first push that counts and broke loose; nothing where there is none.
[[nodiscard]] std::optional<ForceLines> force_lines(const Identification& found,
                                                    std::size_t object);
[[nodiscard]] Plot force_lines_plot(const ForceLines& lines);

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
/// A plot of the damping laws with the object's measured restitution marked.
[[nodiscard]] Plot damping_laws_plot(const ObjectIdentification& object);

}  // namespace pcavr
