// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/pipeline/identify.hpp"

namespace pcavr {

/// One of several recordings of the same objects.
struct IdentificationRun {
  std::string name;  ///< of the recording, in texts
  Stamp start;       ///< of its clock
  IdentificationInput input;
  std::string support = {};  ///< what the objects stand on
};

/// What an object's runs are grouped by, beside the answer from all of them.
enum class RunGrouping {
  object,   ///< no groups
  support,  ///< IdentificationRun::support
  speed,    ///< median speed of the slides, in ranges from 2^k to 2^(k+1) mm/s
};

/// One parameter of an object in all runs that identified it.
struct PooledParameter {
  std::string name;  ///< as in the parameter file
  std::string unit;
  struct Run {
    std::size_t run = 0;            ///< index in PooledIdentification::runs
    ParameterValue value;           ///< by this run alone
    double stds_from_others = 0.0;  ///< [stds] from the other runs, see deviations_of_runs
  };
  std::vector<Run> runs = {};
  ParameterValue pooled = {};  ///< by the contacts of all runs, with the runs' scatter in its std
  double scatter = 0.0;        ///< of the runs' own effects
};

/// Runs of one support or range of speed, together.
struct PooledGroup {
  std::string name;
  std::vector<std::size_t> runs = {};
  /// Without friction that was known before, which is not of this group.
  std::vector<PooledParameter> parameters = {};
};

struct PooledObject {
  std::string name;
  ObjectIdentification found;              ///< by all runs that are not left out
  std::vector<std::size_t> runs = {};      ///< that touched it and agree
  std::vector<std::size_t> left_out = {};  ///< that contradict the others
  std::vector<PooledParameter> parameters = {};
  std::vector<PooledGroup> groups = {};  ///< of the runs that are not left out
  /// Stds of the limit surface's coefficients in its scales, which count as exact; empty without
  /// one.
  std::optional<std::array<double, 15>> surface_std = {};
};

struct PooledIdentification {
  IdentificationGoal goal = IdentificationGoal::friction;
  RunGrouping grouping = RunGrouping::object;
  std::vector<std::string> runs;           ///< by their start
  std::vector<Identification> alone;       ///< each run's own
  std::vector<PooledObject> objects = {};  ///< by name
  std::vector<std::string> warnings = {};
  std::vector<std::pair<std::string, std::string>> configuration = {};

  /// Those of `known`, updated with what was identified.
  [[nodiscard]] ParameterTable parameters() const;
  ParameterTable known = {};
};

/// Identifies each object from the contacts of all runs together: one posterior, whose stds contain
/// the runs' own effects (day, wear, humidity), stated as scatter. A run whose limiting friction or
/// coefficient is more than 5 stds from those of the other runs, of at least three, is left out, at
/// most a third of them, and named. The order of `runs` does not matter, except that runs of the
/// same start are in the order of their names. Errors: objects of one name and different bodies,
/// masses or tips; a run twice; a run that can't be identified. Friction known before is combined
/// with what is found (combine_with_known). `grouping`: each group is identified by its runs alone,
/// too. Deterministic.
[[nodiscard]] Expected<PooledIdentification> identify_runs(
    std::vector<IdentificationRun> runs, IdentificationGoal goal,
    const IdentificationOptions& options, RunGrouping grouping = RunGrouping::object,
    const Observer& observer = {});

/// report.html, report.json, runs.csv (a row for each run and parameter), parameters.tex, and with
/// a grouping groups.csv (a row for each group and parameter), into a folder that exists.
[[nodiscard]] Expected<void> write_pooled_report(const PooledIdentification& found,
                                                 const std::filesystem::path& folder);

}  // namespace pcavr
