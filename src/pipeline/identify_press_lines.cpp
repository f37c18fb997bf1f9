// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "pcavr/core/median.hpp"
#include "pcavr/identification/press_line.hpp"

#include "identify_parts.hpp"
#include "identify_plots.hpp"

namespace pcavr {
namespace {

/// Difference between the stiffnesses of push and press that is stated: paper C's just noticeable
/// difference of force, beyond the bias of a few per cent by the object's creep.
constexpr double kMaxStiffnessDifference = 0.10;
constexpr double kMinDifferenceStds = 3.0;

constexpr double kBefore = 0.05;  // [s] of the figure before the touch
constexpr double kAfter = 0.30;   // of the rise, after the breakaway
constexpr std::size_t kMaxFigurePoints = 1000;

bool is_given_by_presses(const ObjectParameters& parameters) {
  return parameters.sources.presses.count("contact.stiffness") > 0;
}

/// The line that find_breakaway fitted to the push, in the episode's coordinate of the tool, which
/// is along the face's normal by now: a least squares line passes through its samples' mean.
std::vector<double> push_line_force(const ContactEpisode& episode, double guard) {
  const Breakaway& breakaway = episode.breakaway;
  double count = 0.0, tool = 0.0, force = 0.0;
  for (std::size_t i = 0; i < episode.t.size(); ++i) {
    const bool is_fitted =
        episode.t[i] >= breakaway.t_contact && episode.t[i] <= breakaway.t_alarm - guard;
    if (is_fitted) count += 1.0, tool += episode.tool[i], force += episode.force[i];
  }
  std::vector<double> line(episode.t.size(), 0.0);
  if (count == 0.0) return line;
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i] = force / count + breakaway.stiffness * (episode.tool[i] - tool / count);
  }
  return line;
}

}  // namespace

void check_press_lines(std::vector<IdentifiedContact>& contacts, std::size_t object,
                       const BreakawayOptions& options, ObjectIdentification& result) {
  const std::optional<HuntCrossley> law = contact_law_of(result.parameters);
  if (!law || !is_given_by_presses(result.parameters)) return;
  std::vector<double> ratios;
  std::size_t different = 0;
  for (IdentifiedContact* push : contacts_of(contacts, object, false)) {
    push->press_line =
        compare_with_press(push->episode.series(), push->episode.breakaway, *law, options);
    const IdentifiedParameter& ratio = push->press_line->ratio;
    // Off the centre of mass the object turns under the load: its line is less steep.
    if (!ratio.is_excited || !is_centred(push)) continue;
    ratios.push_back(ratio.value);
    const double difference = std::abs(ratio.value - 1.0);
    const bool is_different =
        difference > kMaxStiffnessDifference && difference > kMinDifferenceStds * ratio.std;
    different += is_different ? 1 : 0;
  }
  if (2 * different <= ratios.size()) return;
  result.notes.push_back(fmt::format(
      "{} of {} pushes rise {:.2f} times (median) as steeply as the press's law predicts: the "
      "faces differ, or the presses were not on this material; the limiting friction uses the "
      "pushes' own lines",
      different, ratios.size(), median(ratios)));
}

std::optional<ForceLines> force_lines(const Identification& found, std::size_t object) {
  const auto push = std::find_if(
      found.contacts.begin(), found.contacts.end(), [object](const IdentifiedContact& contact) {
        return contact.object == object && contact.left_out.empty() &&
               contact.episode.kind != ContactKind::press && contact.episode.breakaway.is_found;
      });
  if (push == found.contacts.end()) return std::nullopt;
  const ContactEpisode& episode = push->episode;
  const Breakaway& breakaway = episode.breakaway;
  const double from = breakaway.t_contact - kBefore;
  const double to = breakaway.t + kAfter * (breakaway.t - breakaway.t_contact);
  const std::optional<HuntCrossley> law = contact_law_of(found.objects[object].parameters);
  const bool has_press = law && push->press_line && push->press_line->ratio.is_excited;
  const std::vector<double> press =
      has_press ? press_line_force(episode.series(), push->press_line->surface, *law)
                : std::vector<double>{};
  const std::vector<double> own = push_line_force(episode, BreakawayOptions().guard);
  const auto count = static_cast<std::size_t>(std::count_if(
      episode.t.begin(), episode.t.end(), [from, to](double t) { return t >= from && t <= to; }));
  const std::size_t stride = count / kMaxFigurePoints + 1;
  ForceLines lines{.t_breakaway = breakaway.t, .t_alarm = breakaway.t_alarm};
  for (std::size_t i = 0; i < episode.t.size(); i += stride) {
    if (episode.t[i] < from || episode.t[i] > to) continue;
    lines.t.push_back(episode.t[i]);
    lines.measured.push_back(episode.force[i]);
    lines.push_line.push_back(std::max(0.0, own[i]));
    if (has_press) lines.press_line.push_back(press[i]);
  }
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
