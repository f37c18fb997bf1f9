// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "report_plots.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>

#include "report.hpp"
#include "run_plots.hpp"

namespace pcavr {
namespace {

/// More points of a path are not distinguishable in its map.
constexpr std::size_t kMaxPathPoints = 2000;

/// One value over time; the line breaks at gaps of more than five median steps.
PlotSeries over_time(const std::vector<PoseError>& errors, double PoseError::*value, double scale,
                     Stamp origin, const std::string& label, int color) {
  PlotSeries series{.label = label, .color = color};
  std::vector<double> steps;
  for (std::size_t i = 1; i < errors.size(); ++i) {
    steps.push_back(to_seconds(errors[i].stamp - errors[i - 1].stamp));
  }
  const double max_gap = 5.0 * statistics(steps).median;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (i > 0 && steps[i - 1] > max_gap) {
      series.x.push_back(kLineBreak);
      series.y.push_back(kLineBreak);
    }
    series.x.push_back(to_seconds(errors[i].stamp - origin));
    series.y.push_back(scale * errors[i].*value);
  }
  return series;
}

/// The trajectory seen from above.
PlotSeries from_above(const Trajectory& trajectory, const std::string& label, int color) {
  PlotSeries series{.label = label, .color = color};
  const std::size_t stride = (trajectory.size() + kMaxPathPoints - 1) / kMaxPathPoints;
  for (std::size_t i = 0; i < trajectory.size(); i += std::max<std::size_t>(stride, 1)) {
    series.x.push_back(trajectory.poses()[i].pose.translation().x());
    series.y.push_back(trajectory.poses()[i].pose.translation().y());
  }
  return series;
}

Plot map_of(const std::string& title, const Trajectory& reference, const Trajectory& estimate) {
  Plot map{
      .title = title, .x_label = "x in base (m)", .y_label = "y in base (m)", .equal_axes = true};
  map.series.push_back(from_above(reference, "reference", 1));
  map.series.push_back(from_above(estimate, "estimate", 0));
  map.series.back().dashed = true;
  return map;
}

/// [m] A path within this is a point in its map: no camera on a tripod, and no resting object,
/// moves farther by its poses' noise.
constexpr double kStill = 0.01;

bool is_still(const Trajectory& trajectory) {
  if (trajectory.size() == 0) return true;
  Eigen::AlignedBox3d box;
  for (const TimedPose& timed : trajectory.poses()) box.extend(timed.pose.translation());
  return box.diagonal().norm() < kStill;
}

/// The position error over the length of the path.
PlotSeries error_along_path(const std::vector<PoseError>& errors, const Trajectory& reference) {
  PlotSeries series{.label = "error (mm)", .color = 0};
  std::vector<double> lengths{0.0};
  const std::vector<TimedPose>& poses = reference.poses();
  // The path is measured in steps, because the poses' noise would lengthen that of an object at
  // rest.
  constexpr double kStep = 1e-3;  // [m]
  std::size_t anchor = 0;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step = translation_distance(poses[anchor].pose, poses[i].pose);
    if (step >= kStep) anchor = i;
    lengths.push_back(lengths.back() + (step >= kStep ? step : 0.0));
  }
  std::size_t i = 0;
  for (const PoseError& error : errors) {
    while (i + 1 < poses.size() && poses[i].stamp < error.stamp) ++i;
    series.x.push_back(lengths[i]);
    series.y.push_back(kMillimetres * error.translation);
  }
  return series;
}

/// The path with its error below; empty for one that did not move.
std::vector<Plot> path_plots(const std::string& title, const Trajectory& reference,
                             const Trajectory& estimate, const std::vector<PoseError>& errors) {
  if (is_still(reference) && is_still(estimate)) return {};
  Plot map = map_of(title, reference, estimate);
  if (reference.size() > 1 && !errors.empty()) {
    map.strip = error_along_path(errors, reference);
    map.strip_x_label = "length of the path (m)";
  }
  return {std::move(map)};
}

/// A fixed camera has one pose, and one error at all times: the table states it.
bool has_one_pose(const Trajectory& trajectory) {
  const std::vector<TimedPose>& poses = trajectory.poses();
  return std::all_of(poses.begin(), poses.end(), [&](const TimedPose& timed) {
    return timed.pose.matrix() == poses.front().pose.matrix();
  });
}

std::vector<Plot> with_path(Plot translation, std::vector<Plot> path, Plot rotation) {
  std::vector<Plot> plots{std::move(translation)};
  plots.insert(plots.end(), path.begin(), path.end());
  plots.push_back(std::move(rotation));
  return plots;
}

Plot error_plot(const std::string& title, const std::string& y_label) {
  return {.title = title, .x_label = "time (s)", .y_label = y_label, .y_from_zero = true};
}

/// Intervals in which the reference moves.
std::vector<PlotBand> moving_bands(const ObjectFindings& object, Stamp origin) {
  std::vector<PlotBand> bands;
  const std::vector<PoseError>& errors = object.errors.absolute;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!object.moving[i]) continue;
    const double t = to_seconds(errors[i].stamp - origin);
    if (i == 0 || !object.moving[i - 1]) bands.push_back({t, t});
    bands.back().to = t;
  }
  return bands;
}

/// [mm] Upper limit of the mesh's plots: several times a good mesh's error.
constexpr double kMaxShownDistance = 15.0;

/// Share of the samples (%) over distance (mm).
PlotSeries cumulative(const std::vector<double>& ascending, const std::string& label, int color) {
  PlotSeries series{.label = label, .color = color};
  if (ascending.empty()) return series;
  constexpr int kSteps = 400;
  for (int i = 0; i <= kSteps; ++i) {
    const double share = static_cast<double>(i) / kSteps;
    series.x.push_back(kMillimetres * quantile(ascending, share));
    series.y.push_back(kPercent * share);
  }
  series.x.push_back(std::max(kMaxShownDistance, series.x.back()));
  series.y.push_back(kPercent);
  return series;
}

/// Share of the samples (%) in each bin of distance (mm), as a line of steps.
PlotSeries histogram(const std::vector<double>& ascending, double bin, const std::string& label,
                     int color) {
  PlotSeries series{.label = label, .color = color};
  auto begin = ascending.begin();
  for (double low = 0.0; low < kMaxShownDistance && !ascending.empty(); low += bin) {
    const auto end = std::lower_bound(begin, ascending.end(), (low + bin) / kMillimetres);
    const double share =
        kPercent * static_cast<double>(end - begin) / static_cast<double>(ascending.size());
    series.x.insert(series.x.end(), {low, low + bin});
    series.y.insert(series.y.end(), {share, share});
    begin = end;
  }
  return series;
}

}  // namespace

std::vector<Plot> plots_of(const CameraFindings& camera, Stamp origin) {
  if (has_one_pose(camera.reference) && has_one_pose(camera.estimate)) return {};
  const TrajectoryErrors& errors = camera.errors;
  Plot translation = error_plot("Camera position error", "position error (mm)");
  Plot rotation = error_plot("Camera rotation error", "rotation error (deg)");
  const auto add = [&](const std::vector<PoseError>& list, const std::string& label, int color) {
    if (list.empty()) return;
    translation.series.push_back(
        over_time(list, &PoseError::translation, kMillimetres, origin, label, color));
    rotation.series.push_back(
        over_time(list, &PoseError::rotation, kDegrees, origin, label, color));
  };
  add(errors.absolute, "not aligned", 0);
  add(errors.absolute_aligned, "aligned", 1);
  return with_path(translation,
                   path_plots("Camera trajectory from above", camera.reference, camera.estimate,
                              errors.absolute),
                   rotation);
}

std::vector<Plot> plots_of(const ObjectFindings& object, const Findings& findings) {
  const Stamp origin = findings.origin;
  const std::string name = object.name + ", " + object.source;
  Plot translation = error_plot(name + ": position error", "position error (mm)");
  Plot rotation = error_plot(name + ": rotation error", "rotation error (deg)");
  translation.series.push_back(over_time(object.errors.absolute, &PoseError::translation,
                                         kMillimetres, origin, "position error", 0));
  rotation.series.push_back(over_time(object.errors.absolute, &PoseError::rotation, kDegrees,
                                      origin, "rotation error", 0));
  std::vector<Plot> path = path_plots(name + ": path from above", object.reference, object.estimate,
                                      object.errors.absolute);
  const bool has_phases = findings.run && !findings.run->phases_of(object.name).empty();
  if (has_phases) {
    annotate(object, *findings.run, origin, {&translation, &rotation});
    return with_path(translation, std::move(path), rotation);
  }
  for (Plot* plot : {&translation, &rotation}) {
    plot->bands = moving_bands(object, origin);
    plot->band_labels = {"reference moving"};
  }
  return with_path(translation, std::move(path), rotation);
}

std::vector<Plot> plots_of(const SurfaceFindings& surface) {
  const MeshErrors& errors = surface.errors;
  const std::string completeness = surface.views > 0 ? "seen reference to mesh (completeness)"
                                                     : "reference to mesh (completeness)";
  Plot shares{.title = "Distance between mesh and reference, cumulative",
              .x_label = "distance (mm)",
              .y_label = "share within (%)",
              .marks = {{5.0, "5 mm"}, {10.0, "10 mm"}},
              .from_zero = true,
              .x_to = kMaxShownDistance,
              .y_to = 100.0};
  shares.series = {cumulative(errors.mesh_to_truth, "mesh to reference (accuracy)", 0),
                   cumulative(errors.seen_truth_to_mesh, completeness, 1)};
  constexpr double kBin = 0.25;  // [mm]
  Plot bins{.title = "Distance between mesh and reference, histogram",
            .x_label = "distance (mm)",
            .y_label = "share in 0.25 mm (%)",
            .from_zero = true,
            .x_to = kMaxShownDistance};
  bins.series = {histogram(errors.mesh_to_truth, kBin, "mesh to reference (accuracy)", 0),
                 histogram(errors.seen_truth_to_mesh, kBin, completeness, 1)};
  return {shares, bins};
}

}  // namespace pcavr
