// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/contact/damping.hpp"
#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/friction/limit_surface_fit.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/identification/breakaway.hpp"
#include "pcavr/identification/contact_fit.hpp"
#include "pcavr/identification/estimator.hpp"
#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/identification/segmentation.hpp"
#include "pcavr/identification/signals.hpp"
#include "pcavr/identification/sliding.hpp"
#include "pcavr/model/cad_model.hpp"
#include "pcavr/recording/recording.hpp"
#include "pcavr/teleop/run_teleop.hpp"

namespace pcavr {

/// All times are seconds from the recording's start (start_of), on the tool's clock where the
/// force's differs.

enum class IdentificationGoal {
  contact,  ///< how the objects yield
  friction  ///< how they break away, slide and turn; what it needs of the contact, too
};

/// A body that the tool may have touched.
struct IdentifiableObject {
  std::string name;
  CadModel model;
  Pose T_base_object;                     ///< where it stands at the start
  std::optional<double> mass = {};        ///< [kg] where somebody weighed it
  std::vector<TrackedPose> tracked = {};  ///< may be empty: then its way is that of the pushes
};

struct IdentificationInput {
  std::vector<IdentifiableObject> objects;
  double tool_radius = 0.01;  ///< [m] of the spherical tip
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<Eigen::Quaterniond> q_base_tool = {};  ///< at `t_tool`; may be empty: not known
  std::vector<double> t_force;
  std::vector<Eigen::Vector3d> force_base;  ///< that the tool exerts [N]
  ParameterTable known = {};                ///< found earlier; what is found anew replaces it
  std::vector<LeftOut> left_out = {};       ///< rows and frames of the recording
};

/// What one contact of the recording was, and what it told.
struct IdentifiedContact {
  ContactEpisode episode;  ///< series along `episode.direction_base`
  std::optional<std::size_t> object = {};
  std::vector<Eigen::Vector3d> force_base = {};  ///< [N] at the stamps of `episode.t`
  std::string left_out = {};  ///< why nothing was learnt from it; empty where it was used
  double gap = 0.0;           ///< [m] between tip and the object's surface at touch
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();  ///< of the face touched, outward
  double lever = 0.0;              ///< [m] of the force about the centre of mass, from above
  IdentifiedParameter limit = {};  ///< [N] friction's limit, inertia taken off where possible
};

/// One estimator run over an object's presses as if it were there [paper C, figures 8 and 9].
struct EstimatorTrace {
  EstimationMethod method = EstimationMethod::adaptive;
  std::vector<double> t;                     ///< [s] in contact, one press after the other
  std::vector<double> measured;              ///< [N] filtered
  std::vector<double> estimated;             ///< [N] before the sample was learnt from
  std::array<std::vector<double>, 3> value;  ///< mass, damping, stiffness
  std::array<std::vector<double>, 3> deviation;
  std::optional<double> settling = {};  ///< [s] from touch until the error stays below 10 %
  double steady_error = 0.0;            ///< rms error over rms force in the second half
  /// Of the second half, where the tip holds still: mean force estimated against mean measured,
  /// press by press, and the mean of that. The sensors' noise is in `steady_error` sample by sample
  /// (the tip's times the stiffness), and in this only as far as a press does not average it out.
  /// Empty where no press was held for 0.1 s.
  std::optional<double> held_error = {};
};

/// The contact law of one face, from pushes before they broke away, under a given exponent.
struct FaceContact {
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
  int pushes = 0;
  ContactIdentification contact;
};

/// What came back from a short impact [paper B, eq. 11, 12].
struct MeasuredImpact {
  double t = 0.0;
  double approach_speed = 0.0;  ///< [m/s]
  double restitution = 0.0;
  DampingLaw law = DampingLaw::exact;   ///< the published law of the smallest error there
  double damping_over_stiffness = 0.0;  ///< [s/m] by the exact relation
};

/// A line of the table that a person reads.
struct ParameterFinding {
  std::string name;  ///< as in the parameter file
  std::string unit;
  double value = 0.0;
  std::optional<double> deviation = {};
  bool is_excited = false;
  std::string remark = {};  ///< where it came from, or what motion would tell it
};

struct ObjectIdentification {
  std::string name;
  ObjectParameters parameters;  ///< what is known now: goes into the parameter file
  std::vector<ParameterFinding> findings = {};
  ContactIdentification presses = {};
  int press_count = 0;
  /// The exponent is no result but the usual one: pushes before they break away do not identify it.
  bool is_exponent_given = false;
  std::vector<FaceContact> faces = {};
  std::vector<EstimatorTrace> comparison = {};
  std::vector<MeasuredImpact> impacts = {};
  LimitingFriction limit = {};
  SlidingIdentification sliding = {};
  LimitSurfaceFit surface = {};
  std::vector<PushSample> turning = {};
  std::optional<ParameterValue> friction_radius = {};
  std::vector<std::string> notes = {};  ///< what a reader should know, and better motions
};

struct Identification {
  IdentificationGoal goal = IdentificationGoal::contact;
  std::vector<ObjectIdentification> objects;  ///< as in the input
  std::vector<IdentifiedContact> contacts;    ///< in time's order
  TimeOffset tool_to_force = {};   ///< the force's stamps are this much late; known or not
  bool is_offset_applied = false;  ///< it was more than three deviations
  TimeOffset tool_to_camera = {};  ///< the tracked poses are this much late
  std::size_t spikes = 0;
  double force_noise = 0.0;  ///< [N]
  double max_drift = 0.0;    ///< [N] of the bias that was taken off
  std::vector<std::string> notes = {};
  std::vector<LeftOut> left_out = {};  ///< of the input

  /// The contacts that nothing was learnt from, by reason.
  [[nodiscard]] std::map<std::string, std::size_t> contacts_left_out() const;
  /// Everything that is known: the input's table with what was found.
  [[nodiscard]] ParameterTable parameters() const;
  ParameterTable known = {};
};

/// What a recording without force or without tool lacks, or with clocks that do not meet; nothing
/// where it will do. The file that it names is relative to the recording.
[[nodiscard]] std::optional<Error> missing_streams(const IdentificationInput& input);

/// Finds all contacts of a recording, whose they are, and what follows from them. Fails where there
/// is no force or no tool, where nothing was touched, and where the data show that the force's
/// sign, axes, unit or clock is wrong: another reading explains them decisively better than the one
/// as written. What is merely not identified is said in the result. Deterministic.
[[nodiscard]] Expected<Identification> identify(const IdentificationInput& input,
                                                IdentificationGoal goal);

struct IdentificationSources {
  std::filesystem::path scene = {};    ///< bodies and places from there; else the manifest's
  std::filesystem::path tracked = {};  ///< holds objects/NAME/tracked.txt; else images are tracked
  bool skip_bad = false;               ///< leave out images that don't decode
  Parallelism parallelism = Parallelism::max();
};

/// Gathers what identify() needs. Errors name the file that lacks something.
[[nodiscard]] Expected<IdentificationInput> identification_input(
    const Recording& recording, const IdentificationSources& sources,
    const Observer& observer = {});

/// report.html (one page, opens without a network) and report.json (flat, SI) into a folder that
/// exists. `recording` names the subject.
[[nodiscard]] Expected<void> write_identification_report(const Identification& found,
                                                         const std::string& recording,
                                                         const std::filesystem::path& folder);

}  // namespace pcavr
