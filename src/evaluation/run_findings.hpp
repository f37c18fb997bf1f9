// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "comparison_side.hpp"
#include "correction_figures.hpp"
#include "force_errors.hpp"
#include "phase_errors.hpp"
#include "run_files.hpp"
#include "time_nodes.hpp"

namespace pcavr {

struct ObjectFindings;

/// One record of the phases against a better one.
struct PhaseComparison {
  std::string key;        ///< "measured", "predicted" or "predicted_to_measured"
  std::string estimate;   ///< "measured" or "predicted"
  std::string reference;  ///< "truth" or "measured"
  std::map<std::string, PhaseErrors> objects = {};
};

struct NodeFindings {
  TimeNode node;                       ///< as the reference has it
  std::optional<Stamp> measured = {};  ///< of the matching event; nothing: missed
  std::optional<Stamp> predicted = {};
};

struct CorrectionFindings {
  CorrectionCounts counts;
  std::vector<CorrectionEffect> effects = {};     ///< of each correction
  std::map<std::string, Settling> settling = {};  ///< of each predicted object
};

/// What a run tells beside its trajectories.
struct RunFindings {
  RunFiles files;
  std::map<std::string, PhaseTimeline> true_phases;  ///< empty without truth
  std::vector<PhaseComparison> phase_comparisons;
  std::vector<NodeFindings> nodes;
  std::map<std::string, ForceErrors> forces;
  std::map<std::string, std::vector<ContactPeak>> peaks;
  std::optional<CorrectionFindings> corrections;
  Duration round_trip{};  ///< forward and backward delay

  /// The phases that errors are split by: the truth's, else those that the robot's site measured.
  [[nodiscard]] const std::map<std::string, PhaseTimeline>& phases() const {
    return true_phases.empty() ? files.measured : true_phases;
  }
  /// One object's; empty where it has none.
  [[nodiscard]] PhaseTimeline phases_of(const std::string& object) const;
};

/// Holds what the run recorded against the truth, where there is one, and against itself.
/// `objects` are the position errors that were found already.
[[nodiscard]] RunFindings compare_run(RunFiles files,
                                      std::map<std::string, PhaseTimeline> true_phases,
                                      const ComparisonSide& subject,
                                      const std::vector<ObjectFindings>& objects);

}  // namespace pcavr
