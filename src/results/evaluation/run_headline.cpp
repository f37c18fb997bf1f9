// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string_view>

#include "pooled_errors.hpp"
#include "run_report.hpp"

namespace pcavr {
namespace {

constexpr double kMilliseconds = 1e3;

// The most important metrics: errors of position, force and phase boundaries, and the cost.
constexpr char kMedianPosition[] = "Predicted position error in contact or moving, median";
constexpr char kP95Position[] = "Predicted position error in contact or moving, 95th percentile";
constexpr char kMedianForce[] = "Rendered force error in contact, median";
constexpr char kMedianBoundary[] = "Phase boundaries predicted, median error";
constexpr char kBytes[] = "Correction bytes relative to streaming";

bool is_first(const Metric& metric) {
  constexpr std::array<std::string_view, 5> kFirst{kMedianPosition, kP95Position, kMedianForce,
                                                   kMedianBoundary, kBytes};
  return std::find(kFirst.begin(), kFirst.end(), metric.name) != kFirst.end();
}

void add_positions(const Findings& findings, std::vector<Metric>& headline) {
  const std::vector<PoseError> touched = predicted_errors_in(findings, is_touched_or_moving);
  if (!touched.empty()) {
    const ErrorStatistics stats = statistics(translations(touched));
    headline.push_back({kMedianPosition, kMillimetres * stats.median, "mm"});
    headline.push_back({kP95Position, kMillimetres * stats.p95, "mm"});
  }
  const std::vector<PoseError> sliding =
      predicted_errors_in(findings, [](Phase phase) { return phase == Phase::sliding; });
  if (!sliding.empty()) {
    const ErrorStatistics stats = statistics(translations(sliding));
    headline.push_back(
        {"Predicted position error while sliding, rmse", kMillimetres * stats.rmse, "mm"});
    headline.push_back(
        {"Predicted position error while sliding, max", kMillimetres * stats.max, "mm"});
  }
  const std::vector<PoseError> all = predicted_errors(findings);
  if (!all.empty()) {
    headline.push_back({"Predicted position error, whole run, max",
                        kMillimetres * statistics(translations(all)).max, "mm"});
  }
}

void add_forces(const RunFindings& run, std::vector<Metric>& headline) {
  const std::vector<double> relative = relative_force_errors(run.forces);
  if (!relative.empty()) {
    const ErrorStatistics stats = statistics(relative);
    headline.push_back({kMedianForce, kPercent * stats.median, "%"});
    headline.push_back(
        {"Rendered force error in contact, 95th percentile", kPercent * stats.p95, "%"});
  }
  if (run.forces.empty()) return;
  double max_error = 0.0;
  for (const auto& [object, errors] : run.forces) {
    max_error = std::max(max_error, statistics(magnitudes(errors.all)).max);
  }
  headline.push_back({"Rendered force error, whole run, max", max_error, "N"});
}

void add_phases(const RunFindings& run, std::vector<Metric>& headline) {
  for (const PhaseComparison& comparison : run.phase_comparisons) {
    // The headline compares with the truth where there is one; the third comparison is in the
    // tables only.
    if (!run.true_phases.empty() && comparison.reference != "truth") continue;
    std::vector<PhaseErrors> of_objects;
    for (const auto& [object, errors] : comparison.objects) of_objects.push_back(errors);
    const PhaseErrors all = merged(of_objects);
    const std::string name = "Phase boundaries " + comparison.estimate;
    const std::vector<double> seconds = event_errors(all);
    if (!seconds.empty()) {
      const ErrorStatistics stats = statistics(seconds);
      headline.push_back({name + ", median error", kMilliseconds * stats.median, "ms"});
      headline.push_back(
          {name + ", 95th percentile of the error", kMilliseconds * stats.p95, "ms"});
    }
    headline.push_back({name + ", missed", static_cast<double>(count_missed(all)), ""});
    headline.push_back({name + ", surplus", static_cast<double>(count_surplus(all)), ""});
  }
}

void add_corrections(const RunFindings& run, std::vector<Metric>& headline) {
  if (!run.corrections) return;
  const CorrectionCounts& counts = run.corrections->counts;
  headline.push_back({"Corrections sent", static_cast<double>(counts.count), ""});
  const std::optional<double>& streaming = run.files.settings.streaming_bytes;
  if (streaming && *streaming > 0.0) {
    headline.push_back({kBytes, kPercent * static_cast<double>(counts.bytes) / *streaming, "%"});
  }
}

}  // namespace

std::vector<Metric> run_headline(const Findings& findings) {
  std::vector<Metric> headline;
  add_positions(findings, headline);
  add_forces(*findings.run, headline);
  add_phases(*findings.run, headline);
  add_corrections(*findings.run, headline);
  std::stable_partition(headline.begin(), headline.end(), is_first);
  return headline;
}

}  // namespace pcavr
