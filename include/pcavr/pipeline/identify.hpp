// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/contact/damping.hpp"
#include "pcavr/core/expected.hpp"
#include "pcavr/core/observer.hpp"
#include "pcavr/core/parallel.hpp"
#include "pcavr/friction/limit_surface_fit.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/geometry/tracked_pose.hpp"
#include "pcavr/identification/breakaway.hpp"
#include "pcavr/identification/breakaway_motion.hpp"
#include "pcavr/identification/contact_fit.hpp"
#include "pcavr/identification/estimator.hpp"
#include "pcavr/identification/friction_posterior.hpp"
#include "pcavr/identification/limit_of_pushes.hpp"
#include "pcavr/identification/motion_plan.hpp"
#include "pcavr/identification/press_line.hpp"
#include "pcavr/identification/segmentation.hpp"
#include "pcavr/identification/sliding.hpp"
#include "pcavr/inputs/input_findings.hpp"
#include "pcavr/inputs/input_options.hpp"
#include "pcavr/inputs/input_series.hpp"
#include "pcavr/model/cad_model.hpp"
#include "pcavr/object/object_parameters.hpp"
#include "pcavr/pipeline/perception_options.hpp"
#include "pcavr/recording/recording.hpp"

namespace pcavr {

/// All times are seconds from the recording's start (start_of), on the tool's clock where the
/// force sensor's clock differs.

enum class IdentificationGoal {
  contact,  ///< contact law: stiffness, damping, exponent
  friction  ///< breakaway, sliding and turning friction; with the contact law that these need
};

/// A body that the tool may have touched.
struct IdentifiableObject {
  std::string name;
  CadModel model;
  Pose T_base_object;                     ///< pose at the start
  std::optional<double> mass = {};        ///< [kg] where it was weighed
  std::vector<TrackedPose> tracked = {};  ///< may be empty: then its motion follows from the pushes
  /// False: every contact is a press, whatever its direction, and only the contact law is
  /// identified.
  bool is_movable = true;
};

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
  ParameterTable known = {};                ///< identified earlier; new results replace it
  std::vector<SkippedRows> left_out = {};   ///< rows and frames of the recording
};

/// The options of the methods that identify() applies, each in its own section of a configuration
/// file; the segmentation is that of `inputs`.
struct IdentificationOptions {
  InputOptions inputs;
  ContactFitOptions contact_fit;
  OnsetOptions onset;
  LimitingFrictionOptions limiting_friction;
  SlidingOptions sliding;
  FrictionPriors friction_priors;
  BreakawayPriors breakaway_priors;
  LimitSurfaceFitOptions limit_surface;
  PlanOptions plan;               ///< of plan_motion
  EstimatorOptions<3> estimator;  ///< of the comparison of BSLS, EWRLS and affRLS on the presses
  /// Damping from impacts; empty: the published law that paper B's criterion chooses (eq. 12). The
  /// exact relation has no error, the published ones up to hundreds of per cent.
  std::optional<DampingLaw> damping_law = DampingLaw::exact;
};

/// One contact of the recording, and what was identified from it.
struct IdentifiedContact : AttributedContact {
  IdentifiedParameter limit = {};  ///< [N] friction limit, less inertia where possible
  double limit_shared_std = 0.0;   ///< [N] ... and its std that the object's pushes have in common
  double breakaway_lever = 0.0;    ///< [m] of the force then; 0 where the object was not tracked
  double breakaway_turning = 0.0;  ///< [rad/m] of the object's first travel; 0 likewise
  /// [m] std of the episode's `tool` by a cause that all samples share; empty: none.
  std::vector<double> tip_std = {};
  /// Of a push, where a press gave the object's contact law; its ratio may be not excited.
  std::optional<PressLine> press_line = {};
};

/// One estimator run online over an object's recorded presses [paper C, figures 8 and 9].
struct EstimatorTrace {
  EstimationMethod method = EstimationMethod::averaged;
  std::vector<double> t;                     ///< [s] in contact, one press after the other
  std::vector<double> measured;              ///< [N] filtered
  std::vector<double> estimated;             ///< [N] predicted before the update with this sample
  std::array<std::vector<double>, 3> value;  ///< mass, damping, stiffness
  std::array<std::vector<double>, 3> std;
  /// [s] from the first touch until the parameters predict the first press's largest force within
  /// 10 %, and go on doing so. Empty where they never do.
  std::optional<double> settling = {};
  /// Relative: rms error over rms force, second half, by the parameters of one filter width before:
  /// newer ones of a short memory follow the filtered noise.
  double steady_error = 0.0;
  /// Relative error of the mean force over the samples of the second half in which the tip is
  /// stationary, per press, averaged over the presses. Unlike `steady_error`, which contains the
  /// sensors' noise of every sample (the tip's times the stiffness), this averages the noise out.
  /// Empty where the tip was stationary for 0.1 s in no press.
  std::optional<double> mean_force_error = {};
};

/// The contact law of one face, from pushes before breakaway, under a given exponent.
struct FaceContact {
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
  int pushes = 0;
  ContactIdentification contact;
  /// Its penetration is known; its stiffness, too, where `stiffness.is_excited` says so.
  bool is_usable = false;
};

/// Restitution and damping of a short impact [paper B, eq. 11, 12].
struct MeasuredImpact {
  double t = 0.0;                           ///< [s]
  double duration = 0.0;                    ///< [s] above the force's threshold
  IdentifiedParameter approach_speed = {};  ///< [m/s]
  IdentifiedParameter restitution = {};
  IdentifiedParameter mass = {};       ///< [kg] effective, of the tool
  DampingLaw law = DampingLaw::exact;  ///< the published law with the smallest error there
  /// lambda / k [s/m] by the exact relation.
  IdentifiedParameter damping_over_stiffness = {};
  /// k [N/m^n] from the width of the force's pulse, with the std of its own noise; not excited
  /// where the sensor's averaging hides it.
  IdentifiedParameter stiffness = {};
};

/// The impacts of one object together.
struct ImpactFindings {
  IdentifiedParameter restitution = {};             ///< weighted mean
  IdentifiedParameter damping_over_stiffness = {};  ///< lambda / k [s/m], weighted mean
  IdentifiedParameter stiffness = {};               ///< k [N/m^n] for exactly `exponent`
  double stiffness_std = 0.0;                       ///< with the exponent's share
  double exponent = 1.5;
  DampingLaw law = DampingLaw::exact;  ///< of damping_over_stiffness
  std::string choice = {};             ///< how the law was chosen
  bool gives_damping = false;          ///< the parameters' damping is from here
  bool gives_stiffness = false;        ///< and the stiffness
};

/// A row of the printed parameter table.
struct ParameterFinding {
  std::string name;  ///< as in the parameter file
  std::string unit;
  double value = 0.0;
  std::optional<double> std = {};
  bool is_excited = false;
  std::string remark = {};  ///< its source, or the motion that would identify it
};

/// The penetration by the contact law, which is known better than the law's own parameters: their
/// errors compensate each other there.
struct PenetrationFinding {
  double relative_std = 0.0;  ///< from a quarter of `max_force` on; 0 where the law was not found
  double max_force = 0.0;     ///< [N] that the law was found by
  double force = 0.0;         ///< [N] at which it is stated: F_M, else `max_force`
  IdentifiedParameter depth = {};  ///< [m] there
};

struct ObjectIdentification {
  std::string name;
  bool is_movable = true;
  ObjectParameters parameters;  ///< all known parameters: goes into the parameter file
  std::vector<ParameterFinding> findings = {};
  ContactIdentification presses = {};
  int press_count = 0;
  /// The exponent is an assumption (Hertz): pushes before breakaway do not identify it.
  bool is_exponent_given = false;
  /// The contact law rests on pushes off the centre of mass alone: under the load the object turns,
  /// so that the stiffness comes out up to a half too small. It corrects the compression in the
  /// estimates of friction, and is not a result.
  bool is_contact_off_centre = false;
  PenetrationFinding penetration = {};
  std::vector<FaceContact> faces = {};
  std::vector<EstimatorTrace> comparison = {};
  std::vector<MeasuredImpact> impacts = {};
  ImpactFindings impact_findings = {};
  LimitingFriction limit = {};  ///< which pushes count; the values are `limit_of_pushes`
  LimitOfPushes limit_of_pushes = {};
  /// By affRLS over the slides, for the plots; friction and coefficient are the posterior's, and
  /// `mass` is by accelerations alone.
  SlidingIdentification sliding = {};
  FrictionPosterior friction = {};
  std::vector<FrictionSample> slide_samples = {};  ///< that `friction` is inferred from
  bool is_mass_given = false;  ///< the parameters' mass is the weighed or known one
  LimitSurfaceFit surface = {};
  std::vector<PushSample> turning = {};
  std::optional<ParameterValue> friction_radius = {};
  int tool_friction_contacts = 0;       ///< in which the tip slid along a face
  std::vector<std::string> notes = {};  ///< for the user, with proposals of better motions
};

struct Identification {
  IdentificationGoal goal = IdentificationGoal::contact;
  std::vector<ObjectIdentification> objects;  ///< as in the input
  std::vector<IdentifiedContact> contacts;    ///< in order of time
  InputFindings inputs = {};                  ///< what the series show about themselves
  std::vector<std::string> notes = {};
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
/// data show that the force's sign, axes, unit or clock is wrong: another interpretation explains
/// them decisively better than the data as written. A parameter that is merely not identified is
/// reported in the result. Deterministic.
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
