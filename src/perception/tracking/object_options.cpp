// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "pcavr/base/core/options.hpp"
#include "pcavr/perception/tracking/object_tracker.hpp"

namespace pcavr {
namespace {

constexpr auto kRestFields = std::to_array<OptionField<RestOptions>>({
    {"min_count", &RestOptions::min_count, 5, 2, 1000, "",
     "measurements that must agree before an object counts as at rest",
     "lower: slow motion is averaged; higher: poses stay noisy for longer after a push"},
    {"max_averaged", &RestOptions::max_averaged, 60, 2, 10000, "",
     "measurements that are averaged at rest; older ones are forgotten exponentially",
     "lower: noisier poses at rest; higher: slow drift of the camera is averaged"},
    {"translation_floor_std", &RestOptions::translation_floor_std, 5e-5, 1e-6, 0.01, "m",
     "standard deviation of errors that averaging does not reduce (lens, print, pixel grid)",
     "lower: noise counts as motion; higher: small motion is not detected"},
    {"rotation_floor_std", &RestOptions::rotation_floor_std, 2e-4, 1e-6, 0.1, "rad",
     "as translation_floor_std, of the rotation",
     "lower: noise counts as motion; higher: small motion is not detected"},
});
static_assert(are_valid_fields(kRestFields));

using Objects = ObjectTrackerOptions;
constexpr auto kObjectFields = std::to_array<OptionField<Objects>>({
    {"refine_with_depth", &Objects::refine_with_depth, 1, 0, 1, "",
     "fit the CAD surface to the depth, after the tags",
     "false: poses have the tags' errors; true: a wrong CAD model or depth scale shifts them"},
    // A face with a quarter of 1500 rays, each with a standard deviation of 2 mm, is located to 0.1
    // mm: better than the other error sources.
    {"max_samples", &Objects::max_samples, 1500, 100, 100000, "",
     "maximum number of rays cast per body and iteration",
     "lower: noisier poses; higher: slower without a gain, as neighbouring noise is correlated"},
    // 1 to 3 mm remain after factory calibration.
    {"depth_bias", &Objects::depth_bias, 0.001, 0.0, 0.1, "m",
     "standard deviation at 1 m of the depth error common to a body; grows with range squared",
     "lower: a biased sensor biases the pose; higher: depth along the view is almost ignored"},
    // Block matching uses windows of about nine pixels, weighted to the middle.
    {"depth_correlation_length", &Objects::depth_correlation_length, 4.0, 1.0, 50.0, "px",
     "distance within which the depth noise of pixels is correlated",
     "lower: stated pose errors are too small; higher: depth gets too little weight"},
    {"contour_std", &Objects::contour_std, 2.0, 0.1, 20.0, "px",
     "standard deviation of the position of an occluding contour in the depth image",
     "lower: ragged depth edges shift the pose; higher: the pose slides along the only face seen"},
    {"max_tag_residual", &Objects::max_tag_residual, 3.0, 0.5, 50.0, "px",
     "tags with a larger rms reprojection error under the body's pose are outliers",
     "lower: tags in blurred images are lost; higher: misread or misplaced tags shift the pose"},
    // A CAD model of the wrong size fits its visible faces at another pose; the tags detect it.
    {"max_corner_shift", &Objects::max_corner_shift, 5.0, 1.0, 100.0, "corner std",
     "increase of the reprojection error by which depth may move a body off its tags",
     "lower: depth refines fewer poses; higher: a wrong CAD model or depth scale is not noticed"},
    {"capture_range", &Objects::capture_range, 0.02, 0.001, 0.5, "m",
     "bound of the error of the tags' pose or of the predicted motion",
     "lower: fast bodies are lost; higher: other surfaces nearby attract the fit"},
    {"min_inliers", &Objects::min_inliers, 40, 10, 100000, "",
     "rays on the CAD surface that confirm a body",
     "lower: background is taken for a body; higher: small or far bodies are lost"},
    {"min_inlier_ratio_with_tags", &Objects::min_inlier_ratio_with_tags, 0.5, 0.05, 1.0, "",
     "minimum share of a body's depth on its CAD surface where tags are seen",
     "lower: a wrong CAD model is not noticed; higher: depth is unused while a tool occludes"},
    {"min_inlier_ratio_shape_only", &Objects::min_inlier_ratio_shape_only, 0.3, 0.05, 1.0, "",
     "as min_inlier_ratio_with_tags, where no tag is seen",
     "lower: the fit follows a hand or the background; higher: occluded bodies are lost"},
    {"max_behind_ratio", &Objects::max_behind_ratio, 0.2, 0.01, 10.0, "",
     "maximum of the depth behind the CAD surface, over the depth on it",
     "lower: ragged depth edges lose the body; higher: a body that was taken away is still seen"},
    {"max_normalised_rms", &Objects::max_normalised_rms, 1.6, 1.0, 20.0, "",
     "maximum rms distance from the CAD surface in standard deviations of depth",
     "lower: a sensor noisier than its model loses the body; higher: a wrong model passes"},
    // A push on a tabletop: 2 m/s^2 is a body that reaches 0.2 m/s within 0.1 s.
    {"acceleration_std", &Objects::acceleration_std, 2.0, 0.01, 100.0, "m/s^2",
     "standard deviation of the unknown acceleration of a body between frames",
     "lower: pushed bodies are lost; higher: poses without tags drift along unobserved directions"},
    {"angular_acceleration_std", &Objects::angular_acceleration_std, 20.0, 0.1, 1000.0, "rad/s^2",
     "as acceleration_std, of the rotation",
     "lower: turned bodies are lost; higher: poses without tags drift along unobserved directions"},
    {"max_prediction_time", &Objects::max_prediction_time, 0.2, 0.01, 10.0, "s",
     "gap between frames over which a body's velocity is extrapolated",
     "lower: fast bodies are lost at low frame rates; higher: a body that stopped is overshot"},
    {"initial_translation_std", &Objects::initial_translation_std, 0.01, 1e-4, 1.0, "m",
     "standard deviation of an initial pose that is given, not measured",
     "lower: a wrong initial pose is kept; higher: the fit slides along unobserved directions"},
    {"initial_rotation_std", &Objects::initial_rotation_std, 0.05, 1e-3, 3.0, "rad",
     "as initial_translation_std, of the rotation",
     "lower: a wrong initial pose is kept; higher: the fit turns about unobserved axes"},
    // A motion in an unobservable direction would never stop without damping.
    {"velocity_decay", &Objects::velocity_decay, 0.8, 0.0, 1.0, "",
     "factor on the velocity at each frame without tags",
     "lower: moving bodies without tags are lost; higher: they drift in unobserved directions"},
});
static_assert(are_valid_fields(kObjectFields));

}  // namespace

RestOptions::RestOptions() { set_defaults(*this, kRestFields); }

ObjectTrackerOptions::ObjectTrackerOptions() { set_defaults(*this, kObjectFields); }

OptionSection section_of(RestOptions& options) {
  return make_section("tracking.rest", options, kRestFields);
}

OptionSection section_of(ObjectTrackerOptions& options) {
  return make_section("tracking.objects", options, kObjectFields);
}

}  // namespace pcavr
