// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "comparison_side.hpp"
#include "correction_metrics.hpp"
#include "force_errors.hpp"
#include "phase_errors.hpp"
#include "run_files.hpp"
#include "time_nodes.hpp"

namespace pcavr {

struct ObjectFindings;

/// One record of the phases against a more accurate one.
struct PhaseComparison {
  std::string key;        ///< "measured", "predicted" or "predicted_to_measured"
  std::string estimate;   ///< "measured" or "predicted"
  std::string reference;  ///< "truth" or "measured"
  std::map<std::string, PhaseErrors> objects = {};
};

struct NodeFindings {
  TimeNode node;                       ///< of the reference
  std::optional<Stamp> measured = {};  ///< of the matching event; empty: missed
  std::optional<Stamp> predicted = {};
};

struct CorrectionFindings {
  CorrectionCounts counts;
  std::vector<CorrectionEffect> effects = {};     ///< of each correction
  std::map<std::string, Settling> settling = {};  ///< of each predicted object
};

/// The torque of a contact's peak force at the arm's joint that it loads most [N m].
struct JointLoad {
  std::string object = {};
  Stamp begin = {};  ///< of the contact
  std::string joint;
  double measured = 0.0;
  double rendered = 0.0;
};

/// The results of a run other than its trajectories' errors.
struct RunFindings {
  RunFiles files;
  std::map<std::string, PhaseTimeline> true_phases;  ///< empty without truth
  std::vector<PhaseComparison> phase_comparisons;
  std::vector<NodeFindings> nodes;
  std::map<std::string, ForceErrors> forces;
  /// Errors from the first arrival of parameters on, of objects that received some.
  std::map<std::string, ForceErrors> forces_with_parameters;
  std::map<std::string, std::vector<ContactPeak>> peaks;
  std::vector<JointLoad> joint_loads = {};  ///< of the peaks, where an arm did the contacts
  std::optional<CorrectionFindings> corrections;
  Duration round_trip{};  ///< forward and backward delay

  /// The phases by which errors are split: the truth's, else those measured at the robot's site.
  [[nodiscard]] const std::map<std::string, PhaseTimeline>& phases() const {
    return true_phases.empty() ? files.measured : true_phases;
  }
  /// One object's; empty where it has none.
  [[nodiscard]] PhaseTimeline phases_of(const std::string& object) const;
};

/// Compares the run's files with the truth, where there is one, and with each other. `objects` has
/// the position errors.
[[nodiscard]] RunFindings compare_run(RunFiles files,
                                      std::map<std::string, PhaseTimeline> true_phases,
                                      const ComparisonSide& subject,
                                      const std::vector<ObjectFindings>& objects,
                                      const ForceErrorOptions& options);

}  // namespace pcavr
