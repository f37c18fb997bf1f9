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
#include "pcavr/base/core/stamp.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

#include "phase_timeline.hpp"

namespace pcavr {

/// A row of `force.csv`: force along the push, at a stamp of the wrench.
struct ForceSample {
  Stamp stamp;
  double measured = 0.0;  ///< [N]
  double rendered = 0.0;  ///< column `virtual`: rendered to the operator then [N]
};

/// A row of `corrections.csv`.
struct RunCorrection {
  Stamp stamp;  ///< the time that it corrects
  std::string object;
  std::string which;                   ///< "1.1", "1.2a", "1.2b", "1.3" or "2"
  std::vector<std::string> what = {};  ///< "position", "friction parameters", ...
  bool is_lost = false;                ///< by the network
  std::size_t bytes = 0;
};

/// A row of `parameters.csv`: a parameter at both sites, where one of them has changed.
struct ParameterSample {
  Stamp stamp;
  double running = 0.0;      ///< SI; at the robot's site
  double transmitted = 0.0;  ///< SI; at the operator's site
};
/// Samples by parameter, as named in parameter files.
using ParameterSamples = std::map<std::string, std::vector<ParameterSample>>;

/// Settings of the two sites in `run.yaml`; empty where not given.
struct RunSettings {
  std::optional<std::string> parameters;  ///< the initial parameter file, or "none"
  std::optional<double> forward_delay;    ///< [s]
  std::optional<double> backward_delay;   ///< [s]
  std::optional<double> jitter;           ///< [s]
  std::optional<double> loss;             ///< share of corrections dropped, 0 to 1
  std::optional<bool> corrections;
  std::optional<bool> identifies;
  std::optional<double> correction_bytes;
  std::optional<double> streaming_bytes;  ///< of streaming the whole state instead
  std::map<std::string, std::vector<std::string>>
      assumed;  ///< parameters with default values, by object
  std::vector<std::string> notes;
};

/// A run's files other than trajectories; a missing file leaves its part empty.
struct RunFiles {
  RunSettings settings;
  std::map<std::string, std::vector<ForceSample>> forces;  ///< by object, ascending
  std::map<std::string, PhaseTimeline> measured;
  std::map<std::string, PhaseTimeline> predicted;
  std::optional<std::vector<RunCorrection>> corrections;
  std::map<std::string, ParameterSamples> parameter_history;  ///< by object
  std::optional<ParameterTable> parameters;
};

/// A recording's truth files other than trajectories and surfaces.
struct TruthFiles {
  std::map<std::string, PhaseTimeline> phases;
  std::optional<ParameterTable> parameters;
};

/// Reads strictly: a file that exists but can't be read is an Error with file and line. Stamps
/// ascend within each object (corrections: may repeat).
[[nodiscard]] Expected<RunFiles> read_run_files(const std::filesystem::path& run);
[[nodiscard]] Expected<TruthFiles> read_truth_files(const std::filesystem::path& truth);

/// The settings above of a run.yaml; other keys are ignored.
[[nodiscard]] Expected<RunSettings> parse_run_settings(const std::string& text,
                                                       const std::string& file);

}  // namespace pcavr
