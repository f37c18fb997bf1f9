// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/physics/identification/press_line.hpp"

#include "identify_plots.hpp"

namespace pcavr {
namespace {

constexpr double kBefore = 0.05;  // [s] of the figure before the touch
constexpr double kAfter = 0.30;   // of the rise, after the breakaway
constexpr std::size_t kMaxFigurePoints = 1000;

/// The line that find_breakaway fitted to the push, in the contact's coordinate of the tool, which
/// is along the face's normal by now: a least squares line passes through its samples' mean.
std::vector<double> push_line_force(const Contact& contact, double guard) {
  const Breakaway& breakaway = contact.breakaway;
  double count = 0.0, tool = 0.0, force = 0.0;
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    const bool is_fitted =
        contact.t[i] >= breakaway.t_contact && contact.t[i] <= breakaway.t_alarm - guard;
    if (is_fitted) count += 1.0, tool += contact.tool[i], force += contact.force[i];
  }
  std::vector<double> line(contact.t.size(), 0.0);
  if (count == 0.0) return line;
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i] = force / count + breakaway.stiffness * (contact.tool[i] - tool / count);
  }
  return line;
}

}  // namespace

std::optional<ForceLines> force_lines(const Identification& found, std::size_t object) {
  const auto push =
      std::find_if(found.contacts.begin(), found.contacts.end(), [object](const Contact& contact) {
        return contact.object == object && contact.left_out.empty() &&
               contact.kind != ContactKind::press && contact.breakaway.is_found;
      });
  if (push == found.contacts.end()) return std::nullopt;
  const Breakaway& breakaway = push->breakaway;
  const double from = breakaway.t_contact - kBefore;
  const double to = breakaway.t + kAfter * (breakaway.t - breakaway.t_contact);
  const std::optional<HuntCrossley> law = contact_law_of(found.objects[object].parameters);
  const bool has_press = law && push->press_line && push->press_line->ratio.is_excited;
  const std::vector<double> press =
      has_press ? press_line_force(push->series(), push->press_line->surface, *law)
                : std::vector<double>{};
  const std::vector<double> own = push_line_force(*push, BreakawayOptions().guard);
  const auto count = static_cast<std::size_t>(std::count_if(
      push->t.begin(), push->t.end(), [from, to](double t) { return t >= from && t <= to; }));
  const std::size_t stride = count / kMaxFigurePoints + 1;
  ForceLines lines{.t_breakaway = breakaway.t, .t_alarm = breakaway.t_alarm};
  for (std::size_t i = 0; i < push->t.size(); i += stride) {
    if (push->t[i] < from || push->t[i] > to) continue;
    lines.t.push_back(push->t[i]);
    lines.measured.push_back(push->force[i]);
    lines.push_line.push_back(std::max(0.0, own[i]));
    if (has_press) lines.press_line.push_back(press[i]);
  }
  if (lines.t.empty()) return std::nullopt;  // the breakaway is at an end of what was recorded
  if (has_press) lines.t_mutation = push->press_line->t_mutation;
  return lines;
}

Plot force_lines_plot(const ForceLines& lines) {
  constexpr double kAbovePeak = 1.6;
  Plot plot{.title = "First push: force lines of an object at rest [paper C, figure 5]",
            .x_label = "time (s)",
            .y_label = "force (N)",
            .y_from_zero = true};
  plot.series = {{.label = "measured", .color = 1, .x = lines.t, .y = lines.measured},
                 {.label = "line of the push", .color = 0, .x = lines.t, .y = lines.push_line}};
  if (!lines.press_line.empty()) {
    plot.series.push_back({.label = "predicted by the press",
                           .color = 2,
                           .x = lines.t,
                           .y = lines.press_line,
                           .dashed = true});
  }
  // Beyond the breakaway the lines rise without limit.
  const double top = kAbovePeak * *std::max_element(lines.measured.begin(), lines.measured.end());
  for (PlotSeries& series : plot.series) {
    for (double& y : series.y) y = y > top ? kLineBreak : y;
  }
  plot.marks.push_back({lines.t_alarm, "off its line"});
  plot.marks.push_back({lines.t_breakaway, "breakaway"});
  if (lines.t_mutation) plot.marks.push_back({*lines.t_mutation, "off the press's line"});
  return plot;
}

}  // namespace pcavr
