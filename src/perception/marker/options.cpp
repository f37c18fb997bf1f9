// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/base/core/options.hpp"

#include <array>

#include "pcavr/perception/marker/body_pose.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {
namespace {

using Detector = TagDetectorOptions;
constexpr auto kDetectorFields = std::to_array<OptionField<Detector>>({
    {"decimation", &Detector::decimation, 2, 1, 8, "",
     "factor by which the image is downscaled for the search of AprilTags",
     "lower: slower; higher: small or far tags are not found"},
    {"max_hamming", &Detector::max_hamming, 1, 0, 3, "",
     "maximum number of bits of a tag that are corrected",
     "lower: dirty or partly lit tags are not found; higher: patterns in the scene count as tags"},
    // Printed tags in ordinary light reach 40 to 120.
    {"min_margin", &Detector::min_margin, 20.0, 0.0, 255.0, "grey levels",
     "minimum contrast between a tag's bits and the threshold",
     "lower: patterns in the scene count as tags; higher: tags in weak light are not found"},
    {"full_search_interval", &Detector::full_search_interval, 5, 1, 1000, "frames",
     "interval of searches of the whole image; in between only around the last detections",
     "lower: slower; higher: tags that come into view are found late"},
    // A camera that rotates by 30 degrees a second moves the image by 2 % of a field of view of
    // 50 degrees from frame to frame at 30 Hz; twice that.
    {"motion_share", &Detector::motion_share, 0.04, 0.005, 1.0, "",
     "motion of a tag from frame to frame, as a share of the image's width",
     "lower: every fast motion costs a full search; higher: slower"},
    // Covers a blur of 0.5 to 1 px.
    {"edge_reach", &Detector::edge_reach, 3.0, 1.5, 20.0, "px",
     "distance from a tag's edge within which pixels are used to refine it",
     "lower: corners in blurred images are biased; higher: things next to the tag shift its edges"},
    // Measured on rendered tags.
    {"edge_model_std", &Detector::edge_model_std, 0.01, 0.0, 1.0, "px",
     "standard deviation of refined corners that image noise does not explain (JPEG, uneven light)",
     "lower: stated pose errors are too small; higher: large sharp tags get too little weight"},
    {"unrefined_std", &Detector::unrefined_std, 0.3, 0.01, 5.0, "px",
     "standard deviation of corners whose edges could not be refined",
     "lower: partly covered tags shift poses; higher: they get almost no weight"},
});
static_assert(are_valid_fields(kDetectorFields));

using Solver = BodyPoseOptions;
constexpr auto kBodyPoseFields = std::to_array<OptionField<Solver>>({
    {"corner_std", &Solver::corner_std, 0.15, 1e-4, 10.0, "px",
     "standard deviation of a tag corner's coordinate",
     "lower: tags outweigh depth, poses, and shape; higher: they get too little weight"},
    {"model_std", &Solver::model_std, 0.03, 0.0, 5.0, "px",
     "standard deviation of corners by the lens model and by paper that is not flat",
     "lower: stated pose errors are too small; higher: sharp tags get too little weight"},
    {"max_tag_residual", &Solver::max_tag_residual, 3.0, 0.5, 50.0, "px",
     "tags with a larger rms reprojection error under the body's pose are outliers",
     "lower: tags in blurred images are lost; higher: misread or misplaced tags shift the pose"},
    // A likelihood ratio of exp(14 / 2), 1000 to 1.
    {"min_cost_gap", &Solver::min_cost_gap, 14.0, 1.0, 1000.0, "",
     "difference of -2 log likelihood that resolves the two poses of a flat tag",
     "lower: poses flip; higher: poses of small or frontal tags are not used"},
    {"rotation_std", &Solver::rotation_std, 0.15, 0.001, 3.0, "rad",
     "standard deviation of a body's rotation from frame to frame, relative to the camera",
     "lower: fast turns are taken for the tag's other pose; higher: poses flip"},
    // Depth sensors match windows of pixels.
    {"depth_correlation_area", &Solver::depth_correlation_area, 30.0, 1.0, 1000.0, "px^2",
     "area in which the depth noise of pixels is correlated",
     "lower: noisy depth tilts tags; higher: depth does not resolve a tag's two poses"},
    {"distortion_length", &Solver::distortion_length, 0.3, 0.01, 10.0, "",
     "length over which the depth sensor's systematic error varies, as a share of the distance",
     "lower: depth does not resolve a tag's two poses; higher: distorted depth tilts tags"},
});
static_assert(are_valid_fields(kBodyPoseFields));

}  // namespace

TagDetectorOptions::TagDetectorOptions() { set_defaults(*this, kDetectorFields); }

BodyPoseOptions::BodyPoseOptions() { set_defaults(*this, kBodyPoseFields); }

OptionSection section_of(TagDetectorOptions& options) {
  return make_section("marker.detector", options, kDetectorFields);
}

OptionSection section_of(BodyPoseOptions& options) {
  return make_section("marker.body_pose", options, kBodyPoseFields);
}

}  // namespace pcavr
