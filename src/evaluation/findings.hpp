// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/evaluation/object_errors.hpp"
#include "pcavr/evaluation/surface_errors.hpp"
#include "pcavr/evaluation/trajectory_errors.hpp"

#include "comparison_side.hpp"
#include "parameter_errors.hpp"
#include "run_findings.hpp"

namespace pcavr {

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
  std::optional<ObjectErrors> model = {};  ///< where there is a mesh of it
  std::vector<bool> moving = {};           ///< the reference, at each absolute error
};

/// One object's place in a scene against the reference's at that time.
struct PlacementFindings {
  std::string name;
  std::string when;          ///< "start" or "end"
  double translation = 0.0;  ///< [m]
  double rotation = 0.0;     ///< [rad]
  std::optional<ModelError> model = {};
};

struct SurfaceFindings {
  MeshErrors errors;
  std::size_t views = 0;                   ///< that decided what could be seen; 0: all of it counts
  std::optional<double> left_behind = {};  ///< share; where the reference has movable objects
};

/// Everything that both sides have, compared.
struct Findings {
  std::optional<CameraFindings> camera;
  std::vector<ObjectFindings> objects;
  std::vector<PlacementFindings> placements;
  std::optional<SurfaceFindings> surface;
  std::vector<std::string> objects_missing;  ///< the reference has them, the subject nowhere
  std::optional<RunFindings> run;
  std::vector<ParameterError> parameters;
  bool has_true_parameters = false;  ///< false: `parameters` are the subject's alone
  /// Plots and tables count time from here: the clock's zero, or for clocks that count from long
  /// ago the first pose of the reference.
  Stamp origin;
};

/// Reads what the subject holds beside trajectories if it is a run, and the truth for it, and adds
/// what follows from them to the findings. Called last.
[[nodiscard]] Expected<void> add_run(const ComparisonSide& reference, const ComparisonSide& subject,
                                     Findings& findings);

/// An Error where the two sides have nothing in common, or nothing at the same time.
[[nodiscard]] Expected<Findings> compare(const ComparisonSide& reference,
                                         const ComparisonSide& subject, Parallelism parallelism,
                                         const Observer& observer);

}  // namespace pcavr
