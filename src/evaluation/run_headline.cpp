// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "pooled_errors.hpp"
#include "run_report.hpp"

namespace pcavr {
namespace {

constexpr double kMilliseconds = 1e3;

void add_positions(const Findings& findings, std::vector<Figure>& headline) {
  const std::vector<PoseError> touched = predicted_errors_in(findings, is_touched_or_moving);
  if (!touched.empty()) {
    const ErrorStatistics figures = statistics(translations(touched));
    headline.push_back({"Predicted position while touched or moving, median error",
                        kMillimetres * figures.median, "mm"});
    headline.push_back(
        {"Predicted position while touched or moving, 95 %", kMillimetres * figures.p95, "mm"});
  }
  const std::vector<PoseError> sliding =
      predicted_errors_in(findings, [](Phase phase) { return phase == Phase::sliding; });
  if (!sliding.empty()) {
    const ErrorStatistics figures = statistics(translations(sliding));
    headline.push_back(
        {"Predicted position while sliding, rmse", kMillimetres * figures.rmse, "mm"});
    headline.push_back(
        {"Predicted position while sliding, worst", kMillimetres * figures.max, "mm"});
  }
  const std::vector<PoseError> all = predicted_errors(findings);
  if (!all.empty()) {
    headline.push_back({"Predicted position over the whole run, worst",
                        kMillimetres * statistics(translations(all)).max, "mm"});
  }
}

void add_forces(const RunFindings& run, std::vector<Figure>& headline) {
  const std::vector<double> relative = relative_force_errors(run);
  if (!relative.empty()) {
    const ErrorStatistics figures = statistics(relative);
    headline.push_back(
        {"Force felt against measured, in contact, median error", kPercent * figures.median, "%"});
    headline.push_back(
        {"Force felt against measured, in contact, 95 %", kPercent * figures.p95, "%"});
  }
  if (run.forces.empty()) return;
  double largest = 0.0;
  for (const auto& [object, errors] : run.forces) {
    largest = std::max(largest, statistics(magnitudes(errors.all)).max);
  }
  headline.push_back({"Force felt against measured, whole run, worst", largest, "N"});
}

void add_phases(const RunFindings& run, std::vector<Figure>& headline) {
  for (const PhaseComparison& comparison : run.phase_comparisons) {
    // Against the truth where there is one; the third comparison is for the tables.
    if (!run.true_phases.empty() && comparison.reference != "truth") continue;
    std::vector<PhaseErrors> of_objects;
    for (const auto& [object, errors] : comparison.objects) of_objects.push_back(errors);
    const PhaseErrors all = together(of_objects);
    const std::string name = "Phase boundaries " + comparison.estimate;
    const std::vector<double> seconds = event_errors(all);
    if (!seconds.empty()) {
      const ErrorStatistics figures = statistics(seconds);
      headline.push_back({name + ", median error", kMilliseconds * figures.median, "ms"});
      headline.push_back({name + ", 95 %", kMilliseconds * figures.p95, "ms"});
    }
    headline.push_back({name + ", missed", static_cast<double>(count_missed(all)), ""});
    headline.push_back({name + ", surplus", static_cast<double>(count_surplus(all)), ""});
  }
}

void add_corrections(const RunFindings& run, std::vector<Figure>& headline) {
  if (!run.corrections) return;
  const CorrectionCounts& counts = run.corrections->counts;
  headline.push_back({"Corrections sent", static_cast<double>(counts.count), ""});
  const std::optional<double>& streaming = run.files.settings.streaming_bytes;
  if (streaming && *streaming > 0.0) {
    headline.push_back({"Corrections, share of what streaming would send",
                        kPercent * static_cast<double>(counts.bytes) / *streaming, "%"});
  }
}

}  // namespace

std::vector<Figure> run_headline(const Findings& findings) {
  std::vector<Figure> headline;
  add_positions(findings, headline);
  add_forces(*findings.run, headline);
  add_phases(*findings.run, headline);
  add_corrections(*findings.run, headline);
  return headline;
}

}  // namespace pcavr
