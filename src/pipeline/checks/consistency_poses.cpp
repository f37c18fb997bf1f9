// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/base/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// A step ends where the camera has rotated by this [rad], or moved by kMinStep.
constexpr double kMinTurn = 5.0 * std::numbers::pi / 180.0;
/// Minimum step whose direction is compared [m]: tracking and given poses have errors of 2 to 3 mm
/// each, which is 5 degrees.
constexpr double kMinStep = 0.05;

/// The correction of a common mistake in a file of poses.
struct PoseCorrection {
  const char* hint;
  Pose (*apply)(const Pose& given);
};

Pose as_given(const Pose& given) { return given; }

/// The columns that were read as x y z w contain w x y z.
Pose from_wxyz(const Pose& given) {
  const Eigen::Quaterniond& q = given.rotation();
  return Pose(Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), given.translation());
}

Pose inverted(const Pose& given) { return given.inverse(); }

Pose from_millimetres(const Pose& given) {
  return Pose(given.rotation(), 1e-3 * given.translation());
}

constexpr PoseCorrection kPoseCorrections[] = {
    {"the poses fit with quaternions read as qw qx qy qz: write qx qy qz qw", from_wxyz},
    {"the poses fit inverted: write the camera's pose in base, not base's in the camera", inverted},
    {"the positions fit when read as millimetres: write metres", from_millimetres}};

/// A base tag as measured by depth, with the given camera pose.
struct BaseTagMeasurement {
  Pose T_base_camera;
  Eigen::Vector3d p_camera;
  Eigen::Vector3d p_base;  ///< by the manifest
};

std::vector<BaseTagMeasurement> base_tag_measurements(
    const Manifest& manifest, const Trajectory& groundtruth,
    const std::vector<TagMeasurement>& measurements, const std::vector<Stamp>& depth_stamps) {
  std::vector<BaseTagMeasurement> base_tags;
  for (const TagMeasurement& tag : measurements) {
    const MarkerEntry& marker = manifest.markers[tag.marker];
    const auto pose = groundtruth.at(depth_stamps[tag.frame]);
    if (marker.role != MarkerRole::base || !pose) continue;
    base_tags.push_back({*pose, tag.centre_camera(), marker.T_parent_marker.translation()});
  }
  return base_tags;
}

double median_offset(const std::vector<BaseTagMeasurement>& tags, Pose (*correct)(const Pose&)) {
  std::vector<double> offsets;
  offsets.reserve(tags.size());
  for (const BaseTagMeasurement& tag : tags) {
    offsets.push_back((correct(tag.T_base_camera) * tag.p_camera - tag.p_base).norm());
  }
  return median(std::move(offsets));
}

/// Relative motion between two frames, by the given poses and by tracking.
struct Step {
  Pose T_base_from;
  Pose T_base_to;
  Pose T_from_to_tracked;
};

/// Depth too small by more than this is none of a camera; given positions may then be in another
/// unit.
constexpr double kMaxSmallness = 20.0;
/// Fewer steps than this may be the effect of one bad alignment.
constexpr std::size_t kMinSteps = 5;
/// Alignments over more than this between consecutive frames [m, rad] are unreliable: a camera at
/// 10 Hz that moves at 1 m/s.
constexpr double kMaxFrameStep = 0.1;
constexpr double kMaxFrameTurn = 15.0 * std::numbers::pi / 180.0;

/// Whether two frames with given poses are aligned to each other and close together. The smaller of
/// the two distances counts: the other may be in another unit.
bool is_near(const FramePlacement& a, const FramePlacement& b, const Trajectory& groundtruth) {
  const double tracked = translation_distance(a.T_segment_camera, b.T_segment_camera);
  const double given = translation_distance(*groundtruth.at(a.stamp), *groundtruth.at(b.stamp));
  return a.segment == b.segment && std::min(tracked, given) <= kMaxFrameStep &&
         rotation_distance(a.T_segment_camera, b.T_segment_camera) <= kMaxFrameTurn;
}

/// Steps over aligned frames; each ends as soon as `has_ended` is true of it.
template <typename HasEnded>
std::vector<Step> steps(const CameraTrack& track, const Trajectory& groundtruth,
                        const HasEnded& has_ended) {
  std::vector<Step> found;
  const FramePlacement* from = nullptr;
  const FramePlacement* before = nullptr;
  for (const FramePlacement& to : track.frames) {
    if (to.segment < 0 || !groundtruth.at(to.stamp)) continue;
    const bool is_aligned = before != nullptr && is_near(*before, to, groundtruth);
    before = &to;
    if (!is_aligned) {
      from = &to;
      continue;
    }
    const Step step{*groundtruth.at(from->stamp), *groundtruth.at(to.stamp),
                    from->T_segment_camera.inverse() * to.T_segment_camera};
    if (!has_ended(step)) continue;
    found.push_back(step);
    from = &to;
  }
  return found;
}

bool has_moved(const Pose& tracked) { return tracked.translation().norm() >= kMinStep; }

bool has_moved_or_rotated(const Step& step) {
  return has_moved(step.T_from_to_tracked) ||
         rotation_distance(Pose(), step.T_from_to_tracked) >= kMinTurn;
}

/// Whether the camera has moved as tracked or as given: with depth in too small a unit, a camera at
/// a table never moves by kMinStep as tracked.
bool has_moved_by_either(const Step& step) {
  const double tracked = step.T_from_to_tracked.translation().norm();
  const double given = translation_distance(step.T_base_from, step.T_base_to);
  return tracked >= kMinStep || (given >= kMinStep && given <= kMaxSmallness * tracked);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Differences of given and tracked rotations and directions of motion, in the camera's axes [rad].
/// A constant error of the convention may show in the directions alone.
struct StepErrors {
  double rotation = 0.0;   ///< median
  double direction = 0.0;  ///< median; 0 where too few steps are long enough
};

StepErrors step_errors(const std::vector<Step>& all, Pose (*correct)(const Pose&)) {
  std::vector<double> rotations;
  std::vector<double> directions;
  for (const Step& step : all) {
    const Pose T_from_to = correct(step.T_base_from).inverse() * correct(step.T_base_to);
    rotations.push_back(rotation_distance(T_from_to, step.T_from_to_tracked));
    if (!has_moved(step.T_from_to_tracked)) continue;
    directions.push_back(
        angle_between(T_from_to.translation(), step.T_from_to_tracked.translation()));
  }
  if (directions.size() < kMinSteps) directions.clear();
  return {median(std::move(rotations)), median(std::move(directions))};
}

/// The largest error in multiples of its warning threshold.
double severity_of(const StepErrors& errors, const ConsistencyOptions& options) {
  return std::max(errors.rotation / options.warning_rotation,
                  errors.direction / options.warning_direction);
}

}  // namespace

std::optional<ScaleRatio> motion_ratio(const CameraTrack& track, const Trajectory& groundtruth,
                                       const ConsistencyOptions& options) {
  /// Tracking drifts by up to this share of the path: alignment errors accumulate.
  constexpr double kDrift = 0.05;
  constexpr double kMinStated = 1e-6;  // [m]: avoids a division by 0 for a camera at rest
  std::vector<double> stated;
  std::vector<double> logs;
  for (const Step& step : steps(track, groundtruth, has_moved_by_either)) {
    stated.push_back(std::max(kMinStated, translation_distance(step.T_base_from, step.T_base_to)));
    logs.push_back(std::log(step.T_from_to_tracked.translation().norm() / stated.back()));
  }
  if (logs.size() < kMinSteps) return std::nullopt;
  const std::size_t count = logs.size();
  const double typical = median(std::move(stated));
  return ScaleRatio{.kind = ScaleRatio::Kind::camera_motion,
                    .stated = typical,
                    .by_depth = typical * std::exp(median(std::move(logs))),
                    .tolerance = std::log(options.warning_factor + kDrift),
                    .frames = count};
}

std::optional<ConsistencyFinding> check_camera_motion(const CameraTrack& track,
                                                      const Trajectory& groundtruth,
                                                      const ConsistencyOptions& options) {
  const std::vector<Step> all = steps(track, groundtruth, has_moved_or_rotated);
  if (all.size() < kMinSteps) return std::nullopt;
  const StepErrors errors = step_errors(all, as_given);
  if (severity_of(errors, options) < 1.0) return std::nullopt;
  const bool is_contradiction = errors.rotation >= options.contradiction_rotation ||
                                errors.direction >= options.contradiction_direction;
  ConsistencyFinding finding{
      .severity = is_contradiction ? FindingSeverity::contradiction : FindingSeverity::warning,
      .file = "groundtruth.txt",
      .message = "its relative rotations are " + degrees(errors.rotation) +
                 ", and its directions of motion " + degrees(errors.direction) +
                 ", off those from tracking the images (medians of " + std::to_string(all.size()) +
                 " steps)",
      .hint = "check the order of its quaternions (qx qy qz qw), its frame and its clock",
      .frames = all.size()};
  for (const PoseCorrection& correction : kPoseCorrections) {
    if (severity_of(step_errors(all, correction.apply), options) < 1.0) {
      finding.hint = correction.hint;
    }
  }
  return finding;
}

std::optional<ConsistencyFinding> check_camera_offset(
    const Manifest& manifest, const Trajectory& groundtruth,
    const std::vector<TagMeasurement>& measurements, const std::vector<Stamp>& depth_stamps,
    std::size_t min_frames, const ConsistencyOptions& options) {
  const std::vector<BaseTagMeasurement> base_tags =
      base_tag_measurements(manifest, groundtruth, measurements, depth_stamps);
  if (base_tags.empty() || base_tags.size() < min_frames) return std::nullopt;
  const double offset = median_offset(base_tags, as_given);
  if (offset < options.warning_offset) return std::nullopt;
  ConsistencyFinding finding{
      .severity = offset >= options.contradiction_offset ? FindingSeverity::contradiction
                                                         : FindingSeverity::warning,
      .file = "groundtruth.txt",
      .message = "with its camera poses the base tags lie " + measured(offset) +
                 " from where recording.yaml puts them (median of " +
                 std::to_string(base_tags.size()) + " measurements)",
      .hint = "check that its frame is base and its unit metres, or the base markers' poses",
      .frames = base_tags.size()};
  for (const PoseCorrection& correction : kPoseCorrections) {
    if (median_offset(base_tags, correction.apply) < options.warning_offset) {
      finding.hint = correction.hint;
    }
  }
  return finding;
}

}  // namespace pcavr
