// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "phase_lanes.hpp"

#include <algorithm>

#include "pcavr/evaluation/html_text.hpp"

#include "phase_timeline.hpp"
#include "svg_parts.hpp"

namespace pcavr {
namespace {

// The drawing's own units, about pixels on a desktop screen.
constexpr double kLaneWidth = 1120.0;
constexpr double kLaneLeft = 190.0;
constexpr double kLaneRight = 14.0;
constexpr double kLaneTop = 6.0;
constexpr double kLaneBottom = 44.0;
constexpr double kLane = 22.0;
constexpr double kBetweenObjects = 10.0;

std::string lane_class(std::size_t phase) { return "lane" + std::to_string(phase); }

std::string legend() {
  std::string html = "<p class=\"legend\">";
  for (const Phase phase : kPhases) {
    html += legend_area(lane_class(static_cast<std::size_t>(phase)), std::string(to_string(phase)));
  }
  return html + "</p>\n";
}

/// Time to drawing coordinates.
struct TimeAxis {
  double from = 0.0;
  double to = 1.0;
  [[nodiscard]] double x(double t) const {
    return kLaneLeft + (t - from) / (to - from) * (kLaneWidth - kLaneLeft - kLaneRight);
  }
};

TimeAxis axis_of(const std::vector<PhaseLane>& lanes) {
  TimeAxis axis{lanes.front().intervals.front().from, lanes.front().intervals.back().to};
  for (const PhaseLane& lane : lanes) {
    axis.from = std::min(axis.from, lane.intervals.front().from);
    axis.to = std::max(axis.to, lane.intervals.back().to);
  }
  axis.to = std::max(axis.to, axis.from + 1e-3);  // minimum width of a single instant
  return axis;
}

std::string format_lane(const PhaseLane& lane, const TimeAxis& axis, double y) {
  std::string svg = svg_text("tick end", kLaneLeft - 8.0, y + 15.0, lane.label);
  for (const PhaseInterval& interval : lane.intervals) {
    const double x = axis.x(interval.from);
    svg += svg_rectangle(lane_class(static_cast<std::size_t>(interval.phase)), x, y + 2.0,
                         std::max(0.6, axis.x(interval.to) - x), kLane - 4.0);
  }
  return svg;
}

std::string format_time_axis(const TimeAxis& axis, double bottom) {
  std::string svg;
  const double step = tick_step(axis.to - axis.from, 12.0);
  for (const double tick : ticks_between(axis.from, axis.to, step)) {
    svg += svg_line("grid", axis.x(tick), kLaneTop, axis.x(tick), bottom);
    svg += svg_text("tick middle", axis.x(tick), bottom + 17.0, fixed(tick, decimals_of(step)));
  }
  return svg + svg_text("label middle", 0.5 * (kLaneLeft + kLaneWidth - kLaneRight), bottom + 37.0,
                        "time (s)");
}

}  // namespace

std::string format_lanes(const std::vector<PhaseLane>& lanes) {
  if (lanes.empty()) return {};
  const TimeAxis axis = axis_of(lanes);
  std::string drawing;
  double y = kLaneTop;
  for (std::size_t i = 0; i < lanes.size(); ++i) {
    const bool is_new = i == 0 || lanes[i].object != lanes[i - 1].object;
    if (is_new && i > 0) y += kBetweenObjects;
    if (is_new) drawing += svg_text("label", 4.0, y + 15.0, lanes[i].object);
    drawing += format_lane(lanes[i], axis, y);
    y += kLane;
  }
  return "<figure class=\"wide\">\n<figcaption>Phases over time</figcaption>\n" + legend() +
         "<svg class=\"plot\" role=\"img\" aria-label=\"Phases over time\" viewBox=\"0 0 " +
         fixed(kLaneWidth, 0) + ' ' + fixed(y + kLaneBottom, 0) + "\">\n" +
         format_time_axis(axis, y) + drawing + "</svg>\n</figure>\n";
}

}  // namespace pcavr
