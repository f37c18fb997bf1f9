// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/contact/damping.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/breakaway_motion.hpp"
#include "pcavr/physics/identification/contact.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/friction_posterior.hpp"
#include "pcavr/physics/identification/limit_of_pushes.hpp"
#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/sliding.hpp"
#include "pcavr/physics/inputs/input_options.hpp"
#include "pcavr/physics/inputs/input_series.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/turning/body_motion.hpp"

namespace pcavr {

/// The options of the methods that identify an object, each in its own section of a configuration
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
  bool compares_estimators = true;  ///< for a report; no parameter depends on it
};

/// The compliance by which a contact is compressed: with it the object's motion follows from the
/// tip's.
struct ContactCompliance {
  std::optional<HuntCrossley> law = {};  ///< without one, that of each push's own loading
  double std = 0.0;                      ///< relative, under the force of sliding
  double damping_std = 0.0;              ///< [s/m] of damping over stiffness
};

/// The known properties of an object's support, beside its CAD model.
struct KnownSupport {
  std::optional<double> friction_radius = {};  ///< [m]
  std::optional<double> weight = {};           ///< [N]
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
  /// The recordings whose contacts this is from, by their content; empty: not known.
  std::vector<std::string> recordings = {};
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
  /// The result of affRLS over the slides, for the plots; friction and coefficient are the
  /// posterior's, and `mass` is by accelerations alone.
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

/// The exponent of a spherical tip on a flat face [Hertz 1882], and the std of a uniform
/// distribution between 1 (a flat tip, a layer) and 2 (a cone): of laws by pushes before breakaway,
/// where a pushed object creeps, which biases the exponent. On simulated plants fits gave 1.0
/// to 1.4 where 1.5 was true, five to ten of their stds off.
inline constexpr double kExponentOfPushes = 1.5;
inline constexpr double kExponentStdOfPushes = 0.289;  // 1 / sqrt(12)

/// The face that gives the contact law where no press does: the one with the most pushes of those
/// that are usable. nullptr: none is.
[[nodiscard]] const FaceContact* face_of_law(const ObjectIdentification& found);

/// The usable contacts of one kind (presses or pushes) with an object.
[[nodiscard]] std::vector<Contact*> contacts_of(std::vector<Contact>& contacts, std::size_t object,
                                                bool presses);

/// A push with a larger lever arm about the centre meets less friction, because the object also
/// rotates: 1.5 % at a friction radius of 60 mm. Its limit is less certain by far:
/// excess_hidden_by_turning.
inline constexpr double kMaxCentredLever = 0.010;  // [m]
[[nodiscard]] bool is_centred(const Contact* push);

/// Pushes that turn the object, beside its viscous friction [N s/m]; needs tracking.
void identify_turning_of(std::vector<Contact>& contacts, std::size_t object, const BodyMotion& body,
                         const PathView& tip, double tool_radius, const ParameterValue& viscous,
                         const IdentificationOptions& options, ObjectIdentification& result);

/// Friction between tip and object, where the tip slid along a face.
void identify_tool_friction_of(const std::vector<Contact>& contacts, std::size_t object,
                               const BodyMotion& body, const BodySurface& surface,
                               const PathView& tip, double tool_radius,
                               ObjectIdentification& result);

/// Sliding, turning and breakaway of an object, from all its pushes, into `result`, of which the
/// known parameters and the contact law are used. `given_mass` [kg]: weighed. Where the object was
/// not tracked, `body` has no poses, and its model does not matter. `tip`: the path over the
/// contacts.
void identify_friction_of(std::vector<Contact>& contacts, std::size_t object,
                          std::optional<double> given_mass, const BodyMotion& body,
                          const PathView& tip, double tool_radius,
                          const IdentificationOptions& options, ObjectIdentification& result);

/// Std [N] of F_M as the dependence of friction's limit on the time [s] in which it is loaded:
/// under fast loading an object breaks loose before its contacts have adapted [Canudas de Wit et
/// al. 1995].
[[nodiscard]] double limit_rate_std(double limit, double loading_time,
                                    const BreakawayPriors& priors);

[[nodiscard]] ParameterValue as_value(const IdentifiedParameter& parameter);

/// States that the result is from these recordings, beside those that its known parameters are
/// from.
void add_recordings(const std::vector<std::string>& recordings, ObjectIdentification& result);

/// The damping of a contact law: identified, or the largest that the presses allow; empty where
/// they say nothing of it.
[[nodiscard]] std::optional<ParameterValue> damping_of(const ContactFit& fit);

/// Relative std of the penetration under `force` [N] by the linear law of `presses`, whose exponent
/// is uncertain: its distance from that by the curved law. 0 of the curved law, or without it.
[[nodiscard]] double curvature_std(const ContactIdentification& presses, const ContactFit& fit,
                                   double force);

}  // namespace pcavr
