// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/results/evaluation/options.hpp"

#include <array>
#include <optional>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr auto kTrajectoryFields = std::to_array<OptionField<TrajectoryErrorOptions>>({
    {"max_gap", &TrajectoryErrorOptions::max_gap, 0.1, 0.0, 60.0, "s",
     "gap of the reference up to which it is interpolated",
     "lower: fewer estimates are matched; higher: with less accurate reference poses"},
    {"relative_step", &TrajectoryErrorOptions::relative_step, 1.0, 0.001, 600.0, "s",
     "time between the two poses of a relative error, +-10 %",
     "lower: noise of single poses; higher: drift, and short recordings have no pairs"},
});
static_assert(are_valid_fields(kTrajectoryFields));

constexpr auto kMotionFields = std::to_array<OptionField<MotionOptions>>({
    {"speed_to_start", &MotionOptions::speed_to_start, 0.001, 1e-6, 10.0, "m/s",
     "speed of the fastest vertex from which on an object moves",
     "lower: noise of a measured reference counts as motion; higher: slow motion counts as rest"},
    {"speed_to_stop", &MotionOptions::speed_to_stop, 0.0003, 1e-6, 10.0, "m/s",
     "speed below which a moving object is at rest",
     "lower: noise prolongs motions; higher: one motion counts as several"},
    {"span", &MotionOptions::span, 0.1, 0.001, 10.0, "s", "span of the mean speed, centred",
     "lower: noise of a measured reference counts as motion; higher: rest just before or after a "
     "motion does"},
});
static_assert(are_valid_fields(kMotionFields));

constexpr auto kViewFields = std::to_array<OptionField<ViewOptions>>({
    // The working range of structured-light and time-of-flight depth cameras.
    {"min_depth", &ViewOptions::min_depth, 0.4, 0.0, 100.0, "m",
     "smallest depth that the camera measures",
     "lower: surfaces that it can't measure count as missing; higher: missing ones do not count"},
    {"max_depth", &ViewOptions::max_depth, 4.0, 0.01, 1000.0, "m",
     "largest depth that the camera measures",
     "lower: missing surfaces do not count; higher: surfaces that it can't measure do"},
    {"max_incidence", &ViewOptions::max_incidence, 1.30900, 0.01, 1.5707, "rad",
     "angle between ray and surface normal up to which the camera measures a surface",
     "lower: missing surfaces do not count; higher: grazing ones do"},
    // More find little else, and each costs a ray for every sample that is still occluded.
    {"max_views", &ViewOptions::max_views, 60, 1, 100000, "",
     "poses of the camera for which the visibility is tested",
     "lower: briefly seen surfaces count as not seen; higher: computing time"},
});
static_assert(are_valid_fields(kViewFields));

constexpr auto kSurfaceFields = std::to_array<OptionField<SurfaceErrorOptions>>({
    // A share is exact to about one sample of area / spacing^2.
    {"sample_spacing", &SurfaceErrorOptions::sample_spacing, 0.005, 1e-4, 1.0, "m",
     "distance between samples on either surface",
     "lower: half of it takes four times as long; higher: shares of small surfaces are inexact"},
});
static_assert(are_valid_fields(kSurfaceFields));

constexpr auto kForceFields = std::to_array<OptionField<ForceErrorOptions>>({
    // A force sensor's noise of 0.2 N is a tenth of it, and a tenth is the just noticeable
    // difference [paper C].
    {"min_relative_force", &ForceErrorOptions::min_relative_force, 2.0, 1e-3, 1e4, "N",
     "measured force from which on relative errors are computed, and contacts have a peak",
     "lower: relative errors depend on the sensor's noise; higher: light contacts are left out"},
    // Rows are at the wrench's rate, and the slowest force sensors in use have 100 Hz.
    {"contact_gap", &ForceErrorOptions::contact_gap, 0.05, 0.001, 10.0, "s",
     "time without samples between two contacts",
     "lower: missing samples split contacts; higher: repeated taps count as one contact"},
    {"approach_time", &ForceErrorOptions::approach_time, 0.05, 0.001, 10.0, "s",
     "time before a contact over which the tip's speed is averaged",
     "lower: noise of the tool's pose counts as speed; higher: changes of the speed are averaged"},
    // The maximum of 100 samples is 2.5 stds of the noise too high: 0.5 N of 0.2 N, 2 % of a press
    // of 25 N. At 500 Hz nine samples leave a third of that.
    {"peak_half_width", &ForceErrorOptions::peak_half_width, 0.008, 0.0, 1.0, "s",
     "half width of the moving mean of both forces, measured and rendered, of which peaks are the "
     "maxima",
     "lower: the sensor's noise raises the measured peak; higher: short peaks are flattened"},
});
static_assert(are_valid_fields(kForceFields));

std::optional<Error> check_speeds(const MotionOptions& options) {
  if (options.speed_to_stop <= options.speed_to_start) return std::nullopt;
  return Error{.message = "speed_to_stop exceeds speed_to_start",
               .place = "evaluation.motion",
               .hint = "raise speed_to_start"};
}

std::optional<Error> check_depths(const ViewOptions& options) {
  if (options.min_depth < options.max_depth) return std::nullopt;
  return Error{.message = "min_depth is not below max_depth",
               .place = "evaluation.views",
               .hint = "raise max_depth"};
}

}  // namespace

TrajectoryErrorOptions::TrajectoryErrorOptions() { set_defaults(*this, kTrajectoryFields); }
OptionSection section_of(TrajectoryErrorOptions& options) {
  return make_section("evaluation.trajectories", options, kTrajectoryFields);
}

MotionOptions::MotionOptions() { set_defaults(*this, kMotionFields); }
OptionSection section_of(MotionOptions& options) {
  OptionSection section = make_section("evaluation.motion", options, kMotionFields);
  section.check = [&options] { return check_speeds(options); };
  return section;
}

ViewOptions::ViewOptions() { set_defaults(*this, kViewFields); }
OptionSection section_of(ViewOptions& options) {
  OptionSection section = make_section("evaluation.views", options, kViewFields);
  section.check = [&options] { return check_depths(options); };
  return section;
}

SurfaceErrorOptions::SurfaceErrorOptions() : seed(1) { set_defaults(*this, kSurfaceFields); }
OptionSection section_of(SurfaceErrorOptions& options) {
  return make_section("evaluation.surfaces", options, kSurfaceFields);
}

ForceErrorOptions::ForceErrorOptions() { set_defaults(*this, kForceFields); }
OptionSection section_of(ForceErrorOptions& options) {
  return make_section("evaluation.forces", options, kForceFields);
}

std::vector<OptionSection> sections_of(EvaluationOptions& options) {
  return {section_of(options.trajectories), section_of(options.motion), section_of(options.views),
          section_of(options.surfaces), section_of(options.forces)};
}

}  // namespace pcavr
