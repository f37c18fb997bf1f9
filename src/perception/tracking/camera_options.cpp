// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <numbers>

#include "pcavr/base/core/options.hpp"
#include "pcavr/perception/tracking/camera_tracker.hpp"

namespace pcavr {
namespace {

using Camera = CameraTrackerOptions;
constexpr auto kCameraFields = std::to_array<OptionField<Camera>>({
    {"groundtruth_position_std", &Camera::groundtruth_position_std, 0.005, 1e-6, 1.0, "m",
     "standard deviation of the positions in groundtruth.txt",
     "lower: their errors bend the track; higher: tags and tracking outweigh them"},
    {"groundtruth_rotation_std", &Camera::groundtruth_rotation_std, 0.005, 1e-6, 1.0, "rad",
     "standard deviation of the rotations in groundtruth.txt",
     "lower: their errors bend the track; higher: tags and tracking outweigh them"},
    {"max_fixed_camera_motion", &Camera::max_fixed_camera_motion, 0.003, 0.0, 0.1, "m",
     "a camera by which points 1 m away move less over a whole recording is fixed",
     "lower: noise moves a fixed camera; higher: a slowly moving camera gets one pose"},
    {"keyframe_baseline", &Camera::keyframe_baseline, 0.15, 0.01, 1.0, "",
     "translation after which a new keyframe begins, as a share of the mean depth",
     "lower: more keyframes, more drift and memory; higher: tracking is lost between them"},
    {"keyframe_angle", &Camera::keyframe_angle, 12.0 * std::numbers::pi / 180.0, 0.01, 1.5, "rad",
     "rotation after which a new keyframe begins",
     "lower: more keyframes, more drift and memory; higher: tracking is lost between them"},
    {"keyframe_overlap", &Camera::keyframe_overlap, 0.65, 0.1, 0.99, "",
     "minimum share of a frame's surface that its keyframe shows",
     "lower: tracking is lost at the image's border; higher: more keyframes, more drift"},
    {"keyframe_landmark_ratio", &Camera::keyframe_landmark_ratio, 0.35, 0.01, 0.99, "",
     "minimum share of a keyframe's landmarks that a frame shows",
     "lower: tracking is lost under occlusion; higher: more keyframes, more drift"},
    // A hand-held camera accelerates.
    {"max_prediction_time", &Camera::max_prediction_time, 0.2, 0.0, 10.0, "s",
     "gap between frames over which the camera's velocity is extrapolated",
     "lower: fast cameras are lost at low frame rates; higher: a camera that stopped is overshot"},
    {"min_inlier_ratio", &Camera::min_inlier_ratio, 0.6, 0.1, 1.0, "",
     "minimum share of the surface in view on which a frame agrees with its keyframe",
     "lower: wrong alignments are accepted; higher: moving things in view lose the camera"},
    // Views of one place had 0.27 or more (badly registered colour, views 1.3 s apart; in others
    // above 0.6), alignments that had slid along a plane 0.14 at most.
    {"min_correlation", &Camera::min_correlation, 0.2, -1.0, 1.0, "",
     "minimum correlation of a frame's texture with that of its keyframe, less the share of the "
     "surface that one of them looked through",
     "lower: wrong alignments are accepted; higher: frames in changing light are lost"},
    {"max_contradicted", &Camera::max_contradicted, 0.05, 0.0, 1.0, "",
     "maximum share of the surface that one of two views without texture looked through",
     "lower: moving things in view lose the camera; higher: wrong alignments are accepted"},
    {"min_features", &Camera::min_features, 12, 4, 1000, "",
     "minimum number of features that place a frame without enough depth",
     "lower: wrong alignments are accepted; higher: frames of bare walls are lost"},
    {"max_position_std", &Camera::max_position_std, 0.01, 1e-4, 1.0, "m",
     "frames whose alignment is less certain are lost",
     "lower: frames of flat scenes are lost; higher: poses slide along planes"},
    {"max_rotation_std", &Camera::max_rotation_std, 0.01, 1e-4, 1.0, "rad",
     "frames whose alignment is less certain are lost",
     "lower: frames of flat scenes are lost; higher: poses turn about unobserved axes"},
    {"corner_rejection_threshold", &Camera::corner_rejection_threshold, 6.0, 2.0, 100.0,
     "corner std", "base tag corners with a larger error are reported as rejected",
     "lower: good corners are reported; higher: misplaced tags are not reported"},
});
static_assert(are_valid_fields(kCameraFields));

}  // namespace

CameraTrackerOptions::CameraTrackerOptions() { set_defaults(*this, kCameraFields); }

OptionSection section_of(CameraTrackerOptions& options) {
  return make_section("tracking.camera", options, kCameraFields);
}

}  // namespace pcavr
