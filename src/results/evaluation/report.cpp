// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "pooled_errors.hpp"
#include "report_plots.hpp"
#include "run_report.hpp"

namespace pcavr {
namespace {

/// The rows for position and rotation of one list of errors; none where the list is empty.
void add_rows(ReportSection& section, const std::string& name, const std::string& key,
              const std::vector<PoseError>& errors) {
  if (errors.empty()) return;
  section.rows.push_back(
      {"position, " + name, key + ".translation", "m", statistics(translations(errors))});
  section.rows.push_back(
      {"rotation, " + name, key + ".rotation", "rad", statistics(rotations(errors))});
}

template <typename Keep>
std::vector<PoseError> selected(const std::vector<PoseError>& errors, Keep keep) {
  std::vector<PoseError> kept;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (keep(i)) kept.push_back(errors[i]);
  }
  return kept;
}

std::vector<PoseError> first_second(const std::vector<PoseError>& errors) {
  return selected(errors, [&](std::size_t i) {
    return errors[i].stamp - errors.front().stamp <= std::chrono::seconds(1);
  });
}

ReportSection camera_section(const CameraFindings& camera, Stamp origin) {
  ReportSection section{
      .title = "Camera in base", .key = "camera", .plots = plots_of(camera, origin)};
  add_rows(section, "absolute", "absolute", camera.errors.absolute);
  add_rows(section, "absolute, aligned", "absolute_aligned", camera.errors.absolute_aligned);
  add_rows(section, "relative, over 1 s", "relative", camera.errors.relative);
  add_rows(section, "relative, frame to frame", "step", camera.errors.step);
  return section;
}

ReportSection object_section(const ObjectFindings& object, const Findings& findings) {
  const std::vector<PoseError>& absolute = object.errors.absolute;
  ReportSection section{.title = object.name + ", " + object.source,
                        .key = "object." + object.name + "." + object.source,
                        .plots = plots_of(object, findings),
                        .is_brief = findings.run.has_value()};
  add_rows(section, "absolute", "absolute", absolute);
  add_rows(section, "first second", "first_second", first_second(absolute));
  add_rows(section, "at rest", "at_rest",
           selected(absolute, [&](std::size_t i) { return !object.moving[i]; }));
  add_rows(section, "moving", "moving",
           selected(absolute, [&](std::size_t i) { return object.moving[i]; }));
  if (findings.run) {
    const std::vector<ErrorRow> rows = phase_rows(absolute, findings.run->phases_of(object.name));
    section.rows.insert(section.rows.end(), rows.begin(), rows.end());
  }
  add_rows(section, "relative, over 1 s", "relative", object.errors.relative);
  if (object.model) {
    section.rows.push_back({"ADD", "add", "m", object.model->add});
    section.rows.push_back({"MSSD", "mssd", "m", object.model->mssd});
  }
  return section;
}

ReportSection surface_section(const SurfaceFindings& surface) {
  ReportSection section{.title = "Mesh",
                        .key = "mesh",
                        .rows = {{"mesh to reference", "accuracy", "m", surface.errors.accuracy}},
                        .plots = plots_of(surface)};
  if (!surface.map.jpeg.empty()) {
    section.pictures.push_back({"The mesh, coloured by its distance from the reference",
                                surface.map.jpeg, std::string("As a mesh: ") + kErrorMeshFile});
  }
  return section;
}

void add_camera_metrics(const CameraFindings& camera, std::vector<Metric>& headline) {
  const TrajectoryErrors& errors = camera.errors;
  const auto poses = static_cast<double>(errors.absolute.size());
  headline.push_back({"Camera poses compared", poses, ""});
  if (errors.unmatched > 0) {
    headline.push_back({"Camera poses outside the reference's time span",
                        static_cast<double>(errors.unmatched), ""});
  }
  headline.push_back({"Camera position error, rmse, not aligned",
                      kMillimetres * statistics(translations(errors.absolute)).rmse, "mm"});
  headline.push_back({"Camera rotation error, rmse, not aligned",
                      kDegrees * statistics(rotations(errors.absolute)).rmse, "deg"});
  if (!errors.absolute_aligned.empty()) {
    headline.push_back({"Camera position error, rmse, aligned",
                        kMillimetres * statistics(translations(errors.absolute_aligned)).rmse,
                        "mm"});
  }
}

/// A prediction matters while the object is in contact or moves.
void add_touched_metrics(const std::string& name, const std::vector<PoseError>& errors,
                         std::vector<Metric>& headline) {
  const ErrorStatistics stats = statistics(translations(errors));
  headline.push_back(
      {name + ": position error in contact or moving, median", kMillimetres * stats.median, "mm"});
  headline.push_back({name + ": position error in contact or moving, 95th percentile",
                      kMillimetres * stats.p95, "mm"});
}

void add_object_metrics(const ObjectFindings& object, const Findings& findings,
                        std::vector<Metric>& headline) {
  const std::vector<PoseError>& absolute = object.errors.absolute;
  const std::vector<PoseError> start = first_second(absolute);
  const std::string name = object.name + " " + object.source;
  std::vector<PoseError> touched;
  if (findings.run && object.source == "predicted") {
    touched = errors_in(absolute, findings.run->phases_of(object.name), is_touched_or_moving);
  }
  if (!touched.empty()) {
    add_touched_metrics(name, touched, headline);
  } else {
    headline.push_back({name + ": position error, median, first second",
                        kMillimetres * statistics(translations(start)).median, "mm"});
    headline.push_back({name + ": rotation error, median, first second",
                        kDegrees * statistics(rotations(start)).median, "deg"});
  }
  headline.push_back({name + ": position error, rmse, whole run",
                      kMillimetres * statistics(translations(absolute)).rmse, "mm"});
  if (object.errors.unmatched > 0) {
    headline.push_back({name + ": poses outside the reference's time span",
                        static_cast<double>(object.errors.unmatched), ""});
  }
}

void add_surface_metrics(const SurfaceFindings& surface, std::vector<Metric>& headline) {
  const MeshErrors& errors = surface.errors;
  headline.push_back({"Mesh accuracy, mean", kMillimetres * errors.accuracy.mean, "mm"});
  headline.push_back({"Mesh accuracy, median", kMillimetres * errors.accuracy.median, "mm"});
  headline.push_back({"Mesh accuracy, 95th percentile", kMillimetres * errors.accuracy.p95, "mm"});
  const std::string scope =
      surface.views > 0 ? " of the seen reference" : " of the whole reference";
  headline.push_back({"Completeness within 5 mm" + scope, kPercent * errors.completeness_5mm, "%"});
  headline.push_back(
      {"Completeness within 10 mm" + scope, kPercent * errors.completeness_10mm, "%"});
  if (surface.left_behind) {
    headline.push_back(
        {"Residue of movable objects in the mesh", kPercent * *surface.left_behind, "%"});
  }
  headline.push_back(
      {"Mesh farther than 20 mm from the reference", kPercent * errors.share_not_explained, "%"});
}

/// Whether a metric matters first in a scene: its surfaces, then where they are.
bool is_first_of_scene(const Metric& metric) {
  constexpr std::array<std::string_view, 5> kFirst{
      "Mesh accuracy, median", "Mesh accuracy, 95th percentile", "Completeness within 5 mm",
      "Camera position error, rmse, not aligned", "Camera rotation error, rmse, not aligned"};
  return std::any_of(kFirst.begin(), kFirst.end(),
                     [&](std::string_view name) { return metric.name.starts_with(name); });
}

/// One object's sections follow each other.
void add_run_objects(const ComparisonSide& reference, const ComparisonSide& subject,
                     const Findings& findings, Report& report) {
  std::set<std::string> names;
  for (const ObjectFindings& object : findings.objects) names.insert(object.name);
  for (const auto& [name, forces] : findings.run->forces) names.insert(name);
  for (const std::string& name : names) {
    report.sections.push_back(push_section(name, reference, subject, findings));
    for (const ObjectFindings& object : findings.objects) {
      if (object.name != name || object.source != "predicted") continue;
      report.sections.push_back(object_section(object, findings));
    }
  }
}

void add_run(const ComparisonSide& reference, const ComparisonSide& subject,
             const Findings& findings, Report& report) {
  report.headline = run_headline(findings);
  report.sections = {overview_section(findings)};
  add_run_objects(reference, subject, findings, report);
  const std::vector<ReportSection> closing = closing_sections(findings);
  report.sections.insert(report.sections.end(), closing.begin(), closing.end());
}

/// Trajectories and surfaces, of any subject.
void add_geometry(const Findings& findings, Report& report) {
  if (findings.camera) {
    add_camera_metrics(*findings.camera, report.headline);
    report.sections.push_back(camera_section(*findings.camera, findings.origin));
  }
  for (const ObjectFindings& object : findings.objects) {
    add_object_metrics(object, findings, report.headline);
    if (findings.run && object.source == "predicted") continue;  // added above
    report.sections.push_back(object_section(object, findings));
  }
  for (const PlacementFindings& placed : findings.placements) {
    const std::string name = placed.name + " in the scene, at the " + placed.when;
    report.headline.push_back({name + ": position", kMillimetres * placed.translation, "mm"});
    report.headline.push_back({name + ": rotation", kDegrees * placed.rotation, "deg"});
  }
  if (findings.surface) {
    add_surface_metrics(*findings.surface, report.headline);
    report.sections.push_back(surface_section(*findings.surface));
  }
}

}  // namespace

Report make_report(const ComparisonSide& reference, const ComparisonSide& subject,
                   const Findings& findings) {
  Report report{
      .subject = subject.folder.string(),
      .subject_kind = name_of(subject.kind),
      .reference = reference.folder.string(),
      .reference_kind = name_of(reference.kind),
      .recording = (reference.recording.empty() ? subject : reference).recording.string()};
  if (findings.run) {
    add_run(reference, subject, findings, report);
  } else if (!findings.parameters.empty()) {
    report.sections = {parameter_section(findings)};
  }
  const std::vector<Metric> parameters = parameter_headline(findings);
  report.headline.insert(report.headline.end(), parameters.begin(), parameters.end());
  add_geometry(findings, report);
  if (!findings.run) {
    std::stable_partition(report.headline.begin(), report.headline.end(), is_first_of_scene);
  }
  return report;
}

}  // namespace pcavr
