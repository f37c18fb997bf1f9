// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "identify_plots.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/report/number_text.hpp"
#include "pcavr/physics/contact/impact.hpp"

namespace pcavr {
namespace {

void add_point(PlotSeries& series, double x, double y) {
  series.x.push_back(x);
  series.y.push_back(y);
}

/// Both edges of value +- std as one dashed line; where std is not finite, nothing is drawn.
PlotSeries band_of(const std::vector<double>& t, const std::vector<double>& value,
                   const std::vector<double>& std_of_value, int color) {
  PlotSeries band{.label = "± standard deviation", .color = color, .dashed = true};
  for (const double sign : {1.0, -1.0}) {
    for (std::size_t i = 0; i < t.size(); ++i) {
      add_point(band, t[i],
                std::isfinite(std_of_value[i]) ? value[i] + sign * std_of_value[i] : kLineBreak);
    }
    add_point(band, kLineBreak, kLineBreak);
  }
  return band;
}

/// Upper limit of the axis, by the second half of the values: the initial transient is cut off.
double upper_edge(const std::vector<double>& values) {
  double largest = 0.0;
  for (std::size_t i = values.size() / 2; i < values.size(); ++i) {
    if (std::isfinite(values[i])) largest = std::max(largest, std::abs(values[i]));
  }
  return 1.5 * largest;
}

/// Interrupts the line where it leaves the plot.
void clip(double edge, PlotSeries& series) {
  for (double& y : series.y) {
    if (!(y <= edge && y >= -0.3 * edge)) y = kLineBreak;
  }
}

Plot parameter_plot(const ObjectIdentification& object, std::size_t which, const char* title,
                    const char* label) {
  Plot plot{
      .title = title, .x_label = "time in contact (s)", .y_label = label, .y_from_zero = true};
  for (std::size_t m = 0; m < object.comparison.size(); ++m) {
    const EstimatorTrace& trace = object.comparison[m];
    const int color = static_cast<int>(m);
    plot.series.push_back(
        {.label = name_of(trace.method), .color = color, .x = trace.t, .y = trace.value[which]});
    if (trace.method != EstimationMethod::averaged) continue;
    plot.series.push_back(band_of(trace.t, trace.value[which], trace.std[which], color));
  }
  const double edge = upper_edge(object.comparison.back().value[which]);
  for (PlotSeries& series : plot.series) clip(edge, series);
  return plot;
}

}  // namespace

std::string name_of(EstimationMethod method) {
  switch (method) {
    case EstimationMethod::block:
      return "BSLS";
    case EstimationMethod::exponential:
      return "EWRLS";
    case EstimationMethod::adaptive:
    case EstimationMethod::averaged:
      break;
  }
  return "affRLS";
}

std::vector<DampingErrorCurve> damping_error_curves() {
  constexpr double kFrom = 0.05, kTo = 1.0, kStep = 0.025;
  std::vector<DampingErrorCurve> curves;
  for (const DampingLaw law : kPublishedDampingLaws) curves.push_back({.law = law});
  curves.push_back({.law = DampingLaw::exact});
  for (int i = 0; kFrom + i * kStep < kTo - 0.5 * kStep; ++i) {
    const double restitution = kFrom + i * kStep;
    const auto scores = score_damping_laws(restitution);
    for (std::size_t k = 0; k < curves.size(); ++k) {
      curves[k].restitution.push_back(restitution);
      // The exact relation is integrated, too: its error is the integration's.
      curves[k].relative_error.push_back(
          k < scores.size() ? scores[k].relative_error
                            : score_damping_law(DampingLaw::exact, restitution).relative_error);
    }
  }
  return curves;
}

Plot damping_laws_plot(const ObjectIdentification& object) {
  constexpr double kMaxError = 100.0;  // [%]: larger errors would hide the small ones
  Plot plot{.title = "Error of the damping laws [paper B, figure 6]",
            .x_label = "restitution",
            .y_label = "restitution error (%)",
            .y_to = kMaxError};
  int number = 0;
  for (const DampingErrorCurve& curve : damping_error_curves()) {
    PlotSeries series{.label = std::string(name_of(curve.law)),
                      .color = number % 4,
                      .x = curve.restitution,
                      .dashed = number >= 4};
    for (const double error : curve.relative_error) {
      const double percent = kPercent * error;
      series.y.push_back(percent > kMaxError ? kLineBreak : percent);
    }
    plot.series.push_back(std::move(series));
    ++number;
  }
  plot.marks.push_back({object.impact_findings.restitution.value, "measured"});
  return plot;
}

std::vector<Plot> contact_plots(const ObjectIdentification& object) {
  std::vector<Plot> plots;
  if (object.comparison.empty()) return plots;
  const EstimatorTrace& best = object.comparison.back();
  Plot force{.title = "Presses: force measured and estimated [paper C, figure 8]",
             .x_label = "time in contact (s)",
             .y_label = "force (N)",
             .y_from_zero = true};
  force.series.push_back({.label = "measured", .color = 3, .x = best.t, .y = best.measured});
  for (std::size_t m = 0; m < object.comparison.size(); ++m) {
    const EstimatorTrace& trace = object.comparison[m];
    force.series.push_back({.label = name_of(trace.method),
                            .color = static_cast<int>(m),
                            .x = trace.t,
                            .y = trace.estimated,
                            .dashed = true});
  }
  // The first samples' estimates may be anything.
  const double top = 1.3 * *std::max_element(best.measured.begin(), best.measured.end());
  for (PlotSeries& series : force.series) clip(top, series);
  plots.push_back(std::move(force));

  Plot error{.title = "Presses: error of the estimated force, relative",
             .x_label = "time in contact (s)",
             .y_label = "error (%)",
             .y_from_zero = true,
             .y_to = 30.0};
  for (std::size_t m = 0; m < object.comparison.size(); ++m) {
    const EstimatorTrace& trace = object.comparison[m];
    PlotSeries series{.label = name_of(trace.method), .color = static_cast<int>(m)};
    for (std::size_t i = 0; i < trace.t.size(); ++i) {
      add_point(series, trace.t[i],
                kPercent * std::abs(trace.estimated[i] / trace.measured[i] - 1.0));
    }
    error.series.push_back(std::move(series));
  }
  plots.push_back(std::move(error));
  const bool is_curved = object.presses.chosen == ContactRegressor::hunt_crossley;
  plots.push_back(parameter_plot(object, 2, "Stiffness over time",
                                 is_curved ? "stiffness (N/mⁿ)" : "stiffness (N/m)"));
  plots.push_back(parameter_plot(object, 1, "Damping over time",
                                 is_curved ? "damping (N s/mⁿ⁺¹)" : "damping (N s/m)"));
  return plots;
}

std::vector<Plot> sliding_plots(const ObjectIdentification& object) {
  std::vector<Plot> plots;
  const std::vector<SlidingHistory>& history = object.sliding.history;
  if (history.size() < 3) return plots;
  // Several slides in sequence, on an axis of sliding time, without the gaps between them.
  std::vector<double> t{0.0};
  for (std::size_t i = 1; i < history.size(); ++i) {
    const double step = history[i].t - history[i - 1].t;
    t.push_back(t.back() + (step > 0.0 && step < 0.2 ? step : 0.02));
  }
  Plot force{.title = "Slides: force measured and estimated (affRLS)",
             .x_label = "time of sliding (s)",
             .y_label = "force (N)"};
  force.series = {{.label = "measured", .color = 1, .x = t},
                  {.label = "estimated", .color = 0, .x = t, .dashed = true}};
  double largest = 0.0;
  for (const SlidingHistory& point : history) {
    force.series[0].y.push_back(point.measured);
    force.series[1].y.push_back(point.estimated);
    largest = std::max(largest, point.measured);
  }
  force.y_from_zero = true;
  force.y_to = 1.2 * largest;
  plots.push_back(std::move(force));

  struct Row {
    const char* title;
    const char* label;
    bool is_identified;
  };
  const SlidingIdentification& sliding = object.sliding;
  const Row rows[] = {{"Mass over time", "mass (kg)", sliding.mass.is_excited},
                      {"Coulomb friction over time", "force (N)", sliding.coulomb.is_excited},
                      {"Viscous friction over time", "N s/m", sliding.viscous.is_excited}};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!rows[k].is_identified) continue;
    std::vector<double> value, std_of_value;
    for (const SlidingHistory& point : history) {
      value.push_back(point.value[k]);
      std_of_value.push_back(point.std[k]);
    }
    Plot plot{.title = rows[k].title,
              .x_label = "time of sliding (s)",
              .y_label = rows[k].label,
              .y_from_zero = true};
    plot.series = {{.label = "affRLS", .color = 0, .x = t, .y = value},
                   band_of(t, value, std_of_value, 0)};
    for (PlotSeries& series : plot.series) clip(upper_edge(value), series);
    plots.push_back(std::move(plot));
  }
  return plots;
}

std::vector<Plot> surface_plots(const ObjectIdentification& object) {
  if (object.surface.status != LimitSurfaceFitStatus::fitted) return {};
  const LimitSurface& surface = object.surface.surface;
  Plot plot{.title = "Limit surface: wrenches during rotation",
            .x_label = "force across x and y (N), signed by y",
            .y_label = "moment over " + fixed(surface.length * kMillimetres, 1) + " mm (N)",
            .equal_axes = true};
  PlotSeries edge{.label = "fitted limit, force along y", .color = 0};
  constexpr int kPoints = 120;
  for (int i = 0; i <= kPoints; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / kPoints;
    const Eigen::Vector3d wrench(0.0, std::cos(angle), surface.length * std::sin(angle));
    const double size = level(surface, wrench);
    add_point(edge, wrench.y() / size, wrench.z() / surface.length / size);
  }
  PlotSeries seen{.label = "measured", .color = 1, .points = true};
  for (const PushSample& sample : object.turning) {
    const double x = std::copysign(sample.wrench.head<2>().norm(), sample.wrench.y());
    const double y = sample.wrench.z() / surface.length;
    add_point(seen, x, y);
  }
  plot.series = {edge, seen};
  return {plot};
}

}  // namespace pcavr
