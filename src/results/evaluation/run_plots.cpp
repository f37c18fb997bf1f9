// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "run_plots.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "pcavr/base/report/number_text.hpp"

#include "report.hpp"

namespace pcavr {
namespace {

constexpr double kMinMotion = 0.001;  // [m]

std::vector<PlotBand> bands_of(const PhaseTimeline& timeline, Stamp origin) {
  std::vector<PlotBand> bands;
  for (std::size_t i = 0; i < timeline.size(); ++i) {
    if (timeline[i].phase == Phase::free) continue;
    const double from = to_seconds(timeline[i].stamp - origin);
    // The last phase lasts to the end: beyond every plot's edge, where it is clipped.
    const double to = i + 1 < timeline.size() ? to_seconds(timeline[i + 1].stamp - origin) : 1e12;
    bands.push_back({from, to, static_cast<int>(timeline[i].phase)});
  }
  return bands;
}

void shade_phases(const std::string& object, const RunFindings& run, Stamp origin, Plot& plot) {
  plot.bands = bands_of(run.phases_of(object), origin);
  plot.band_labels = {"", "static", "critical", "sliding"};
}

std::vector<PlotMark> marks_of(const std::string& object, const RunFindings& run, Stamp origin) {
  std::vector<PlotMark> marks;
  for (const NodeFindings& found : run.nodes) {
    if (found.node.object != object) continue;
    marks.push_back(
        {to_seconds(found.node.event.stamp - origin), "t" + std::to_string(found.node.number)});
  }
  return marks;
}

/// The last instant of any trajectory or phase.
Stamp last_instant(const Findings& findings) {
  Stamp end = findings.origin;
  for (const ObjectFindings& object : findings.objects) {
    end = std::max(end, object.estimate.poses().back().stamp);
  }
  for (const auto* timelines : {&findings.run->true_phases, &findings.run->files.measured}) {
    for (const auto& [name, timeline] : *timelines) end = std::max(end, timeline.back().stamp);
  }
  return end;
}

/// Limits the x axis to the object's first contact until its last, of any record: the same in each
/// of its plots.
void show_pushes_only(const std::string& object, const Findings& findings, Plot& plot) {
  constexpr double kMargin = 0.5;  // [s] of rest on either side
  const RunFindings& run = *findings.run;
  std::vector<PlotBand> bands;
  for (const auto* timelines : {&run.true_phases, &run.files.measured, &run.files.predicted}) {
    const auto timeline = timelines->find(object);
    if (timeline == timelines->end()) continue;
    const std::vector<PlotBand> more = bands_of(timeline->second, findings.origin);
    bands.insert(bands.end(), more.begin(), more.end());
  }
  if (bands.empty()) return;
  double from = bands.front().from;
  double to = bands.front().to;
  for (const PlotBand& band : bands) {
    from = std::min(from, band.from);
    to = std::max(to, band.to);
  }
  plot.x_from = std::max(from - kMargin, 0.0);
  plot.x_to = std::min(to + kMargin, to_seconds(last_instant(findings) - findings.origin));
  if (plot.x_to <= *plot.x_from) plot.x_to = *plot.x_from + kMargin;
}

void pin_corrections(const std::string& object, const RunFindings& run, Stamp origin, Plot& plot) {
  if (!run.files.corrections) return;
  for (const RunCorrection& correction : *run.files.corrections) {
    if (correction.object != object) continue;
    plot.pins.push_back(
        {to_seconds(correction.stamp + run.round_trip - origin), correction.is_lost});
  }
  plot.pin_label = "correction arrives";
  plot.hollow_pin_label = "correction lost";
}

/// The maximum displacement of reference or estimate from the reference's first pose.
Eigen::Vector3d max_displacement(const ObjectFindings& object) {
  const Eigen::Vector3d start = object.reference.poses().front().pose.translation();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
  for (const Trajectory* trajectory : {&object.reference, &object.estimate}) {
    for (const TimedPose& timed : trajectory->poses()) {
      const Eigen::Vector3d displacement = timed.pose.translation() - start;
      if (displacement.norm() > max.norm()) max = displacement;
    }
  }
  return max;
}

PlotSeries displacement_along(const Trajectory& trajectory, const Eigen::Vector3d& start,
                              const Eigen::Vector3d& direction, Stamp origin, PlotSeries series) {
  for (const TimedPose& timed : trajectory.poses()) {
    series.x.push_back(to_seconds(timed.stamp - origin));
    series.y.push_back(kMillimetres * direction.dot(timed.pose.translation() - start));
  }
  return series;
}

std::string axes_text(const Eigen::Vector3d& direction) {
  std::string text;
  for (const double component : direction) text += (text.empty() ? "" : ", ") + fixed(component, 2);
  return text;
}

std::string label_for(SideKind reference) {
  if (reference == SideKind::truth) return "true";
  return reference == SideKind::tracking ? "tracked" : "reference";
}

/// One record of one object's phases, until `end`.
Lane lane_of(const std::string& object, const std::string& label, const PhaseTimeline& timeline,
             Stamp end, Stamp origin) {
  Lane lane{object, label, {}};
  for (std::size_t i = 0; i < timeline.size(); ++i) {
    const Stamp from = timeline[i].stamp;
    const Stamp to = i + 1 < timeline.size() ? timeline[i + 1].stamp : std::max(end, from);
    lane.intervals.push_back(
        {to_seconds(from - origin), to_seconds(to - origin), static_cast<int>(timeline[i].phase)});
  }
  return lane;
}

}  // namespace

void annotate(const ObjectFindings& object, const RunFindings& run, Stamp origin,
              const std::vector<Plot*>& plots) {
  for (Plot* plot : plots) {
    shade_phases(object.name, run, origin, *plot);
    if (object.source == "predicted") pin_corrections(object.name, run, origin, *plot);
  }
}

std::optional<Plot> motion_plot(const ObjectFindings& object, const ComparisonSide& reference,
                                const ComparisonSide& subject, const Findings& findings) {
  const Eigen::Vector3d displacement = max_displacement(object);
  if (displacement.norm() < kMinMotion) return std::nullopt;
  const Eigen::Vector3d start = object.reference.poses().front().pose.translation();
  const Eigen::Vector3d direction = displacement.normalized();
  Plot plot{.title = object.name + ": displacement from its start along (" + axes_text(direction) +
                     ") in base",
            .x_label = "time (s)",
            .y_label = "displacement (mm)",
            .marks = marks_of(object.name, *findings.run, findings.origin)};
  annotate(object, *findings.run, findings.origin, {&plot});
  const auto add = [&](const Trajectory& trajectory, PlotSeries style) {
    plot.series.push_back(
        displacement_along(trajectory, start, direction, findings.origin, std::move(style)));
  };
  const auto tracked = subject.tracked.find(object.name);
  if (tracked != subject.tracked.end()) add(tracked->second, {.label = "tracked", .color = 2});
  add(object.reference, {.label = label_for(reference.kind), .color = 1});
  if (object.source == "predicted") {
    add(object.estimate, {.label = "predicted", .color = 0, .dashed = true});
  }
  show_pushes_only(object.name, findings, plot);
  return plot;
}

Plot force_plot(const std::string& object, const Findings& findings) {
  const RunFindings& run = *findings.run;
  Plot plot{.title = object + ": force of the tool along the push",
            .x_label = "time (s)",
            .y_label = "force (N)",
            .marks = marks_of(object, run, findings.origin),
            .y_from_zero = true};
  shade_phases(object, run, findings.origin, plot);
  PlotSeries measured{.label = "measured", .color = 1};
  PlotSeries rendered{.label = "rendered (virtual)", .color = 0, .dashed = true};
  const std::vector<ForceSample>& samples = run.files.forces.at(object);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i > 0 && samples[i].stamp - samples[i - 1].stamp > std::chrono::milliseconds(50)) {
      for (PlotSeries* series : {&measured, &rendered}) {
        series->x.push_back(kLineBreak);
        series->y.push_back(kLineBreak);
      }
    }
    const double t = to_seconds(samples[i].stamp - findings.origin);
    measured.x.push_back(t);
    measured.y.push_back(samples[i].measured);
    rendered.x.push_back(t);
    rendered.y.push_back(samples[i].rendered);
  }
  plot.series = {std::move(measured), std::move(rendered)};
  show_pushes_only(object, findings, plot);
  return plot;
}

std::vector<Lane> phase_lanes(const Findings& findings) {
  const RunFindings& run = *findings.run;
  const Stamp end = last_instant(findings);
  std::map<std::string, std::vector<Lane>> by_object;
  const auto add = [&](const std::string& label,
                       const std::map<std::string, PhaseTimeline>& timelines) {
    for (const auto& [object, timeline] : timelines) {
      by_object[object].push_back(lane_of(object, label, timeline, end, findings.origin));
    }
  };
  add("truth", run.true_phases);
  add("measured", run.files.measured);
  add("predicted", run.files.predicted);
  std::vector<Lane> lanes;
  for (const auto& [object, more] : by_object) lanes.insert(lanes.end(), more.begin(), more.end());
  return lanes;
}

}  // namespace pcavr
