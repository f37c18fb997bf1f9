// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// All times are seconds from the recording's start (start_of), on the tool's clock where the
/// force sensor's clock differs.

struct IdentificationInput {
  std::vector<IdentifiableObject> objects;
  double tool_radius = 0.01;  ///< [m] of the spherical tip
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<Eigen::Quaterniond> q_base_tool = {};  ///< at `t_tool`; may be empty: not known
  /// [m^2] of `p_base_tip` at `t_tool` by one common cause, such as gears of unknown stiffness: the
  /// errors of all samples have one sign. Empty: none.
  std::vector<Eigen::Matrix3d> tip_covariance_base = {};
  std::vector<double> t_force;
  std::vector<Eigen::Vector3d> force_base;  ///< that the tool exerts [N]
  double force_direction_std = 0.0;         ///< [rad] by a calibration of the sensor; 0: not known
  ParameterTable known = {};                ///< identified earlier; new results replace it
  std::vector<SkippedRows> left_out = {};   ///< rows and frames of the recording
  std::vector<std::string> notes = {};      ///< what was put right in the streams
};

struct Identification {
  IdentificationGoal goal = IdentificationGoal::contact;
  std::vector<ObjectIdentification> objects;  ///< as in the input
  std::vector<Contact> contacts;              ///< in order of time
  InputFindings inputs = {};                  ///< what the series show about themselves
  std::vector<std::string> notes = {};
  std::vector<std::string> warnings = {};  ///< of the notes: data that contradict each other
  std::vector<SkippedRows> left_out = {};  ///< rows and frames of the input

  /// The contacts that were not used, by reason.
  [[nodiscard]] std::map<std::string, std::size_t> contacts_left_out() const;
  /// The input's table, updated with what was identified.
  [[nodiscard]] ParameterTable parameters() const;
  ParameterTable known = {};
  /// Options that differ from their defaults; report.json repeats them.
  std::vector<std::pair<std::string, std::string>> configuration = {};
};

/// An Error for a recording without force, without tool motion, or with clocks that do not overlap;
/// else nothing. The file that it names is relative to the recording.
[[nodiscard]] std::optional<Error> missing_streams(const IdentificationInput& input);

/// Segments the contacts of a recording, attributes each to an object, and identifies the objects'
/// parameters. Fails where there is no force or no tool, where nothing was touched, and where the
/// data show that the force's sign, axes, unit, scale or clock is wrong: another interpretation
/// explains them decisively better than the data as written. A parameter that is merely not
/// identified is reported in the result. Deterministic.
[[nodiscard]] Expected<Identification> identify(const IdentificationInput& input,
                                                IdentificationGoal goal,
                                                const IdentificationOptions& options = {});

struct IdentificationSources {
  std::filesystem::path scene = {};  ///< bodies and poses from there; else from the manifest
  /// With objects/NAME/tracked.txt; else the recording's own `tracked`, else images are tracked.
  std::filesystem::path tracked = {};
  bool skip_bad = false;              ///< leave out images that don't decode
  PerceptionOptions perception = {};  ///< of the tracking in images
  Parallelism parallelism = Parallelism::max();
};

/// Gathers the input of identify(). Errors name the file that is incomplete.
[[nodiscard]] Expected<IdentificationInput> identification_input(
    const Recording& recording, const IdentificationSources& sources,
    const Observer& observer = {});

/// report.html (write_report_page) and report.json (flat, SI) into a folder that exists.
/// `recording` is the title's name of the recording.
[[nodiscard]] Expected<void> write_identification_report(const Identification& found,
                                                         const std::string& recording,
                                                         const std::filesystem::path& folder);

}  // namespace pcavr
