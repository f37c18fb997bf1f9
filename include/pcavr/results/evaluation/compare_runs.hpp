// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// A headline metric of a run's evaluation, in the report's unit: mm, deg, ms, N, %, or a count.
struct RunMetric {
  std::string name;
  std::string unit;
  double value = 0.0;
};

/// A run with its evaluation.
struct EvaluatedRun {
  std::string run;        ///< its folder
  std::string recording;  ///< as its run.yaml states it
  /// What run.yaml states of both sites, and `compared_with`: truth or tracking.
  std::map<std::string, std::string> settings = {};
  std::vector<RunMetric> metrics = {};
};

/// A metric's differences between two settings, over the recordings that were run under both.
struct PairedDifference {
  std::string metric;
  std::string unit;
  std::string from;  ///< the settings' names
  std::string to;
  std::size_t pairs = 0;
  double mean = 0.0;  ///< of `to` minus `from`, in the metric's unit
  double median = 0.0;
  double p = 1.0;       ///< see sign_flip_p
  double p_holm = 1.0;  ///< of all metrics of these two settings together
};

/// Many runs beside each other.
struct RunComparison {
  std::vector<EvaluatedRun> runs;
  std::vector<std::string> settings = {};          ///< names, in the order of the runs
  std::vector<std::size_t> setting_of_run = {};    ///< index in `settings`
  std::vector<PairedDifference> differences = {};  ///< of each setting from the first
  /// Whose parameter files lie beside the report (gather_results): named in it.
  std::vector<std::string> objects = {};
};

/// Two-sided p of a mean difference of zero: the share of all assignments of signs to the
/// differences whose sum is as far from zero as theirs [Fisher 1935, section 21]. All of them up to
/// 16 differences, then 100 000 random ones of a fixed seed, with one added to both counts [Phipson
/// and Smyth 2010]. The minimum of n differences is 2^(1-n); 1 for none. Deterministic.
[[nodiscard]] double sign_flip_p(const std::vector<double>& differences);

/// P values for several tests together [Holm 1979], in the same order.
[[nodiscard]] std::vector<double> holm_adjusted(const std::vector<double>& p);

/// The run in a folder, by its run.yaml, without metrics.
[[nodiscard]] Expected<EvaluatedRun> read_run_identity(const std::filesystem::path& run);

/// Adds what the run's evaluation found: `report` is the text of its report.json.
[[nodiscard]] Expected<void> add_evaluation(const std::string& report, EvaluatedRun& run);

/// Groups runs by their settings and pairs those of one recording. Errors: a run given twice; two
/// runs of one recording under the same settings.
[[nodiscard]] Expected<RunComparison> compare_runs(std::vector<EvaluatedRun> runs);

/// evaluations.csv, paired.csv, report.json (`pcavr-evaluated-runs/1`) and report.html into a
/// folder that exists.
[[nodiscard]] Expected<void> write_run_comparison(const RunComparison& comparison,
                                                  const std::filesystem::path& folder);

/// The text of that report.json.
[[nodiscard]] std::string run_comparison_json(const RunComparison& comparison);

/// A table for a terminal: each metric's median by setting, then the differences with their p.
[[nodiscard]] std::string run_comparison_text(const RunComparison& comparison);

}  // namespace pcavr
