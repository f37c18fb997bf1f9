// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pcavr/core/median.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// groundtruth.txt and base tags: a hand-eye calibration is good to 5 to 20 mm, and an arm's
/// commanded pose is another 15 mm and 2 degrees from its real one, at arm's length 20 mm more.
constexpr double kWarningOffset = 0.05;  // [m]
/// Beyond this no calibration explains it, and surfaces would be seen twice.
constexpr double kContradictionOffset = 0.15;  // [m]
/// Rotation from one frame to a later one: tracking drifts by less than a degree over such a step.
constexpr double kWarningRotation = 3.0 * std::numbers::pi / 180.0;  // [rad]
constexpr double kContradictionRotation = 10.0 * std::numbers::pi / 180.0;
/// A step ends where the camera has turned by this [rad], or gone as far as below.
constexpr double kMinTurn = 5.0 * std::numbers::pi / 180.0;
/// Direction of a motion in the camera's axes, over steps of at least this length [m]: tracking and
/// given poses are each off by 2 to 3 mm, which is 5 degrees; a camera mounted 10 degrees from
/// where the file says is a calibration's fault, one of 30 degrees another convention's.
constexpr double kMinStep = 0.05;
constexpr double kWarningDirection = 10.0 * std::numbers::pi / 180.0;
constexpr double kContradictionDirection = 30.0 * std::numbers::pi / 180.0;

/// A usual mistake in a file of poses, undone.
struct PoseReading {
  const char* hint;
  Pose (*apply)(const Pose& given);
};

Pose as_given(const Pose& given) { return given; }

/// The columns that were read as x y z w hold w x y z.
Pose from_wxyz(const Pose& given) {
  const Eigen::Quaterniond& q = given.rotation();
  return Pose(Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), given.translation());
}

Pose inverted(const Pose& given) { return given.inverse(); }

Pose from_millimetres(const Pose& given) {
  return Pose(given.rotation(), 1e-3 * given.translation());
}

constexpr PoseReading kPoseReadings[] = {
    {"the poses fit with quaternions read as qw qx qy qz: write qx qy qz qw", from_wxyz},
    {"the poses fit inverted: write the camera's pose in base, not base's in the camera", inverted},
    {"the positions fit when read as millimetres: write metres", from_millimetres}};

/// A base tag as depth sees it, with the given camera pose.
struct PlacedSight {
  Pose T_base_camera;
  Eigen::Vector3d p_camera;
  Eigen::Vector3d p_base;  ///< by the manifest
};

std::vector<PlacedSight> placed_sights(const Manifest& manifest, const Trajectory& groundtruth,
                                       const std::vector<TagSight>& sights,
                                       const std::vector<Stamp>& depth_stamps) {
  std::vector<PlacedSight> placed;
  for (const TagSight& sight : sights) {
    const MarkerEntry& marker = manifest.markers[sight.marker];
    const auto pose = groundtruth.at(depth_stamps[sight.frame]);
    if (marker.role != MarkerRole::base || !pose) continue;
    placed.push_back({*pose, sight.centre_camera(), marker.T_parent_marker.translation()});
  }
  return placed;
}

double median_offset(const std::vector<PlacedSight>& sights, Pose (*reading)(const Pose&)) {
  std::vector<double> offsets;
  offsets.reserve(sights.size());
  for (const PlacedSight& sight : sights) {
    offsets.push_back((reading(sight.T_base_camera) * sight.p_camera - sight.p_base).norm());
  }
  return median(std::move(offsets));
}

/// Two frames between which the camera moved or turned, given and tracked.
struct Step {
  Pose T_base_from;
  Pose T_base_to;
  Pose T_from_to_tracked;
};

/// Fewer steps than this may all be one bad alignment.
constexpr std::size_t kMinSteps = 5;
/// Alignments over more than this from a frame to the next [m, rad] may be wrong: a camera at 10 Hz
/// that goes at 1 m/s.
constexpr double kMaxFrameStep = 0.1;
constexpr double kMaxFrameTurn = 15.0 * std::numbers::pi / 180.0;

/// Two frames with given poses are aligned to each other, and near. Of the two distances the
/// smaller one counts: the other may be in another unit.
bool is_near(const FramePlacement& a, const FramePlacement& b, const Trajectory& groundtruth) {
  const double tracked = translation_distance(a.T_segment_camera, b.T_segment_camera);
  const double given = translation_distance(*groundtruth.at(a.stamp), *groundtruth.at(b.stamp));
  return a.segment == b.segment && std::min(tracked, given) <= kMaxFrameStep &&
         rotation_distance(a.T_segment_camera, b.T_segment_camera) <= kMaxFrameTurn;
}

/// Steps that end as soon as `has_ended` says so of the tracked motion, all frames between aligned
/// to each other.
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
    const Pose tracked = from->T_segment_camera.inverse() * to.T_segment_camera;
    if (!has_ended(tracked)) continue;
    found.push_back({*groundtruth.at(from->stamp), *groundtruth.at(to.stamp), tracked});
    from = &to;
  }
  return found;
}

bool has_gone(const Pose& tracked) { return tracked.translation().norm() >= kMinStep; }

bool has_gone_or_turned(const Pose& tracked) {
  return has_gone(tracked) || rotation_distance(Pose(), tracked) >= kMinTurn;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// By how much given rotations and directions of motion, in the camera's axes, differ from tracked
/// ones [rad]. A convention that is wrong in the same way everywhere may show in the latter alone.
struct StepErrors {
  double rotation = 0.0;   ///< median
  double direction = 0.0;  ///< median; 0 where too few steps are long enough
};

StepErrors step_errors(const std::vector<Step>& all, Pose (*reading)(const Pose&)) {
  std::vector<double> rotations;
  std::vector<double> directions;
  for (const Step& step : all) {
    const Pose T_from_to = reading(step.T_base_from).inverse() * reading(step.T_base_to);
    rotations.push_back(rotation_distance(T_from_to, step.T_from_to_tracked));
    if (!has_gone(step.T_from_to_tracked)) continue;
    directions.push_back(
        angle_between(T_from_to.translation(), step.T_from_to_tracked.translation()));
  }
  if (directions.size() < kMinSteps) directions.clear();
  return {median(std::move(rotations)), median(std::move(directions))};
}

/// In multiples of what a warning is due for.
double severity_of(const StepErrors& errors) {
  return std::max(errors.rotation / kWarningRotation, errors.direction / kWarningDirection);
}

}  // namespace

std::optional<ScaleRatio> motion_ratio(const CameraTrack& track, const Trajectory& groundtruth) {
  /// Tracking drifts by up to this share of the path: it chains alignments.
  constexpr double kDrift = 0.05;
  constexpr double kMinStated = 1e-6;  // [m]: a camera that stands still has no ratio
  std::vector<double> stated;
  std::vector<double> logs;
  for (const Step& step : steps(track, groundtruth, has_gone)) {
    stated.push_back(std::max(kMinStated, translation_distance(step.T_base_from, step.T_base_to)));
    logs.push_back(std::log(step.T_from_to_tracked.translation().norm() / stated.back()));
  }
  if (logs.size() < kMinSteps) return std::nullopt;
  const std::size_t count = logs.size();
  const double typical = median(std::move(stated));
  return ScaleRatio{.kind = ScaleRatio::Kind::camera_motion,
                    .stated = typical,
                    .by_depth = typical * std::exp(median(std::move(logs))),
                    .tolerance = std::log(kWarningFactor + kDrift),
                    .frames = count};
}

std::optional<ConsistencyFinding> check_camera_motion(const CameraTrack& track,
                                                      const Trajectory& groundtruth) {
  const std::vector<Step> all = steps(track, groundtruth, has_gone_or_turned);
  if (all.size() < kMinSteps) return std::nullopt;
  const StepErrors errors = step_errors(all, as_given);
  if (severity_of(errors) < 1.0) return std::nullopt;
  const bool is_contradiction =
      errors.rotation >= kContradictionRotation || errors.direction >= kContradictionDirection;
  ConsistencyFinding finding{
      .severity = is_contradiction ? FindingSeverity::contradiction : FindingSeverity::warning,
      .file = "groundtruth.txt",
      .message = "from frame to frame its rotations are " + degrees(errors.rotation) +
                 ", and its directions of motion " + degrees(errors.direction) +
                 ", from those that tracking the images finds (medians of " +
                 std::to_string(all.size()) + " steps)",
      .hint = "check the order of its quaternions (qx qy qz qw), its frame and its clock",
      .frames = all.size()};
  for (const PoseReading& reading : kPoseReadings) {
    if (severity_of(step_errors(all, reading.apply)) < 1.0) finding.hint = reading.hint;
  }
  return finding;
}

std::optional<ConsistencyFinding> check_camera_offset(const Manifest& manifest,
                                                      const Trajectory& groundtruth,
                                                      const std::vector<TagSight>& sights,
                                                      const std::vector<Stamp>& depth_stamps,
                                                      std::size_t min_frames) {
  const std::vector<PlacedSight> placed =
      placed_sights(manifest, groundtruth, sights, depth_stamps);
  if (placed.empty() || placed.size() < min_frames) return std::nullopt;
  const double offset = median_offset(placed, as_given);
  if (offset < kWarningOffset) return std::nullopt;
  ConsistencyFinding finding{
      .severity = offset >= kContradictionOffset ? FindingSeverity::contradiction
                                                 : FindingSeverity::warning,
      .file = "groundtruth.txt",
      .message = "with its camera poses the base tags lie " + measured(offset) +
                 " from where recording.yaml puts them (median of " +
                 std::to_string(placed.size()) + " sightings)",
      .hint = "check that its frame is base and its unit metres, or the base markers' poses",
      .frames = placed.size()};
  for (const PoseReading& reading : kPoseReadings) {
    if (median_offset(placed, reading.apply) < kWarningOffset) finding.hint = reading.hint;
  }
  return finding;
}

}  // namespace pcavr
