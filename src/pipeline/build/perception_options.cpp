// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/perception_options.hpp"

#include <array>
#include <numbers>
#include <optional>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr auto kLoadedTipFields = std::to_array<OptionField<LoadedTipOptions>>({
    // Data sheets of strain wave gears state their spring constants to about 20 %: the std of a
    // uniform distribution over that.
    {"gear_stiffness_std", &LoadedTipOptions::gear_stiffness_std, 0.12, 0.0, 1.0, "",
     "relative std of a joint's stated gear stiffness",
     "lower: stds of the contact law do not cover; higher: it is less known than it is"},
    // Strain wave gears of arms of 1 to 10 kg: 5 to 10 arc minutes.
    {"wind_up", &LoadedTipOptions::wind_up, 0.002, 0.0, 0.1, "rad",
     "deflection at the joint's torque limit of gears without a stated stiffness: an uncertainty",
     "lower: stds of the contact law do not cover; higher: it is less known than it is"},
});
static_assert(are_valid_fields(kLoadedTipFields));

constexpr auto kMaskFields = std::to_array<OptionField<MaskOptions>>({
    {"first_body_margin", &MaskOptions::first_body_margin, 4, 0, 100, "px",
     "dilation of a body's silhouette while the camera is tracked, with poses from tags alone",
     "lower: moving bodies pull the camera; higher: less of the static scene is used"},
    {"body_margin", &MaskOptions::body_margin, 3, 0, 100, "px",
     "dilation of a body's silhouette in fusion, for colour bleeding and errors of the pose",
     "lower: rims of bodies are fused; higher: holes in the table around bodies"},
    {"tool_margin", &MaskOptions::tool_margin, 3, 0, 100, "px",
     "dilation of the tool's region, for pixels that mix it with its background",
     "lower: rims of the tool are fused; higher: less of the scene behind it is seen"},
    {"tip_margin", &MaskOptions::tip_margin, 0.01, 0.0, 0.2, "m",
     "margin around the tip's radius within which the shaft begins",
     "lower: a misplaced tip is not found; higher: what the tip touches is masked"},
    // Tools are logged at 100 Hz and more.
    {"max_tool_gap", &MaskOptions::max_tool_gap, 0.1, 0.001, 10.0, "s",
     "maximum time between a frame and a pose of the tool",
     "lower: the tool is fused where its log has gaps; higher: the mask lags behind the tool"},
    // The step is above a sensor's noise at 2 m, and below the gap between a tool and its
    // background.
    {"max_depth_step", &MaskOptions::max_depth_step, 0.02, 0.001, 0.5, "m",
     "maximum depth step between neighbouring pixels of the tool",
     "lower: parts of the tool are fused; higher: the mask grows into the background"},
    // The motion is above the diagonal of a cell of 1 cm.
    {"min_tip_motion", &MaskOptions::min_tip_motion, 0.03, 0.02, 1.0, "m",
     "distance between tip positions that count as different",
     "lower: static things are taken for the tool; higher: the tool's shape is found late"},
    {"min_tip_positions", &MaskOptions::min_tip_positions, 3, 2, 1000, "",
     "positions of the tip at which something must be seen to be the tool's shape",
     "lower: static things are taken for the tool; higher: the tool's shape is found late"},
    // An arm's length.
    {"max_tip_distance", &MaskOptions::max_tip_distance, 2.0, 0.1, 20.0, "m",
     "maximum distance of the tool's shape from its tip",
     "lower: the far end of a long tool or arm is fused; higher: slower"},
});
static_assert(are_valid_fields(kMaskFields));

using Consistency = ConsistencyOptions;
constexpr auto kConsistencyFields = std::to_array<OptionField<Consistency>>({
    // Depth cameras are biased by 1 to 2 %, and so are printed tags: together at most 4 %.
    {"warning_factor", &Consistency::warning_factor, 1.05, 1.001, 2.0, "",
     "ratio of two statements of one length from which a warning is given",
     "lower: warnings of usual errors; higher: wrong scales are not noticed"},
    // No sensor and no printer is that far off; the usual mistakes (half a size, inches,
    // millimetres, another sensor's depth scale) are farther off.
    {"contradiction_factor", &Consistency::contradiction_factor, 1.5, 1.01, 10.0, "",
     "ratio of two statements of one length from which the recording is rejected",
     "lower: inaccurate recordings are rejected; higher: scenes of a wrong scale are built"},
    // Twice a sensor's noise at 1.5 m, and the flatness of paper on a table.
    {"tag_distance_error", &Consistency::tag_distance_error, 0.012, 0.0, 1.0, "m",
     "error of a distance between two tags measured by depth",
     "lower: warnings of usual errors; higher: misplaced tags are not noticed"},
    {"max_body_size", &Consistency::max_body_size, 2.0, 0.01, 100.0, "m",
     "a movable body with a longer side is warned of",
     "lower: warnings of large bodies; higher: meshes in another unit are not noticed"},
    // A tag's plate or foam board.
    {"tag_offset", &Consistency::tag_offset, 0.015, 0.0, 1.0, "m",
     "distance of a body's tags from its mesh from which a warning is given",
     "lower: warnings of tags on plates; higher: misplaced tags are not noticed"},
    // A hand-eye calibration has an error of 5 to 20 mm, an arm's commanded pose is another 15 mm
    // and 2 degrees from its real one, at arm's length 20 mm more.
    {"warning_offset", &Consistency::warning_offset, 0.05, 0.001, 10.0, "m",
     "distance between base tags by groundtruth.txt and by recording.yaml: warning",
     "lower: warnings of usual errors; higher: a wrong calibration is not noticed"},
    {"contradiction_offset", &Consistency::contradiction_offset, 0.15, 0.002, 100.0, "m",
     "as warning_offset: the recording is rejected",
     "lower: inaccurate recordings are rejected; higher: surfaces are doubled"},
    // Tracking drifts by less than a degree over a step of 5 degrees or 5 cm.
    {"warning_rotation", &Consistency::warning_rotation, 3.0 * kDegree, 0.01, 3.0, "rad",
     "difference of rotations by groundtruth.txt and by tracking the images: warning",
     "lower: warnings of usual errors; higher: a wrong order of quaternions is not noticed"},
    {"contradiction_rotation", &Consistency::contradiction_rotation, 10.0 * kDegree, 0.02, 3.1,
     "rad", "as warning_rotation: the recording is rejected",
     "lower: inaccurate recordings are rejected; higher: scenes of wrong poses are built"},
    // Both have errors of 2 to 3 mm, 5 degrees over a step; a mounting 10 degrees off is a
    // calibration error, one of 30 degrees is another convention.
    {"warning_direction", &Consistency::warning_direction, 10.0 * kDegree, 0.02, 3.0, "rad",
     "difference of directions of motion in the camera's axes: warning",
     "lower: warnings of usual errors; higher: a wrong convention is not noticed"},
    {"contradiction_direction", &Consistency::contradiction_direction, 30.0 * kDegree, 0.03, 3.1,
     "rad", "as warning_direction: the recording is rejected",
     "lower: inaccurate recordings are rejected; higher: scenes of wrong poses are built"},
});
static_assert(are_valid_fields(kConsistencyFields));

}  // namespace

MaskOptions::MaskOptions() { set_defaults(*this, kMaskFields); }

ConsistencyOptions::ConsistencyOptions() { set_defaults(*this, kConsistencyFields); }

OptionSection section_of(MaskOptions& options) {
  return make_section("masks", options, kMaskFields);
}

LoadedTipOptions::LoadedTipOptions() { set_defaults(*this, kLoadedTipFields); }
OptionSection section_of(LoadedTipOptions& options) {
  return make_section("tip_under_load", options, kLoadedTipFields);
}

OptionSection section_of(ConsistencyOptions& options) {
  OptionSection section = make_section("consistency", options, kConsistencyFields);
  section.check = [&options]() -> std::optional<Error> {
    if (options.warning_factor <= options.contradiction_factor &&
        options.warning_offset <= options.contradiction_offset &&
        options.warning_rotation <= options.contradiction_rotation &&
        options.warning_direction <= options.contradiction_direction) {
      return std::nullopt;
    }
    return Error{.message = "a warning threshold is above its contradiction threshold",
                 .hint = "lower warning_* or raise contradiction_*"};
  };
  return section;
}

CameraTrackerOptions camera_options(const PerceptionOptions& options) {
  CameraTrackerOptions camera = options.camera;
  camera.depth_noise = options.depth_noise;
  camera.body_pose = options.body_pose;
  return camera;
}

ObjectTrackerOptions object_options(const PerceptionOptions& options) {
  ObjectTrackerOptions objects = options.objects;
  objects.depth_noise = options.depth_noise;
  objects.body_pose = options.body_pose;
  return objects;
}

std::vector<OptionSection> sections_of(PerceptionOptions& options) {
  return {section_of(options.depth_noise), section_of(options.tag_detector),
          section_of(options.body_pose),   section_of(options.camera),
          section_of(options.objects),     section_of(options.objects.rest),
          section_of(options.masks),       section_of(options.consistency),
          section_of(options.cad),         section_of(options.loaded_tip)};
}

}  // namespace pcavr
