// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/base/core/gravity.hpp"
#include "pcavr/physics/identification/breakaway.hpp"
#include "pcavr/physics/identification/contact_fit.hpp"
#include "pcavr/physics/identification/estimator.hpp"
#include "pcavr/physics/identification/motion_plan.hpp"
#include "pcavr/physics/identification/segmentation.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/sliding.hpp"

namespace pcavr {
namespace {

constexpr auto kSpikeFields = std::to_array<OptionField<SpikeOptions>>({
    {"half_window", &SpikeOptions::half_window, 3, 1, 50, "samples",
     "samples on either side that the middle one is compared with",
     "lower: two neighbouring outliers remain; higher: a sharp peak counts as an outlier"},
    {"threshold", &SpikeOptions::threshold, 5.0, 1.0, 100.0, "stds",
     "distance from the median, in robust standard deviations, of an outlier",
     "lower: valid samples are replaced; higher: outliers remain"},
});
static_assert(are_valid_fields(kSpikeFields));

constexpr auto kSaturationFields = std::to_array<OptionField<SaturationOptions>>({
    {"min_samples", &SaturationOptions::min_samples, 8, 2, 1000, "samples",
     "consecutive samples at exactly the same extreme that count as saturation",
     "lower: a coarse sensor's repeated reading counts as saturation; higher: short ones are "
     "missed"},
    {"min_extreme_ratio", &SaturationOptions::min_extreme_ratio, 8.0, 1.0, 1000.0, "stds",
     "extreme over the axis' noise below which an axis has no signal and does not saturate",
     "lower: repeated noise counts as saturation; higher: saturation at a low force is missed"},
});
static_assert(are_valid_fields(kSaturationFields));

constexpr auto kTimeOffsetFields = std::to_array<OptionField<TimeOffsetOptions>>({
    {"range", &TimeOffsetOptions::range, 0.25, 0.01, 10.0, "s",
     "maximum offset between two clocks that is searched",
     "lower: larger offsets are not found; higher: a periodic motion matches a period later, and "
     "signals must be longer than four ranges"},
    {"min_correlation", &TimeOffsetOptions::min_correlation, 0.5, 0.0, 1.0, "",
     "correlation below which the offset counts as unknown",
     "lower: offsets of unrelated signals are applied; higher: noisy signals have no offset"},
    {"smoothing_intervals", &TimeOffsetOptions::smoothing_intervals, 8.0, 3.0, 100.0, "intervals",
     "half width of the smoothing, in sampling intervals of the slower signal",
     "lower: noise roughens the correlation's peak; higher: fast changes are smoothed away"},
});
static_assert(are_valid_fields(kTimeOffsetFields));

constexpr auto kContactFitFields = std::to_array<OptionField<ContactFitOptions>>({
    {"half_width", &ContactFitOptions::half_width, 0.012, 0.001, 0.5, "s",
     "half width of the smoothing of force and tip; at least three samples are used",
     "lower: noise hides damping and mass; higher: fast presses lose their ends"},
    {"contact_threshold", &ContactFitOptions::contact_threshold, 6.0, 1.0, 100.0, "stds",
     "smoothed force, in its own stds, above which the tip is in contact",
     "lower: noise counts as contact; higher: the press's begin is cut off"},
    {"is_surface_shared", &ContactFitOptions::is_surface_shared, 1, 0, 1, "",
     "all presses meet the surface at the same coordinate",
     "0: the exponent is several times less accurate; 1: wrong for presses at different points"},
    {"drift_half_width", &ContactFitOptions::drift_half_width, 0.0, 0.0, 60.0, "s",
     "half width of the moving mean that is subtracted from each signal; 0: none",
     "lower: less than a period removes the oscillation; higher: the drift remains"},
    {"moving_half_width", &ContactFitOptions::moving_half_width, 0.5, 0.01, 60.0, "s",
     "half width of the moving mean about which a surface that moves under a modulated press is "
     "fitted, and of the force's local direction: 0.5 keeps a modulation of 1 Hz and faster",
     "lower: less than a period removes the modulation; higher: the surface's motion remains"},
    {"moving_window", &ContactFitOptions::moving_window, 2.0, 0.1, 60.0, "s",
     "duration that gives one stiffness of a surface that moves; their scatter gives the std",
     "lower: less than some periods is noisy; higher: few windows, whose scatter is not known"},
    {"min_moving_gain", &ContactFitOptions::min_moving_gain, 2.0, 1.0, 100.0, "",
     "residual force of a surface that stays over that of one that moves, from which it moves",
     "lower: its greater freedom fits a surface that stays; higher: slow motion biases the law"},
    {"max_exponent", &ContactFitOptions::max_exponent, 3.0, 1.0, 10.0, "",
     "upper bound of the Hunt-Crossley exponent",
     "lower: layered or conical contacts do not fit; higher: noisy presses get absurd exponents"},
    // A spherical tip on a flat face [Hertz 1882]; the std is that of a uniform distribution from
    // 1 (a flat tip, a layer) to 2 (a cone).
    {"prior_exponent", &ContactFitOptions::prior_exponent, 1.5, 1.0, 10.0, "",
     "Hunt-Crossley exponent before it is measured",
     "lower, higher: where noise hides it, the exponent is off accordingly"},
    {"prior_exponent_std", &ContactFitOptions::prior_exponent_std, 0.289, 1e-3, 100.0, "",
     "std of the Hunt-Crossley exponent before it is measured, and of one that is not",
     "lower: layered or conical contacts do not fit; higher: noisy presses get absurd exponents"},
    {"min_mass_stds", &ContactFitOptions::min_mass_stds, 2.0, 0.0, 100.0, "stds",
     "contact mass over its std below which it is removed from the model",
     "lower: an insignificant mass biases the stiffness; higher: a real mass is ignored"},
    {"min_improvement", &ContactFitOptions::min_improvement, 0.02, 0.0, 1.0, "",
     "share by which the Hunt-Crossley law must fit better than the linear one to be chosen",
     "lower: noise decides between the laws; higher: curved contacts are taken as linear"},
});
static_assert(are_valid_fields(kContactFitFields));

constexpr auto kBreakawayFields = std::to_array<OptionField<BreakawayOptions>>({
    {"half_width", &BreakawayOptions::half_width, 0.006, 0.001, 0.5, "s",
     "half width of the smoothing of the force; at least three samples are used",
     "lower: noise of the sensor remains; higher: a sharp peak comes out too low"},
    {"contact_threshold", &BreakawayOptions::contact_threshold, 6.0, 1.0, 100.0, "stds",
     "smoothed force, in its own stds, above which the tool is in contact",
     "lower: noise counts as contact; higher: soft objects are touched late"},
    {"guard", &BreakawayOptions::guard, 0.080, 0.005, 10.0, "s",
     "newest part of the push that is excluded from the line fit",
     "lower: a slow breakaway bends the line itself; higher: fast pushes have no line"},
    {"alarm_threshold", &BreakawayOptions::alarm_threshold, 5.0, 1.0, 100.0, "stds",
     "shortfall of the force below the line, in stds of the force, that raises the alarm",
     "lower: noise raises it; higher: weak breakaways are missed"},
    {"alarm_share", &BreakawayOptions::alarm_share, 0.03, 0.0, 1.0, "",
     "shortfall of the force, as a share of the line, that raises the alarm",
     "lower: a contact that is not linear raises it; higher: weak breakaways are missed"},
    {"peak_drop", &BreakawayOptions::peak_drop, 0.03, 0.0, 1.0, "",
     "share by which the force has to fall for its peak to have passed",
     "lower: a dip before the peak ends the search; higher: without a Stribeck effect it never "
     "ends by a drop"},
    {"flat_time", &BreakawayOptions::flat_time, 0.080, 0.005, 10.0, "s",
     "time without a rise of the force after which its peak has passed",
     "lower: a pause of the tool ends the search; higher: short slides are missed"},
});
static_assert(are_valid_fields(kBreakawayFields));

constexpr auto kOnsetFields = std::to_array<OptionField<OnsetOptions>>({
    {"min_displacement", &OnsetOptions::min_displacement, 5e-4, 1e-6, 0.1, "m",
     "displacement at which the object is surely moving: several noises of the tip's position",
     "lower: noise counts as motion; higher: short slides have no onset"},
    {"rest_time", &OnsetOptions::rest_time, 0.06, 0.005, 10.0, "s",
     "rest before the motion that is searched for the onset",
     "lower: slow onsets begin earlier; higher: takes longer, and creep counts as the onset"},
    {"moving_time", &OnsetOptions::moving_time, 0.02, 0.001, 1.0, "s",
     "motion after the onset that is fitted",
     "lower: too few samples; higher: friction and contact change meanwhile"},
    {"half_width", &OnsetOptions::half_width, 0.008, 0.001, 0.5, "s",
     "half width of the smoothing of position and force at the onset",
     "lower: noise remains; higher: the force at the onset is blurred"},
    // Observed on LuGre plants from 5 to 30 mm/s: 0.2 to 0.4.
    {"creep_share", &OnsetOptions::creep_share, 0.3, 0.0, 1.0, "",
     "error of the onset's force by creep, as a share of peak minus onset, included in its std",
     "lower: too confident for materials that creep; higher: fast pushes count for little"},
    {"max_acceleration_share", &OnsetOptions::max_acceleration_share, 0.05, 0.0, 1.0, "",
     "share of the force due to acceleration above which the onset is searched",
     "lower: slow pushes use the noisier onset; higher: fast pushes overestimate friction"},
});
static_assert(are_valid_fields(kOnsetFields));

constexpr auto kLimitingFrictionFields = std::to_array<OptionField<LimitingFrictionOptions>>({
    {"max_std_ratio", &LimitingFrictionOptions::max_std_ratio, 3.0, 1.0, 1e3, "",
     "std of a push over the median std above which it is left out",
     "lower: valid pushes are left out; higher: fast pushes among slow ones bias the mean"},
    {"outlier_stds", &LimitingFrictionOptions::outlier_stds, 5.0, 1.0, 1e3, "stds",
     "distance from the median of an outlier, in robust standard deviations",
     "lower: scatter of the surface is left out; higher: creep counts as a breakaway"},
    {"min_outlier_share", &LimitingFrictionOptions::min_outlier_share, 0.05, 0.0, 1.0, "",
     "distance from the median of an outlier, as a share of the median",
     "lower: very repeatable pushes have outliers; higher: creep counts as a breakaway"},
});
static_assert(are_valid_fields(kLimitingFrictionFields));

constexpr auto kSegmentationFields = std::to_array<OptionField<SegmentationOptions>>({
    {"half_width", &SegmentationOptions::half_width, 0.010, 0.001, 0.5, "s",
     "half width of the smoothing of the force",
     "lower: noise interrupts contacts; higher: short contacts merge"},
    {"enter_threshold", &SegmentationOptions::enter_threshold, 6.0, 1.0, 100.0, "stds",
     "smoothed force, in its own stds, above which a contact begins",
     "lower: noise counts as contact; higher: soft contacts are found late or not at all"},
    {"min_force", &SegmentationOptions::min_force, 0.3, 1e-3, 1e3, "N",
     "force above which a contact begins, whatever the noise",
     "lower: the sensor's drift counts as contact; higher: soft contacts are missed"},
    {"leave_share", &SegmentationOptions::leave_share, 0.5, 0.05, 1.0, "",
     "share of the threshold below which a contact ends",
     "lower: contacts merge; higher: noise splits them"},
    {"min_duration", &SegmentationOptions::min_duration, 0.050, 0.0, 10.0, "s",
     "shorter contacts and slides are ignored, shorter gaps closed",
     "lower: impacts count as pushes; higher: short pushes are ignored"},
    {"margin", &SegmentationOptions::margin, 0.200, 0.0, 10.0, "s",
     "free time that is kept around a contact",
     "lower: begin and end are not smoothed; higher: neighbouring contacts are included"},
    {"free_time", &SegmentationOptions::free_time, 0.6, 0.0, 10.0, "s",
     "free time next to a contact that the fit of its begin and end uses",
     "lower: soft contacts begin late; higher: the sensor's drift bends the fit"},
    {"bias_half_width", &SegmentationOptions::bias_half_width, 0.25, 0.005, 60.0, "s",
     "half width of the moving mean of the free force, which is the sensor's drift",
     "lower: noise counts as drift; higher: a fast drift remains"},
    {"max_drift", &SegmentationOptions::max_drift, 0.05, 0.0, 10.0, "N/s",
     "fastest drift of the force's bias that is not a contact: sensors that warm up have a tenth",
     "lower: a drifting bias counts as contact; higher: very slow presses count as drift"},
    // A cable or hose that is moved by half a metre pulls by a newton; tissue has hundreds of N/m.
    {"max_cable_stiffness", &SegmentationOptions::max_cable_stiffness, 3.0, 0.0, 100.0, "N/m",
     "change of the force's bias with the tip's place that is not a contact: cables pull on "
     "sensors",
     "lower: a cable's pull counts as contact; higher: very soft contacts count as a cable's"},
    {"max_impact", &SegmentationOptions::max_impact, 0.100, 0.0, 0.5, "s",
     "contacts up to this duration are impacts, if the tool's motion changes with them",
     "lower: soft impacts count as pushes; higher: fast presses count as impacts"},
    {"impact_flight", &SegmentationOptions::impact_flight, 0.060, 0.005, 0.5, "s",
     "free motion before and after an impact that shows the tool's speeds",
     "lower: noise of the tool's position remains; higher: the arm's servo changes the speed"},
    {"slide_half_width", &SegmentationOptions::slide_half_width, 0.030, 0.001, 1.0, "s",
     "half width of the smoothing of the object's speed",
     "lower: noise hides slow slides; higher: short slides are missed"},
    {"slide_speed", &SegmentationOptions::slide_speed, 0.001, 1e-6, 1.0, "m/s",
     "speed of the object above which it slides",
     "lower: noise and creep count as sliding; higher: slow pushes count as at rest"},
});
static_assert(are_valid_fields(kSegmentationFields));

constexpr auto kSlidingFields = std::to_array<OptionField<SlidingOptions>>({
    {"half_width", &SlidingOptions::half_width, 0.040, 0.001, 1.0, "s",
     "half width of the smoothing; well below the modulation's period",
     "lower: the acceleration is noise; higher: the modulation is smoothed away"},
    {"min_speed", &SlidingOptions::min_speed, 0.005, 1e-6, 1.0, "m/s",
     "speed below which the object may be sticking: excluded",
     "lower: presliding counts as sliding; higher: slow pushes are excluded"},
    {"min_force", &SlidingOptions::min_force, 1.0, 1e-3, 1e3, "N",
     "force below which the contact may be lost: excluded",
     "lower: lost contact counts as sliding; higher: light objects are excluded"},
    {"min_acceleration", &SlidingOptions::min_acceleration, 0.3, 0.0, 100.0, "m/s^2",
     "rms acceleration below which the mass is not excited",
     "lower: noise gives a mass; higher: gentle modulations give none"},
    {"min_speed_change", &SlidingOptions::min_speed_change, 0.005, 0.0, 10.0, "m/s",
     "rms speed beyond what acceleration explains, below which viscous friction is not excited",
     "lower: Coulomb and viscous friction are confounded; higher: viscous friction is ignored"},
    {"settle", &SlidingOptions::settle, 0.050, 0.0, 10.0, "s",
     "time after a stop that is excluded: friction has not settled",
     "lower: the Stribeck effect biases the friction; higher: few samples remain"},
    {"max_mass_share", &SlidingOptions::max_mass_share, 0.1, 0.001, 1.0, "",
     "std of the mass over its value up to which it counts as identified",
     "lower: masses stay unknown; higher: inaccurate masses are used"},
    {"max_viscous_share", &SlidingOptions::max_viscous_share, 0.3, 0.001, 10.0, "",
     "std of the viscous friction over its value up to which it counts as identified",
     "lower: viscous friction counts as Coulomb friction; higher: its noise is used"},
    {"min_forgetting", &SlidingOptions::min_forgetting, 0.8, 0.01, 0.999, "",
     "1 / (1 - this) samples are remembered right after a change of the parameters",
     "lower: noise after a change; higher: slow adaptation to a change"},
    {"error_window", &SlidingOptions::error_window, 10, 1, 10000, "samples",
     "samples whose mean squared error detects a change of the parameters",
     "lower: small changes are missed; higher: a change is detected late"},
    {"gravity", &SlidingOptions::gravity, kStandardGravity, 0.1, 100.0, "m/s^2",
     "gravity, which relates the friction coefficient to the friction",
     "lower, higher: the friction coefficient is off in proportion"},
});
static_assert(are_valid_fields(kSlidingFields));

using Plan = PlanOptions;
constexpr auto kPlanFields = std::to_array<OptionField<Plan>>({
    // Errors of this size change a predicted push by less than a millimetre.
    {"mass_std", &Plan::mass_std, 0.03, 1e-4, 1.0, "", "wished std of the mass, as a share",
     "lower: more slides; higher: starts and stops are wrong"},
    {"coefficient_std", &Plan::coefficient_std, 0.02, 1e-4, 1.0, "",
     "wished std of the sliding friction coefficient, as a share",
     "lower: more slides; higher: objects stop too early or too late"},
    {"viscous_std", &Plan::viscous_std, 0.15, 1e-4, 10.0, "",
     "wished std of the viscous friction, as a share",
     "lower: more slides; higher: friction is wrong at other speeds"},
    {"limit_std", &Plan::limit_std, 0.02, 1e-4, 1.0, "",
     "wished std of the limiting static friction, as a share",
     "lower: more pushes; higher: breakaway is predicted early or late"},
    {"exponent_std", &Plan::exponent_std, 0.03, 1e-4, 1.0, "",
     "wished std of the contact law's exponent",
     "lower: more presses; higher: the law is wrong at other penetrations"},
    {"damping_std", &Plan::damping_std, 0.1, 1e-3, 10.0, "",
     "wished std of the contact's damping, as a share",
     "lower: more presses; higher: impacts bounce too much or too little"},
    {"max_speed", &Plan::max_speed, 0.1, 1e-3, 1.0, "m/s",
     "maximum speed of the tip while it pushes",
     "lower: mass and viscous friction need more slides; higher: the robot can't follow"},
    {"frequency", &Plan::frequency, 2.0, 0.2, 20.0, "Hz",
     "frequency of a slide's modulation, well below the resonance of object, contact and arm",
     "lower: small accelerations, more slides; higher: the object oscillates on its contact"},
    {"slide_distance", &Plan::slide_distance, 0.09, 0.01, 1.0, "m",
     "length of a slide, of which objects move to and fro",
     "lower: more slides; higher: objects leave the support or the camera's view"},
    {"press_depth", &Plan::press_depth, 0.006, 1e-5, 0.1, "m",
     "maximum penetration of a press, of tip and object together; 2 mm at first, where the contact "
     "law is not known",
     "lower: noise hides the exponent; higher: the robot's or the object's limits are exceeded"},
    {"max_force", &Plan::max_force, 40.0, 0.1, 1e4, "N",
     "maximum force of a press, where the contact law is known",
     "lower: noise hides the exponent; higher: the robot's or the object's limits are exceeded"},
    // Collaborative and industrial arms have 2e4 to 5e5 N/m at the tip.
    {"arm_stiffness", &Plan::arm_stiffness, 5e4, 100.0, 1e8, "N/m",
     "stiffness between the command and the tip",
     "lower: more presses than needed, fast breakaways; higher: presses are shallower than "
     "planned, "
     "slides begin before the object breaks away"},
    {"clearance", &Plan::clearance, 0.03, 1e-3, 1.0, "m",
     "clearance of the tip above the objects between contacts",
     "lower: errors of the objects' poses become collisions; higher: longer paths"},
    {"max_contacts", &Plan::max_contacts, 12, 1, 1000, "contacts",
     "maximum number of contacts of one kind with one object",
     "lower: the wished stds are not reached; higher: long recordings"},
});
static_assert(are_valid_fields(kPlanFields));

template <int N>
constexpr auto kEstimatorFields = std::to_array<OptionField<EstimatorOptions<N>>>({
    {"window", &EstimatorOptions<N>::window, 30, N + 1, 1'000'000, "samples",
     "samples of a block (BSLS)", "lower: noisy estimates; higher: slow adaptation"},
    {"forgetting", &EstimatorOptions<N>::forgetting, 0.98, 0.01, 1.0, "",
     "forgetting factor (EWRLS)", "lower: noisy estimates; higher: slow adaptation"},
    {"min_forgetting", &EstimatorOptions<N>::min_forgetting, 0.8, 0.01, 0.999, "",
     "1 / (1 - this) samples are remembered right after a change (affRLS)",
     "lower: noise after a change; higher: slow adaptation to a change"},
    {"error_window", &EstimatorOptions<N>::error_window, 10, 1, 10000, "samples",
     "samples whose mean squared error detects a change (affRLS)",
     "lower: small changes are missed; higher: a change is detected late"},
    {"prior_information", &EstimatorOptions<N>::prior_information, 1e-6, 1e-15, 1.0, "",
     "minimum information kept on each scaled parameter",
     "lower: covariance wind-up without excitation; higher: estimates stay near their start"},
    {"correlated_samples", &EstimatorOptions<N>::correlated_samples, 1.0, 1.0, 1e6, "samples",
     "successive samples that count as one independent sample",
     "lower: filtered noise makes stds too small; higher: stds are too large"},
});
static_assert(are_valid_fields(kEstimatorFields<1>) && are_valid_fields(kEstimatorFields<4>));

using Averaging = AveragingOptions;
constexpr auto kAveragingFields = std::to_array<OptionField<Averaging>>({
    {"medium_forgetting", &Averaging::medium_forgetting, 0.98, 0.01, 0.9999, "",
     "forgetting factor of the estimator with a medium memory (affRLS)",
     "lower: no estimator fits slow drifts; higher: it equals the one with the long memory"},
    {"fast_forgetting", &Averaging::fast_forgetting, 0.9, 0.01, 0.9999, "",
     "forgetting factor of the estimator with a short memory (affRLS)",
     "lower: fast drifts are followed with more noise; higher: they are followed late"},
    {"fastest_forgetting", &Averaging::fastest_forgetting, 0.8, 0.01, 0.9999, "",
     "forgetting factor of the estimator with the shortest memory (affRLS)",
     "lower: noise after a change; higher: slow adaptation to a change"},
    {"weight_forgetting", &Averaging::weight_forgetting, 0.985, 0.5, 1.0, "",
     "factor per sample by which earlier errors count less in the estimators' weights",
     "lower: noise changes the weights; higher: the weights follow a change late"},
    // Chosen with weight_forgetting on ten seeds of steps, ramps and drifts.
    {"sharpness", &Averaging::sharpness, 8.0, 0.01, 1000.0, "",
     "factor of the estimators' errors in their weights",
     "lower: a mean of all follows a drift late; higher: noise chooses between them"},
    {"lag", &Averaging::lag, 1.4, 0.0, 100.0, "correlated samples",
     "age of the parameters whose errors are compared",
     "lower: a short memory predicts the filtered noise and is preferred; higher: later weights"},
});
static_assert(are_valid_fields(kAveragingFields));

}  // namespace

SpikeOptions::SpikeOptions() { set_defaults(*this, kSpikeFields); }
OptionSection section_of(SpikeOptions& options) {
  return make_section("identification.spikes", options, kSpikeFields);
}

SaturationOptions::SaturationOptions() { set_defaults(*this, kSaturationFields); }
OptionSection section_of(SaturationOptions& options) {
  return make_section("identification.saturation", options, kSaturationFields);
}

TimeOffsetOptions::TimeOffsetOptions() { set_defaults(*this, kTimeOffsetFields); }
OptionSection section_of(TimeOffsetOptions& options) {
  return make_section("identification.time_offset", options, kTimeOffsetFields);
}

ContactFitOptions::ContactFitOptions() { set_defaults(*this, kContactFitFields); }
OptionSection section_of(ContactFitOptions& options) {
  return make_section("identification.contact_fit", options, kContactFitFields);
}

BreakawayOptions::BreakawayOptions() { set_defaults(*this, kBreakawayFields); }
OptionSection section_of(BreakawayOptions& options) {
  return make_section("identification.breakaway", options, kBreakawayFields);
}

OnsetOptions::OnsetOptions() { set_defaults(*this, kOnsetFields); }
OptionSection section_of(OnsetOptions& options) {
  return make_section("identification.onset", options, kOnsetFields);
}

LimitingFrictionOptions::LimitingFrictionOptions() { set_defaults(*this, kLimitingFrictionFields); }
OptionSection section_of(LimitingFrictionOptions& options) {
  return make_section("identification.limiting_friction", options, kLimitingFrictionFields);
}

SegmentationOptions::SegmentationOptions() { set_defaults(*this, kSegmentationFields); }
OptionSection section_of(SegmentationOptions& options) {
  return make_section("identification.segmentation", options, kSegmentationFields);
}

SlidingOptions::SlidingOptions() { set_defaults(*this, kSlidingFields); }
OptionSection section_of(SlidingOptions& options) {
  return make_section("identification.sliding", options, kSlidingFields);
}

PlanOptions::PlanOptions() { set_defaults(*this, kPlanFields); }
OptionSection section_of(PlanOptions& options) {
  return make_section("identification.plan", options, kPlanFields);
}

template <int N>
EstimatorOptions<N>::EstimatorOptions() : method(EstimationMethod::adaptive) {
  scale.fill(1.0);
  min_excitation.fill(0.0);
  set_defaults(*this, kEstimatorFields<N>);
}
template <int N>
OptionSection section_of(EstimatorOptions<N>& options) {
  return make_section("identification.estimator", options, kEstimatorFields<N>);
}
AveragingOptions::AveragingOptions() { set_defaults(*this, kAveragingFields); }
OptionSection section_of(AveragingOptions& options) {
  return make_section("identification.averaging", options, kAveragingFields);
}

template struct EstimatorOptions<1>;
template struct EstimatorOptions<2>;
template struct EstimatorOptions<3>;
template struct EstimatorOptions<4>;
template OptionSection section_of(EstimatorOptions<1>& options);
template OptionSection section_of(EstimatorOptions<2>& options);
template OptionSection section_of(EstimatorOptions<3>& options);
template OptionSection section_of(EstimatorOptions<4>& options);

}  // namespace pcavr
