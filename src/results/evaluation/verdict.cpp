// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "verdict.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pcavr/base/report/number_text.hpp"

#include "pooled_errors.hpp"

namespace pcavr {
namespace {

std::string in_unit(double value, double scale, const char* unit) {
  return readable(scale * value) + ' ' + unit;
}

std::string millimetres(double metres) { return in_unit(metres, kMillimetres, "mm"); }

std::string per_cent(double share) { return in_unit(share, kPercent, "%"); }

std::string prediction_sentence(const Findings& findings) {
  const std::vector<PoseError> touched = predicted_errors_in(findings, is_touched_or_moving);
  if (touched.empty()) return {};
  const ErrorStatistics stats = statistics(translations(touched));
  return "While objects were touched or moved, their predicted positions were " +
         millimetres(stats.median) + " off at the median, and " + millimetres(stats.p95) +
         " at the 95th percentile. ";
}

std::string force_sentence(const RunFindings& run) {
  const std::vector<double> relative = relative_force_errors(run.forces);
  if (relative.empty()) return {};
  return "The rendered force differed from the measured one by " +
         per_cent(statistics(relative).median) + " at the median. ";
}

std::string tracking_sentence(const Findings& findings) {
  std::vector<double> all;
  for (const ObjectFindings& object : findings.objects) {
    if (object.source == "predicted") continue;
    const std::vector<double> errors = translations(object.errors.absolute);
    all.insert(all.end(), errors.begin(), errors.end());
  }
  if (all.empty()) return {};
  return "Objects were tracked to " + millimetres(statistics(all).rmse) + " (rmse). ";
}

std::string placement_sentence(const std::vector<PlacementFindings>& placements) {
  if (placements.empty()) return {};
  double max = 0.0;
  for (const PlacementFindings& placed : placements) max = std::max(max, placed.translation);
  return "The objects of the scene are placed to " + millimetres(max) + " or better. ";
}

std::string surface_sentence(const SurfaceFindings& surface) {
  const MeshErrors& errors = surface.errors;
  return "Half of the mesh lies within " + millimetres(errors.accuracy.median) +
         " of the reference, 95 % of it within " + millimetres(errors.accuracy.p95) + "; of the " +
         (surface.views > 0 ? "seen " : "") + "reference " + per_cent(errors.completeness_5mm) +
         " has mesh within 5 mm. ";
}

/// A sentence that compares the errors of the identified parameters with their stated std.
std::string parameter_sentence(const std::vector<ParameterError>& parameters) {
  std::vector<double> in_std;
  for (const ParameterError& error : parameters) {
    if (error.error_in_std && !error.is_given) in_std.push_back(std::abs(*error.error_in_std));
  }
  if (in_std.empty()) return {};
  const auto within = std::count_if(in_std.begin(), in_std.end(), [](double z) { return z <= 1; });
  return "Of " + std::to_string(in_std.size()) + " identified parameters, " +
         std::to_string(within) + " lie within their stated std of the true value; the largest " +
         "error is " + readable(*std::max_element(in_std.begin(), in_std.end())) + " std. ";
}

std::string camera_sentence(const CameraFindings& camera) {
  const std::vector<PoseError>& errors = camera.errors.absolute;
  if (errors.empty()) return {};
  return "The camera's poses are " + millimetres(statistics(translations(errors)).rmse) + " and " +
         in_unit(statistics(rotations(errors)).rmse, kDegrees, "deg") +
         " off (rmse, not aligned). ";
}

}  // namespace

std::string verdict_of(const Findings& findings) {
  std::string text;
  if (findings.run) {
    text += prediction_sentence(findings) + force_sentence(*findings.run);
  }
  if (!findings.run) text += parameter_sentence(findings.parameters);
  if (findings.surface) text += surface_sentence(*findings.surface);
  if (findings.camera) text += camera_sentence(*findings.camera);
  text += tracking_sentence(findings) + placement_sentence(findings.placements);
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace pcavr
