// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/results/evaluation/object_errors.hpp"
#include "pcavr/results/evaluation/options.hpp"
#include "pcavr/results/evaluation/surface_errors.hpp"
#include "pcavr/results/evaluation/trajectory_errors.hpp"

#include "comparison_side.hpp"
#include "error_map.hpp"
#include "parameter_errors.hpp"
#include "run_findings.hpp"

namespace pcavr {

struct EvaluatedRecording;

struct CameraFindings {
  Trajectory reference;
  Trajectory estimate;
  TrajectoryErrors errors;
};

/// One object's estimated trajectory against the reference's.
struct ObjectFindings {
  std::string name;
  std::string source;  ///< "tracked" or "predicted"
  Trajectory reference;
  Trajectory estimate;
  TrajectoryErrors errors;
  std::optional<ObjectErrors> model = {};  ///< where it has a mesh
  std::vector<bool> moving = {};           ///< whether the reference moves, at each absolute error
};

/// One object's pose in a scene against the reference's at that time.
struct PlacementFindings {
  std::string name;
  std::string when;          ///< "start" or "end"
  double translation = 0.0;  ///< [m]
  double rotation = 0.0;     ///< [rad]
  std::optional<ModelError> model = {};
};

struct SurfaceFindings {
  MeshErrors errors;
  std::size_t views = 0;                   ///< of the visibility test; 0: all of the surface counts
  std::optional<double> left_behind = {};  ///< share; where the reference has movable objects
  ErrorMap map = {};
};

/// Everything that both sides have, compared.
struct Findings {
  std::optional<CameraFindings> camera;
  std::vector<ObjectFindings> objects;
  std::vector<PlacementFindings> placements;
  std::optional<SurfaceFindings> surface;
  std::vector<std::string> objects_missing;  ///< without a pose in the subject
  std::optional<RunFindings> run;
  std::vector<ParameterError> parameters;
  bool has_true_parameters = false;  ///< false: `parameters` are the subject's alone
  /// Time origin of plots and tables: the clock's zero, or, where that is long ago, the first pose
  /// of the reference.
  Stamp origin;
};

/// If the subject is a run, reads its files other than trajectories, and the truth for them, and
/// adds their comparison to the findings. Called last.
[[nodiscard]] Expected<void> add_run(const ComparisonSide& reference, const ComparisonSide& subject,
                                     const EvaluatedRecording& recording,
                                     const ForceErrorOptions& options, Findings& findings);

/// An Error where the two sides have no data or no time span in common.
[[nodiscard]] Expected<Findings> compare(const ComparisonSide& reference,
                                         const ComparisonSide& subject,
                                         const EvaluationOptions& options, Parallelism parallelism,
                                         const Observer& observer);

}  // namespace pcavr
