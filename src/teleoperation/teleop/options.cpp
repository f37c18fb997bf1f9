// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/options.hpp"

#include <array>
#include <optional>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

using Sensors = SensorPriorOptions;
constexpr auto kSensorFields = std::to_array<OptionField<Sensors>>({
    {"tip_noise", &Sensors::tip_noise, 5e-5, 1e-7, 0.1, "m",
     "std of one sample of the tool's position until it is measured",
     "lower: first contacts have wrong speeds; higher: first slides are detected late"},
    {"force_noise", &Sensors::force_noise, 0.1, 1e-6, 1e3, "N",
     "std of one sample of the force until it is measured",
     "lower: noise of the first moments counts as contact; higher: a first light touch is missed"},
    {"force_offset", &Sensors::force_offset, 0.0, -10.0, 10.0, "s",
     "time by which the force's stamps are known to be late, which is subtracted from the start",
     "wrong: force and motion do not belong together until the rest is found from contacts"},
    {"camera_offset", &Sensors::camera_offset, 0.0, -10.0, 10.0, "s",
     "time by which the stamps of tracked poses are known to be late, likewise",
     "wrong: objects that move are displaced until the rest is found from slides"},
});
static_assert(are_valid_fields(kSensorFields));

constexpr auto kTouchFields = std::to_array<OptionField<TouchOptions>>({
    {"touch_clearance", &TouchOptions::touch_clearance, 5e-4, 0.0, 0.1, "m",
     "clearance below which the tip counts as touching",
     "lower: contacts are missed by the tracking's error; higher: two neighbouring objects count "
     "as touched together"},
    {"free_clearance", &TouchOptions::free_clearance, 0.002, 0.0, 0.1, "m",
     "clearance of every object above which the force is the sensor's bias",
     "lower: a contact force becomes bias; higher: in clutter the bias is never updated"},
    {"bias_time", &TouchOptions::bias_time, 0.25, 0.02, 600.0, "s",
     "time constant of the force sensor's bias",
     "lower: noise of the sensor enters the bias; higher: a drifting sensor keeps its drift"},
    {"contact_stds", &TouchOptions::contact_stds, 5.0, 1.0, 100.0, "stds",
     "smoothed force over its std at which a contact begins",
     "lower: noise counts as contact; higher: contacts are detected late"},
    {"force_drift", &TouchOptions::force_drift, 0.3, 0.0, 100.0, "N",
     "minimum force at which a contact begins: drift of the bias that is not detected",
     "lower: drift counts as contact; higher: light touches are missed"},
});
static_assert(are_valid_fields(kTouchFields));

using Phases = PhaseMonitorOptions;
constexpr auto kPhaseFields = std::to_array<OptionField<Phases>>({
    {"slide_speed", &Phases::slide_speed, 0.0025, 1e-5, 1.0, "m/s",
     "minimum speed of an object that is distinguished from rest",
     "lower: errors of the contact line count as sliding; higher: slow slides are missed"},
    {"min_displacement", &Phases::min_displacement, 1e-4, 1e-7, 0.1, "m",
     "minimum displacement of an object that slides; at least two stds of its noise are used",
     "lower: a badly fitted contact line counts as sliding; higher: slides are detected late"},
    {"debounce_samples", &Phases::debounce_samples, 3, 1, 1000, "samples",
     "consecutive samples of the force that must agree on a phase",
     "lower: single outliers change the phase; higher: late detection with a slow sensor"},
    {"critical_share", &Phases::critical_share, 0.1, 0.0, 1.0, "",
     "share of the limiting friction below it from which an object at rest is critical, at least",
     "lower: near 0, paper C's band: it slides before it is seen critical; higher: early warnings"},
    {"leave_ratio", &Phases::leave_ratio, 0.5, 0.0, 1.0, "",
     "share of the force that begins a contact, below which it ends",
     "lower: a drifting sensor keeps the contact; higher: noise ends and begins contacts"},
    {"leave_time", &Phases::leave_time, 0.008, 0.0, 10.0, "s",
     "time below that force after which a contact ends",
     "lower: noise ends contacts; higher: separation is detected late"},
    // A loss is noticed within 50 ms, with the latencies of smoothing and spike filter.
    {"unloaded_time", &Phases::unloaded_time, 0.025, 0.0, 10.0, "s",
     "time below that force after which a contact ends although the tip stays where it pressed",
     "lower: noise ends light contacts; higher: an object that is taken away is missed late"},
    {"retraction", &Phases::retraction, 1e-4, 0.0, 0.1, "m",
     "distance of the tip from where it last pressed, from which on the shorter time counts",
     "lower: noise of the tip's pose ends light contacts; higher: separation is detected late"},
    {"line_guard", &Phases::line_guard, 0.080, 0.005, 10.0, "s",
     "newest samples of a push, in which the object may already move and which the contact line "
     "does not use",
     "lower: slow onsets bend the line; higher: fast pushes have no line before they slide"},
    {"rate_window", &Phases::rate_window, 0.012, 0.001, 1.0, "s",
     "window of the tip's speed, which removes damping from the force",
     "lower: noise of the tip; higher: the first milliseconds of a contact look too stiff"},
    {"min_speed_window", &Phases::min_speed_window, 0.060, 0.005, 10.0, "s",
     "shortest window of the object's speed",
     "lower: noise of the speed; higher: phase changes are detected late"},
    {"max_speed_window", &Phases::max_speed_window, 0.120, 0.005, 10.0, "s",
     "longest window of the object's speed, used as the sensors' noise requires",
     "lower: slow slides are lost in noise; higher: phase changes are detected late"},
    // Its quarters are four stds apart at 2.5 mm/s, 30 frames a second and 0.1 mm of noise.
    {"slow_slide_window", &Phases::slow_slide_window, 0.5, 0.01, 10.0, "s",
     "shortest time in which tracked poses show a slide that force and motion do not; up to three "
     "times as "
     "long is tried",
     "lower: only low noise or faster slides are seen; higher: they are seen late"},
    {"slow_slide_displacement", &Phases::slow_slide_displacement, 3e-4, 1e-6, 0.1, "m",
     "minimum displacement of an object in that time",
     "lower: an object that yields under its load slides; higher: slow slides are missed"},
});
static_assert(are_valid_fields(kPhaseFields));

using Fusion = PoseFusionOptions;
constexpr auto kFusionFields = std::to_array<OptionField<Fusion>>({
    {"tracking_latency", &Fusion::tracking_latency, 0.030, 0.0, 10.0, "s",
     "delay from a frame's stamp until its tracked poses are available",
     "lower: a replay uses poses that a live site does not have yet; higher: old poses are used"},
    {"initial_std", &Fusion::initial_std, 0.005, 1e-5, 1.0, "m",
     "std, along an axis, of the position of an object that was not tracked yet",
     "lower: a wrong initial pose is kept; higher: contact moves a right one"},
    {"moved_stds", &Fusion::moved_stds, 4.0, 0.0, 100.0, "stds",
     "displacement between two frames over its std, from which on an object moves",
     "lower: noise counts as motion; higher: slow motion is not seen"},
    {"min_displacement", &Fusion::min_displacement, 5e-4, 0.0, 0.1, "m",
     "minimum displacement between two frames of an object that moves",
     "lower: noise beyond the stated std counts as motion; higher: slow motion is not seen"},
    {"min_speed", &Fusion::min_speed, 0.005, 0.0, 1.0, "m/s",
     "minimum speed between two frames of an object that moves",
     "lower: drift of the tracking counts as motion; higher: slow motion is not seen"},
    {"untracked_drift", &Fusion::untracked_drift, 0.05, 0.0, 10.0, "m/m",
     "growth of the position's std of an object that moves untracked, per displacement",
     "lower: contact overrules tracking after a gap; higher: tracking's noise returns too early"},
    // Calibration of the tip, its smoothing and the face's curvature: the offset of a surface. They
    // are no error of where the tip meets an object: at both sites it does so where it is measured.
    {"contact_std", &Fusion::contact_std, 1e-4, 1e-6, 0.1, "m",
     "std of a touched surface's distance from the tip: calibration of tip and tracking",
     "lower: noise counts as an offset of the surface; higher: a badly calibrated tip is noticed "
     "late"},
    {"default_penetration_std", &Fusion::default_penetration_std, 0.1, 1e-3, 10.0, "",
     "relative std of the penetration by a contact law that states none",
     "lower: a wrong law shifts the objects; higher: contact improves nothing"},
    {"min_force", &Fusion::min_force, 1.0, 0.0, 1e4, "N",
     "force below which contact gives no position",
     "lower: bias and noise of the force shift the objects; higher: soft contacts are not used"},
    {"offset_gain", &Fusion::offset_gain, 0.05, 1e-4, 1.0, "",
     "gain, per force sample, of the low-pass filter of the offset from camera to contact",
     "lower: follows a turning object slowly; higher: noise of the contact enters the pose"},
    {"clock_std", &Fusion::clock_std, 0.005, 0.0, 1.0, "s",
     "std of the frames' stamps on the tool's clock",
     "lower: a late camera displaces the surfaces of fast objects; higher: fast pushes show none"},
    {"max_surface_offset", &Fusion::max_surface_offset, 0.003, 0.0, 0.1, "m",
     "maximum distance from the CAD body's surface to where the tip meets it",
     "lower: bodies lag behind the tip by their mesh's error; higher: a wrong pose counts as one"},
});
static_assert(are_valid_fields(kFusionFields));

using Learning = LearningOptions;
constexpr auto kLearningFields = std::to_array<OptionField<Learning>>({
    {"default_relative_std", &Learning::default_relative_std, 0.05, 1e-4, 10.0, "",
     "relative std of a given parameter that states none",
     "lower: data contradict sound parameters; higher: wrong ones are kept"},
    {"contradiction_stds", &Learning::contradiction_stds, 4.0, 0.0, 100.0, "stds",
     "difference over its std from which on data contradict a parameter",
     "lower: noise replaces given parameters; higher: wrong ones are kept"},
    {"model_error", &Learning::model_error, 0.05, 0.0, 1.0, "",
     "relative difference up to which data never contradict a parameter",
     "lower: the model's own errors replace given parameters; higher: wrong ones are kept"},
    {"max_fit_error", &Learning::max_fit_error, 0.1, 0.0, 10.0, "",
     "relative force residual above which a contact law is rejected",
     "lower: layered materials have no law; higher: fits of disturbed contacts are used"},
    {"max_penetration_std", &Learning::max_penetration_std, 0.25, 0.0, 10.0, "",
     "relative std of the penetration above which a contact law is rejected",
     "lower: noisy sensors have no law; higher: young contacts give wrong laws"},
    // Uniform pressure on the support, which it replaces, is as wrong on ordinary objects.
    {"max_radius_std", &Learning::max_radius_std, 0.1, 0.0, 10.0, "",
     "relative std of the friction radius above which it is not used",
     "lower: objects on feet turn as on their whole face; higher: few pushes give wrong radii"},
    {"min_peak_force", &Learning::min_peak_force, 1.0, 0.0, 1e4, "N",
     "peak force of a contact that is used for the contact law",
     "lower: noise dominates light touches; higher: light objects have no law"},
    {"static_limit_ratio", &Learning::static_limit_ratio, 1.05, 1.0, 10.0, "",
     "friction of a static object over its limiting friction that contradicts the limit",
     "lower: noise contradicts a right limit; higher: a wrong one is kept until breakaway"},
    {"static_limit_time", &Learning::static_limit_time, 0.05, 0.0, 10.0, "s",
     "time beyond that ratio after which the limit is contradicted",
     "lower: a spike contradicts it; higher: the operator sees the object slide for longer"},
    {"static_limit_factor", &Learning::static_limit_factor, 1.5, 1.0, 100.0, "",
     "limiting friction until breakaway, over the largest static friction",
     "lower: the limit is raised several times in a push; higher: the prediction breaks away late"},
    {"max_fitted_contacts", &Learning::max_fitted_contacts, 6, 1, 20, "contacts",
     "newest contacts that are fitted together",
     "lower: noise of a single contact; higher: computing time, and changes are followed slowly"},
    {"max_contact_time", &Learning::max_contact_time, 60.0, 1.0, 3600.0, "s",
     "beginning of a contact that is used to identify",
     "lower: long contacts lose their slides; higher: memory and computing time"},
    {"delay_after_touch", &Learning::delay_after_touch, 0.1, 0.0, 10.0, "s",
     "time from the touch of an object without a contact law to its first identification",
     "lower: computing time for laws that are rejected; higher: the assumed law is felt for "
     "longer"},
    {"delay_after_onset", &Learning::delay_after_onset, 0.12, 0.0, 10.0, "s",
     "time from the onset of a slide to its identification",
     "lower: the breakaway is not complete yet; higher: corrections are late"},
    {"sliding_interval", &Learning::sliding_interval, 0.3, 0.01, 60.0, "s",
     "time between identifications during a slide",
     "lower: computing time; higher: corrections are late"},
    {"delay_after_stop", &Learning::delay_after_stop, 0.08, 0.0, 10.0, "s",
     "time from the end of a slide or contact to its identification",
     "lower: the end is not complete yet; higher: the next push has old parameters"},
});
static_assert(are_valid_fields(kLearningFields));

using Switch = CorrectionSwitchOptions;
constexpr auto kSwitchFields = std::to_array<OptionField<Switch>>({
    // Just noticeable difference [paper C].
    {"force_tolerance", &Switch::force_tolerance, 0.10, 0.001, 10.0, "",
     "error of the predicted force without a correction, relative to the real force",
     "lower: traffic for errors that an operator does not feel; higher: wrong forces are felt"},
    {"position_tolerance", &Switch::position_tolerance, 0.003, 1e-5, 1.0, "m",
     "maximum position error without a correction [paper C]",
     "lower: traffic for noise of the tracking; higher: the operator pushes beside the object"},
    {"position_stds", &Switch::position_stds, 3.0, 0.0, 100.0, "stds",
     "position error over the std of the pose estimate, from which on it is corrected",
     "lower: traffic for noise of the tracking; higher: errors up to the tolerance remain"},
    {"min_position_error", &Switch::min_position_error, 5e-4, 0.0, 1.0, "m",
     "minimum of that error, whatever the std",
     "lower: traffic for errors beyond the stated std; higher: small errors remain"},
    // Both sites detect a phase change some 25 ms apart at best.
    {"phase_persistence", &Switch::phase_persistence, 0.060, 0.0, 10.0, "s",
     "time for which the phases must differ",
     "lower: every phase change is corrected; higher: corrections are late"},
    {"force_persistence", &Switch::force_persistence, 0.040, 0.0, 10.0, "s",
     "time for which the forces must differ",
     "lower: traffic for noise; higher: corrections are late"},
    // Two frames of an ordinary camera.
    {"position_persistence", &Switch::position_persistence, 0.030, 0.0, 10.0, "s",
     "time for which the positions of sliding objects must differ",
     "lower: a single wrong frame is corrected; higher: corrections are late"},
    {"max_lapse", &Switch::max_lapse, 0.020, 0.0, 10.0, "s",
     "time for which a difference may vanish without being reset",
     "lower: a flickering predicted phase is never corrected; higher: separate events are joined"},
    {"round_trip_margin", &Switch::round_trip_margin, 0.060, 0.0, 10.0, "s",
     "time after a round trip until the same case is sent again",
     "lower: sent twice with jitter; higher: a lost correction is repeated late"},
    {"growth_factor", &Switch::growth_factor, 2.0, 1.0, 100.0, "",
     "growth of an error in flight at which it is sent again at once",
     "lower: traffic during fast motion; higher: growing errors wait for a round trip"},
    {"max_threshold_factor", &Switch::max_threshold_factor, 3.0, 1.0, 100.0, "",
     "maximum factor of the thresholds while the byte budget is exceeded",
     "lower: the budget is exceeded further; higher: large errors remain on a busy link"},
    {"byte_budget", &Switch::byte_budget, 0.01, 0.0, 1.0, "",
     "bytes of corrections over those of streaming, from which on the thresholds rise",
     "lower: fewer corrections; higher: traffic"},
    {"burst_bytes", &Switch::burst_bytes, 400.0, 1.0, 1e9, "bytes",
     "bytes that may be sent beyond the budget: a few corrections at the start",
     "lower: the first corrections are held back; higher: traffic of short sessions"},
    {"keeps_off", &Switch::keeps_off, 0, 0, 1, "",
     "where the phases differ and the parameters are wrong, a tool that follows commands is moved "
     "off the object until its contact is identified [paper C]",
     "0: the push goes on while it is corrected; 1: it ends, and the operator begins anew"},
});
static_assert(are_valid_fields(kSwitchFields));

constexpr auto kMessageFields = std::to_array<OptionField<MessageOptions>>({
    {"min_pose_error", &MessageOptions::min_pose_error, 1e-4, 0.0, 1.0, "m",
     "error from which on a correction contains the pose",
     "lower: bytes for nothing; higher: small errors remain after each correction"},
    // Half the edge of the objects of paper C.
    {"rotation_radius", &MessageOptions::rotation_radius, 0.07, 0.0, 10.0, "m",
     "radius at which an error of the rotation counts as a displacement",
     "lower: large objects stay rotated; higher: noise of small objects' rotation is corrected"},
    {"min_parameter_change", &MessageOptions::min_parameter_change, 0.03, 0.0, 10.0, "",
     "relative effect of changed parameters from which on they are sent",
     "lower: bytes for changes that an operator does not feel; higher: old parameters remain"},
    {"min_compared_force", &MessageOptions::min_compared_force, 1.0, 0.0, 1e4, "N",
     "smallest force at which contact laws are compared",
     "lower: compared where nothing is felt; higher: light objects keep old laws"},
    {"compared_rate", &MessageOptions::compared_rate, 0.02, 0.0, 10.0, "m/s",
     "rate of penetration at which contact laws are compared: that of the operator's pushes",
     "lower: a changed damping is not sent; higher: damping dominates slow pushes"},
    // The choice by force has 1.3 times the position error, 1.4 times the force error and 12 % more
    // bytes over six simulated pushes without parameters: docs/papers.md.
    {"parameters_by_force", &MessageOptions::parameters_by_force, 0, 0, 1, "",
     "while both slide, only friction parameters where the forces agree, else only those of the "
     "contact [paper C]",
     "true: what has changed in the other group arrives a round trip later, or never"},
});
static_assert(are_valid_fields(kMessageFields));

constexpr auto kTeleopFields = std::to_array<OptionField<TeleopOptions>>({
    {"forward_delay", &TeleopOptions::forward_delay, 0.2, ranges::kDelay.min, ranges::kDelay.max,
     "s", "delay from operator to robot",
     "lower than the link's: predicts too short; higher: predicts further than necessary"},
    {"backward_delay", &TeleopOptions::backward_delay, 0.2, ranges::kDelay.min, ranges::kDelay.max,
     "s", "delay from robot to operator",
     "lower than the link's: sends again too early; higher: repeats lost corrections late"},
    {"jitter", &TeleopOptions::jitter, 0.0, ranges::kJitter.min, ranges::kJitter.max, "s",
     "standard deviation of either delay", "higher: corrections come too late for the history"},
    {"loss", &TeleopOptions::loss, 0.0, ranges::kShare.min, ranges::kShare.max, "",
     "share of the corrections that the network drops", "higher: errors remain for longer"},
    {"burst", &TeleopOptions::burst, 0.0, 0.0, 1e4, "",
     "mean number of corrections that are lost in a row; below 1 losses are independent",
     "higher: the same loss in longer gaps"},
    {"reorder", &TeleopOptions::reorder, 0.0, ranges::kShare.min, ranges::kShare.max, "",
     "share of the corrections that are overtaken by 20 ms",
     "higher: more corrections are superseded before they arrive"},
    {"duplicate", &TeleopOptions::duplicate, 0.0, ranges::kShare.min, ranges::kShare.max, "",
     "share of the corrections that arrive twice", "higher: more messages to ignore"},
    {"rate_limit", &TeleopOptions::rate_limit, 0.0, 0.0, 1e10, "B/s",
     "rate of the bottleneck from robot to operator; 0: no limit",
     "lower: corrections wait for each other; higher: no effect"},
    {"retraction_speed", &TeleopOptions::retraction_speed, 0.05, 0.0, 10.0, "m/s",
     "speed of the tool out of what the robot has touched before the operator: 1 mm in 20 ms; only "
     "for a robot that follows commands; 0: it stays",
     "lower: the robot presses for longer on what the operator does not see it touch; higher: the "
     "tool is moved with a jerk"},
    {"with_corrections", &TeleopOptions::with_corrections, 1, 0, 1, "",
     "the robot's site sends corrections", "false: errors of the prediction remain"},
    {"identifies", &TeleopOptions::identifies, 1, 0, 1, "",
     "the robot's site identifies parameters online", "false: wrong parameters remain"},
});
static_assert(are_valid_fields(kTeleopFields));

std::optional<Error> check_windows(const PhaseMonitorOptions& options) {
  if (options.min_speed_window <= options.max_speed_window) return std::nullopt;
  return Error{.message = "min_speed_window exceeds max_speed_window",
               .place = "teleop.phases",
               .hint = "raise max_speed_window"};
}

}  // namespace

SensorPriorOptions::SensorPriorOptions() { set_defaults(*this, kSensorFields); }
OptionSection section_of(SensorPriorOptions& options) {
  return make_section("teleop.sensors", options, kSensorFields);
}

TouchOptions::TouchOptions() { set_defaults(*this, kTouchFields); }
OptionSection section_of(TouchOptions& options) {
  return make_section("teleop.touch", options, kTouchFields);
}

PhaseMonitorOptions::PhaseMonitorOptions() { set_defaults(*this, kPhaseFields); }
OptionSection section_of(PhaseMonitorOptions& options) {
  OptionSection section = make_section("teleop.phases", options, kPhaseFields);
  section.check = [&options] { return check_windows(options); };
  return section;
}

PoseFusionOptions::PoseFusionOptions() { set_defaults(*this, kFusionFields); }
OptionSection section_of(PoseFusionOptions& options) {
  return make_section("teleop.pose", options, kFusionFields);
}

LearningOptions::LearningOptions() { set_defaults(*this, kLearningFields); }
OptionSection section_of(LearningOptions& options) {
  return make_section("teleop.learning", options, kLearningFields);
}

CorrectionSwitchOptions::CorrectionSwitchOptions() { set_defaults(*this, kSwitchFields); }
OptionSection section_of(CorrectionSwitchOptions& options) {
  return make_section("teleop.switch", options, kSwitchFields);
}

MessageOptions::MessageOptions() { set_defaults(*this, kMessageFields); }
OptionSection section_of(MessageOptions& options) {
  return make_section("teleop.messages", options, kMessageFields);
}

TeleopOptions::TeleopOptions() : seed(1) { set_defaults(*this, kTeleopFields); }
OptionSection section_of(TeleopOptions& options) {
  return make_section("teleop", options, kTeleopFields);
}

std::vector<OptionSection> sections_of(TeleopOptions& options) {
  LearningOptions& learning = options.learning;
  return {section_of(options),
          section_of(options.inputs),
          section_of(options.sensors),
          section_of(options.touch),
          section_of(options.phases),
          section_of(options.pose),
          section_of(learning),
          section_of(options.correction_switch),
          section_of(options.messages),
          section_of(options.predictor),
          section_of(options.world),
          section_of(options.unknown_objects),
          section_of(learning.segmentation),
          section_of(learning.segmentation.spikes),
          section_of(learning.segmentation.breakaway),
          section_of(learning.contact_fit),
          section_of(learning.onset),
          section_of(learning.limiting_friction),
          section_of(learning.sliding),
          section_of(learning.friction_priors),
          section_of(learning.breakaway_priors),
          section_of(learning.limit_surface)};
}

}  // namespace pcavr
