// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

namespace pcavr {

/// All times are seconds on the recording's clock, and mean the robot's site: what the operator
/// sees is stamped with the time of the remote world that it represents, so that it can be compared
/// with the tracking directly.

struct TeleopObject {
  std::string name;
  CadModel model;
  Pose T_base_object;                ///< initial pose at both sites
  ObjectParameters parameters;       ///< prior knowledge
  std::vector<TrackedPose> tracked;  ///< frames in which it was lost are left out
  bool is_movable = true;            ///< false: it keeps its pose, and every contact is a press
};

/// One recording as two sites see it. Stamps ascend strictly in every series.
struct TeleopInput {
  std::vector<TeleopObject> objects;
  TriangleMesh static_mesh_base;  ///< may be empty
  double tool_radius = 0.01;      ///< [m]
  std::vector<double> t_tool;     ///< the tool's motion is the operator's command
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<double> t_force;              ///< may be empty: no wrench was recorded
  std::vector<Eigen::Vector3d> force_base;  ///< that the tool exerts [N]
  /// At `t_tool`; may be empty: then a force in the tool's axes is not recognised as such.
  std::vector<Eigen::Quaterniond> q_base_tool = {};
};

/// The cases of the correction switch [paper C; methods of section 5].
enum class CorrectionCase {
  both_static_force,    ///< "1.1"
  touched_by_operator,  ///< "1.2a": contact at the operator's site only
  touched_by_robot,     ///< "1.2b": contact at the robot's site only
  both_sliding,         ///< "1.3"
  phases_differ,        ///< "2"
};
[[nodiscard]] std::string_view name_of(CorrectionCase which) noexcept;

struct SentCorrection {
  double t = 0.0;  ///< [s] time that it corrects
  std::size_t object = 0;
  CorrectionCase which = CorrectionCase::phases_differ;
  std::string what;       ///< "position", "contact parameters", "friction parameters", ...
  std::size_t bytes = 0;  ///< of the message as it is encoded
  bool is_lost = false;   ///< by the network
};

struct PhaseRow {
  double t = 0.0;  ///< [s]
  std::size_t object = 0;
  MotionPhase measured = MotionPhase::free;
  MotionPhase predicted = MotionPhase::free;
};

struct ForceRow {
  double t = 0.0;  ///< [s] a stamp of the wrench
  std::size_t object = 0;
  double measured = 0.0;   ///< [N] along the push, spikes, bias and drift removed
  double predicted = 0.0;  ///< [N] rendered to the operator at that time
};

/// A parameter of an object at both sites, where one of them has changed [paper C, figure 9].
struct ParameterRow {
  double t = 0.0;  ///< [s]
  std::size_t object = 0;
  const char* name = "";     ///< as in parameter files: "contact.stiffness", ...
  double running = 0.0;      ///< SI; at the robot's site, identified so far
  double transmitted = 0.0;  ///< SI; at the operator's site
};

struct ShownPose {
  double t = 0.0;
  Pose T_base_object;
};

/// Receives the per-cycle results of a run in order of time, so that they need not be kept in
/// memory. An Error ends the run. Called from the thread of run_teleop; every function but
/// `take_parameter` must be set.
struct TeleopSink {
  /// Takes the shown poses at the operator's rate, after blending.
  std::function<Expected<void>(std::size_t object, const ShownPose& shown)> take_shown;
  std::function<Expected<void>(const ForceRow& row)> take_force;  ///< while a site is in contact
  std::function<Expected<void>(const SentCorrection& sent)> take_correction;
  std::function<Expected<void>(const ParameterRow& row)> take_parameter = {};
};

/// The results of both sites, by object in the order of the input.
struct TeleopRun {
  std::vector<std::vector<ShownPose>> shown;      ///< empty if a sink received them, as are
  std::vector<ForceRow> forces;                   ///< forces
  std::vector<SentCorrection> corrections;        ///< and corrections
  std::vector<ParameterRow> parameter_rows;       ///< and the history of parameters
  std::size_t sent_corrections = 0;               ///< how many
  std::vector<PhaseRow> phases;                   ///< a row at each change, and one at the start
  std::vector<ObjectParameters> parameters;       ///< as known at the end
  std::vector<std::vector<std::string>> assumed;  ///< parameters with default values at the start
  std::size_t correction_bytes = 0;
  /// Bytes for sending every tracked pose and every wrench sample, in the same encoding.
  std::size_t streaming_bytes = 0;
  InputFindings inputs = {};       ///< what the recording shows about itself
  std::vector<std::string> notes;  ///< remarks for the report
};

/// Simulates both sites in virtual time over a recording, which reaches the robot's site sample by
/// sample, as it would a live one: what the inputs show about noise, clocks and faults applies from
/// when it is found. An Error only if an object can't be made a body, or when the tool's unit or
/// clock turns out to be wrong; a force that shows another fault is not used from then on.
/// Deterministic.
[[nodiscard]] Expected<TeleopRun> run_teleop(const TeleopInput& input, const TeleopOptions& options,
                                             const Observer& observer = {});
/// The same, with the per-cycle results passed to `sink`: besides the input, memory is that of some
/// ten minutes (calibration) and of the longest contact. Also an Error if the sink returns one.
[[nodiscard]] Expected<TeleopRun> run_teleop(const TeleopInput& input, const TeleopOptions& options,
                                             const TeleopSink& sink, const Observer& observer = {});

}  // namespace pcavr
