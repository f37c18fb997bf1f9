// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include "pcavr/robots/robot_identification/contact_observer.hpp"
#include "pcavr/robots/robot_identification/exciting_motion.hpp"
#include "pcavr/robots/robot_identification/friction_intervals.hpp"
#include "pcavr/robots/robot_identification/friction_trial.hpp"
#include "pcavr/robots/robot_identification/joint_signals.hpp"
#include "pcavr/robots/robot_identification/payload.hpp"
#include "pcavr/robots/robot_identification/robot_fit.hpp"

namespace pcavr {
namespace {

constexpr auto kSignalFields = std::to_array<OptionField<JointSignalOptions>>({
    {"bandwidth", &JointSignalOptions::bandwidth, 0.0, 0.0, 1000.0, "Hz",
     "-6 dB frequency of the zero-phase filter of all signals; 0: from the motion",
     "lower: accelerations of the motion are lost; higher: noise in accelerations"},
    {"bandwidth_of_motion", &JointSignalOptions::bandwidth_of_motion, 20.0, 2.0, 200.0, "",
     "filter bandwidth over the highest frequency of the motion, at most a tenth of the rate",
     "lower: reversals of friction are lost; higher: more noise"},
    {"rows_per_period", &JointSignalOptions::rows_per_period, 8.0, 4.0, 100.0, "",
     "rows kept per period of the bandwidth (decimation)",
     "lower: aliasing; higher: slower, without further information"},
    {"max_rest", &JointSignalOptions::max_rest, 0.5, 0.05, 1e6, "s",
     "longer stretches in which all joints rest are left out: friction is not determined there",
     "lower: reversals of slow motions are lost; higher: static friction is fitted as sliding"},
    {"max_gap", &JointSignalOptions::max_gap, 0.05, 1e-3, 10.0, "s",
     "longer intervals without rows are left out, with their surroundings",
     "lower: jitter counts as a gap; higher: interpolated rows are fitted"},
});
static_assert(are_valid_fields(kSignalFields));

constexpr auto kFitFields = std::to_array<OptionField<RobotFitOptions>>({
    {"train_share", &RobotFitOptions::train_share, 0.65, 0.2, 1.0, "",
     "first part of the log that is fitted; the rest is held out",
     "lower: less motion to fit; higher: less to judge by"},
    {"huber_threshold", &RobotFitOptions::huber_threshold, 2.5, 1.0, 100.0, "std",
     "residuals beyond this count linearly",
     "lower: valid rows are discounted; higher: outliers bias the fit"},
    {"prior_mass_std", &RobotFitOptions::prior_mass_std, 3.0, 1e-3, 1000.0, "kg",
     "std of each body's mass about the description's, before the data",
     "lower: the description wins over the data; higher: weakly excited parameters are noise"},
    {"prior_offset_std", &RobotFitOptions::prior_offset_std, 0.15, 1e-3, 10.0, "m",
     "std of each body's centre of mass and radius of gyration, before the data",
     "lower: the description wins over the data; higher: weakly excited parameters are noise"},
    {"min_gain", &RobotFitOptions::min_gain, 0.02, 0.0, 0.5, "",
     "relative decrease of the cross-validated error for which a friction term is added",
     "lower: terms that do not generalise; higher: friction that is visible stays unmodelled"},
    {"usual_torque_lag", &RobotFitOptions::usual_torque_lag, 0.012, 0.0, 0.1, "s",
     "lag of the torques after the positions beyond which a warning names it",
     "lower: warnings about filters of drives; higher: faults of stamps are removed in silence"},
    {"max_torque_lag", &RobotFitOptions::max_torque_lag, 0.05, 0.0, 0.1, "s",
     "lag of the torques after the positions that is removed; a longer one is an error",
     "lower: logs with late torques are refused; higher: other faults may look like a lag"},
    {"smoothing_speed", &RobotFitOptions::smoothing_speed, 0.0, 0.0, 1.0, "rad/s",
     "speed over which Coulomb friction changes its sign; 0: chosen by cross-validation",
     "lower: noise of the speed changes the sign; higher: Coulomb friction counts as viscous"},
    {"known_body", &RobotFitOptions::known_body, 0.0, 0.0, 1.0, "",
     "inertias are the description's; friction alone is fitted",
     "off: inertias are fitted; on: errors of the description go into the friction"},
    {"physical", &RobotFitOptions::is_physical, 1.0, 0.0, 1.0, "",
     "only bodies with positive definite pseudo-inertia",
     "off: the fit may have negative masses; on: slower"},
    {"extended_friction", &RobotFitOptions::is_extended, 1.0, 0.0, 1.0, "",
     "try Stribeck, load-dependent and further terms of friction",
     "off: Coulomb, viscous, offset and motor inertia alone; on: slower"},
    {"coupled_joints", &RobotFitOptions::are_couplings_tried, 1.0, 0.0, 1.0, "",
     "look for motors that turn with two joints, as in wrists",
     "off: a shared transmission goes into bodies and friction; on: slower"},
});
static_assert(are_valid_fields(kFitFields));

constexpr auto kContactFields = std::to_array<OptionField<ContactObserverOptions>>({
    {"gain", &ContactObserverOptions::gain, 50.0, 1.0, 1000.0, "1/s",
     "of the momentum observer: its time constant is 1 / gain",
     "lower: touches are found late; higher: noise of the velocities raises the thresholds"},
    {"margin", &ContactObserverOptions::margin, 1.5, 1.0, 20.0, "",
     "threshold over the largest external torque of the rows without contact",
     "lower: false alarms; higher: light touches are missed"},
    {"min_duration", &ContactObserverOptions::min_duration, 0.003, 0.0, 1.0, "s",
     "time above a threshold that counts as a touch",
     "lower: single samples are alarms; higher: touches are found late"},
    // Noise of 10 ms rows falls by some three times, and a push is found within 0.2 s.
    {"filter_time", &ContactObserverOptions::filter_time, 0.1, 0.0, 10.0, "s",
     "time constant of the further low pass that light touches are looked for behind",
     "lower: noise raises their thresholds; higher: they are found late"},
    // Below this speed gears' friction falls from static to Coulomb's, and its sign is smoothed in
    // fits.
    {"slow_speed", &ContactObserverOptions::slow_speed, 0.1, 0.0, 1.0, "rad/s",
     "friction's sign is uncertain below it: thresholds of light touches are apart there",
     "lower: reversals raise the thresholds of all motion; higher: less motion is judged lightly"},
    {"false_alarm_spacing", &ContactObserverOptions::false_alarm_spacing, 1e6, 1e2, 1e12, "",
     "errors of either sign of the torque for each one beyond a light threshold, of Gaussian noise",
     "lower: false alarms; higher: light touches are missed"},
});
static_assert(are_valid_fields(kContactFields));

constexpr auto kTrialFields = std::to_array<OptionField<FrictionTrialOptions>>({
    {"stretch", &FrictionTrialOptions::stretch, 1.0, 0.1, 60.0, "s",
     "motion that one trial simulates from a recorded state",
     "lower: friction hardly changes the position; higher: errors of the bodies add up"},
    {"stretches", &FrictionTrialOptions::stretches, 10, 1, 1000, "",
     "of the fitted part that are simulated, evenly distributed",
     "lower: valid for these stretches alone; higher: slower"},
    {"viscous_only", &FrictionTrialOptions::is_viscous_only, 0.0, 0.0, 1.0, "",
     "no Coulomb friction: one parameter a joint, as paper A has it",
     "off: two parameters are tried; on: valid near the speeds of the log alone"},
});
static_assert(are_valid_fields(kTrialFields));

constexpr auto kIntervalFields = std::to_array<OptionField<FrictionIntervalOptions>>({
    {"intervals", &FrictionIntervalOptions::intervals, 6, 1, 100, "",
     "of each joint's position that friction is tabulated by",
     "lower: friction that changes with the position is averaged; higher: few rows in each"},
    {"prior_share", &FrictionIntervalOptions::prior_share, 0.3, 0.001, 10.0, "",
     "std of an interval's friction about that of the whole motion, over the latter",
     "lower: the table has the same values everywhere; higher: it follows the noise"},
});
static_assert(are_valid_fields(kIntervalFields));

// 0.1: torque constants of data sheets are within some 7 to 10 %, gears lose 10 to 30 % that depend
// on load and warmth; published gains of a UR10e are 1 to 15 % below those by a known load.
constexpr auto kPayloadFields = std::to_array<OptionField<PayloadOptions>>({
    {"gain_std", &PayloadOptions::gain_std, 0.1, 0.0, 1.0, "",
     "relative std of the gains that --gains gives: part of the load's stds",
     "lower: the load's stds leave out what is not known of the drives; higher: they are too wide"},
});
static_assert(are_valid_fields(kPayloadFields));

using Exciting = ExcitingMotionOptions;
constexpr auto kExcitingFields = std::to_array<OptionField<Exciting>>({
    {"duration", &Exciting::duration, 30.0, 1.0, 600.0, "s", "of the planned motion",
     "lower: larger stds; higher: the arm warms up, and its friction changes"},
    {"frequency", &Exciting::frequency, 0.1, 0.01, 5.0, "Hz", "of the slowest harmonic",
     "lower: slow motions, gravity alone; higher: small motions, within the speed limits"},
    {"harmonics", &Exciting::harmonics, 5, 1, 20, "", "of each joint's motion",
     "lower: joints move alike; higher: fast, small motions near the arm's resonances"},
    {"speed_share", &Exciting::speed_share, 0.5, 0.01, 1.0, "",
     "share of the joints' velocity limits",
     "lower: viscous friction and inertias are less certain; higher: controllers stop at limits"},
    {"max_speed", &Exciting::max_speed, 1.0, 0.01, 20.0, "rad/s",
     "of joints whose description has no limit",
     "lower: viscous friction is less certain; higher: the arm can't follow"},
    {"max_acceleration", &Exciting::max_acceleration, 4.0, 0.1, 100.0, "rad/s^2", "of all joints",
     "lower: inertias are less certain; higher: torque limits are reached, gears deflect"},
    {"extra_range", &Exciting::extra_range, 0.0, 0.0, 6.3, "rad",
     "beyond the recorded positions, on either side",
     "lower: parameters that the log did not excite stay so; higher: the arm may meet something"},
    {"limit_margin", &Exciting::limit_margin, 0.1, 0.0, 1.0, "rad",
     "distance to the joints' position limits",
     "lower: controllers stop; higher: less of the range is used"},
    {"candidates", &Exciting::candidates, 400, 1, 100000, "", "motions that are compared",
     "lower: a worse motion; higher: more time, about 5 ms each"},
});
static_assert(are_valid_fields(kExcitingFields));

}  // namespace

FrictionTrialOptions::FrictionTrialOptions() { set_defaults(*this, kTrialFields); }
OptionSection section_of(FrictionTrialOptions& options) {
  return make_section("robot_identification.grid", options, kTrialFields);
}

FrictionIntervalOptions::FrictionIntervalOptions() { set_defaults(*this, kIntervalFields); }
OptionSection section_of(FrictionIntervalOptions& options) {
  return make_section("robot_identification.intervals", options, kIntervalFields);
}

PayloadOptions::PayloadOptions() { set_defaults(*this, kPayloadFields); }
OptionSection section_of(PayloadOptions& options) {
  return make_section("robot_identification.payload", options, kPayloadFields);
}

ExcitingMotionOptions::ExcitingMotionOptions() { set_defaults(*this, kExcitingFields); }
OptionSection section_of(ExcitingMotionOptions& options) {
  return make_section("robot_identification.plan", options, kExcitingFields);
}

JointSignalOptions::JointSignalOptions() { set_defaults(*this, kSignalFields); }
OptionSection section_of(JointSignalOptions& options) {
  return make_section("robot_identification.signals", options, kSignalFields);
}

ContactObserverOptions::ContactObserverOptions() { set_defaults(*this, kContactFields); }
OptionSection section_of(ContactObserverOptions& options) {
  return make_section("robot_identification.contact", options, kContactFields);
}

RobotFitOptions::RobotFitOptions() { set_defaults(*this, kFitFields); }
OptionSection section_of(RobotFitOptions& options) {
  return make_section("robot_identification.fit", options, kFitFields);
}

}  // namespace pcavr
