// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "consistency_layout.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/solvers.hpp"

#include "consistency_checks.hpp"
#include "consistency_text.hpp"

namespace pcavr {
namespace {

/// Printed sizes are off by this share, and with them all distances [one std].
constexpr double kSizeStd = 0.01;
/// Tags are glued on by eye or laid out with a ruler, and marks have a width [m, one std].
constexpr double kPlacementStd = 1e-3;
/// Paper is not flat: 0.6 mm over a tag of 10 cm [rad, one std].
constexpr double kFlatnessStd = 0.35 * std::numbers::pi / 180.0;
/// A normalised squared error in six dimensions that chance exceeds once in 400 times [chi-square
/// distribution, as 3 std in one dimension].
constexpr double kMaxSquare = 20.1;
/// Disagreements that are reported, even where they are significant [m, rad]: smaller ones matter
/// to nobody, and the camera's stds contain them.
constexpr double kMinOffset = 5e-3;
constexpr double kMinRotation = 2.0 * std::numbers::pi / 180.0;
/// Disagreements from which on the recording is rejected [m, rad]: no ruler is read so badly.
constexpr double kContradictionOffset = 0.025;
constexpr double kContradictionRotation = 8.0 * std::numbers::pi / 180.0;
/// Only neighbours are compared if there are more tags: the time grows with the pairs.
constexpr std::size_t kMaxTagsOfAllPairs = 4;
constexpr std::size_t kNeighbours = 3;

using Pair = std::pair<std::size_t, std::size_t>;

/// The markers of base and of each object, by the object's name.
std::map<std::string, std::vector<std::size_t>> markers_by_body(const Manifest& manifest) {
  std::map<std::string, std::vector<std::size_t>> bodies;
  for (std::size_t i = 0; i < manifest.markers.size(); ++i) {
    const MarkerEntry& marker = manifest.markers[i];
    bodies[marker.role == MarkerRole::base ? "" : marker.object].push_back(i);
  }
  return bodies;
}

std::set<Pair> pairs_of(const Manifest& manifest, const std::vector<std::size_t>& markers) {
  const std::size_t neighbours =
      markers.size() <= kMaxTagsOfAllPairs ? markers.size() : kNeighbours;
  std::set<Pair> pairs;
  for (const std::size_t i : markers) {
    std::vector<std::pair<double, std::size_t>> nearest;
    for (const std::size_t j : markers) {
      if (i == j) continue;
      nearest.emplace_back(translation_distance(manifest.markers[i].T_parent_marker,
                                                manifest.markers[j].T_parent_marker),
                           j);
    }
    std::sort(nearest.begin(), nearest.end());
    for (std::size_t n = 0; n < std::min(neighbours, nearest.size()); ++n) {
      const std::size_t j = nearest[n].second;
      pairs.insert({std::min(i, j), std::max(i, j)});
    }
  }
  return pairs;
}

const TagDetection* find(const std::vector<TagDetection>& detections, const MarkerId& id) {
  const auto found = std::find_if(detections.begin(), detections.end(),
                                  [&](const TagDetection& one) { return one.id == id; });
  return found == detections.end() ? nullptr : &*found;
}

/// Covariance of the pair's error [v; w] in the second tag's axes by the prints.
Matrix6d print_covariance(const Pose& T_first_second) {
  const Eigen::Matrix3d R_second_first = T_first_second.rotation_matrix().transpose();
  const Eigen::Vector3d& p_first = T_first_second.translation();
  Eigen::Matrix<double, 6, 3> by_first;  // by the slope of the first tag's paper
  by_first << -R_second_first * skew(p_first), R_second_first;
  const Eigen::Vector3d p_second = R_second_first * p_first;
  Matrix6d covariance = kFlatnessStd * kFlatnessStd * by_first * by_first.transpose();
  covariance.topLeftCorner<3, 3>() += kSizeStd * kSizeStd * p_second * p_second.transpose() +
                                      kPlacementStd * kPlacementStd * Eigen::Matrix3d::Identity();
  covariance.bottomRightCorner<3, 3>() += kFlatnessStd * kFlatnessStd * Eigen::Matrix3d::Identity();
  return covariance;
}

TagPairCheck compared(const Pair& pair, const Pose& T_stated, const TagPairPose& seen) {
  TagPairCheck check{.first = pair.first,
                     .second = pair.second,
                     .T_first_second_stated = T_stated,
                     .T_first_second = seen.T_first_second,
                     .frames = seen.views};
  const Eigen::Matrix3d R = seen.T_first_second.rotation_matrix();
  const Eigen::Vector3d direction = R.transpose() * seen.T_first_second.translation().normalized();
  check.distance_std = std::sqrt(direction.dot(seen.covariance.topLeftCorner<3, 3>() * direction));
  check.offset = translation_distance(T_stated, seen.T_first_second);
  check.rotation = rotation_distance(T_stated, seen.T_first_second);
  Vector6d error;
  error.head<3>() = R.transpose() * (T_stated.translation() - seen.T_first_second.translation());
  error.tail<3>() = (seen.T_first_second.inverse() * T_stated).log().tail<3>();
  check.excess = std::sqrt(error.dot(seen.covariance.ldlt().solve(error)) / 6.0);
  const Matrix6d covariance = seen.covariance + print_covariance(seen.T_first_second);
  check.is_significant = error.dot(covariance.ldlt().solve(error)) > kMaxSquare;
  return check;
}

bool is_reported(const TagPairCheck& pair) {
  return pair.is_significant && (pair.offset >= kMinOffset || pair.rotation >= kMinRotation);
}

/// The tag that disagrees with all others that were compared with it, where these agree; nothing
/// where more than one, or none, is such a tag.
std::optional<std::size_t> culprit_of(const std::vector<TagPairCheck>& pairs,
                                      const TagPairCheck& disagreeing) {
  std::optional<std::size_t> culprit;
  for (const std::size_t tag : {disagreeing.first, disagreeing.second}) {
    std::size_t disagreements = 0;
    bool is_alone = true;  // the only one in the disagreements of its partners
    bool do_others_agree = false;
    for (const TagPairCheck& pair : pairs) {
      const bool has_tag = pair.first == tag || pair.second == tag;
      disagreements += has_tag && is_reported(pair) ? 1 : 0;
      is_alone = is_alone && (has_tag == is_reported(pair));
      do_others_agree = do_others_agree || (!has_tag && !is_reported(pair));
    }
    if (disagreements < 2 || !is_alone || !do_others_agree) continue;
    if (culprit) return std::nullopt;
    culprit = tag;
  }
  return culprit;
}

/// The columns that were read as x y z w contain w x y z.
Pose read_wxyz(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.rotation();
  return Pose(Eigen::Quaterniond(q.x(), q.y(), q.z(), q.w()), pose.translation());
}

/// A hint how to make the two agree.
std::string hint_of(const Manifest& manifest, const TagPairCheck& pair) {
  const Pose& first = manifest.markers[pair.first].T_parent_marker;
  const Pose& second = manifest.markers[pair.second].T_parent_marker;
  const auto fits = [&](const Pose& T_parent_first, const Pose& T_parent_second) {
    const Pose T_first_second = T_parent_first.inverse() * T_parent_second;
    return rotation_distance(T_first_second, pair.T_first_second) < kContradictionRotation &&
           translation_distance(T_first_second, pair.T_first_second) <
               kContradictionOffset + 3.0 * kFlatnessStd * pair.distance();
  };
  const std::string wxyz = ": write q as [qx, qy, qz, qw]";
  if (fits(read_wxyz(first), second)) {
    return key_of_marker(pair.first) + ".pose fits with its quaternion read as w x y z" + wxyz;
  }
  if (fits(first, read_wxyz(second))) {
    return key_of_marker(pair.second) + ".pose fits with its quaternion read as w x y z" + wxyz;
  }
  if (fits(read_wxyz(first), read_wxyz(second))) {
    return "both poses fit with their quaternions read as w x y z" + wxyz;
  }
  return "measure the poses and sizes of the tags again, or find them by pcavr calibrate tags";
}

ConsistencyFinding finding_of(const Manifest& manifest, const std::vector<TagPairCheck>& pairs,
                              const TagPairCheck& pair, const ConsistencyOptions& options) {
  const auto culprit = culprit_of(pairs, pair);
  const std::string place =
      culprit ? key_of_marker(*culprit) + ".pose"
              : key_of_marker(pair.first) + ".pose, " + key_of_marker(pair.second) + ".pose";
  const bool is_contradiction =
      pair.offset >= std::min(kContradictionOffset, options.contradiction_offset) ||
      pair.rotation >= std::min(kContradictionRotation, options.contradiction_rotation);
  return {
      .severity = is_contradiction ? FindingSeverity::contradiction : FindingSeverity::warning,
      .file = "recording.yaml",
      .place = place,
      .message = fmt::format(
          "{} and {} are {:.4f} +- {:.4f} m apart by the images that show both, and {:.4f} m by "
          "their poses; the second one is {:.0f} mm and {} from where its pose puts it (relative "
          "to the first, {} frames){}",
          manifest.markers[pair.first].id.to_string(), manifest.markers[pair.second].id.to_string(),
          pair.distance(), pair.distance_std, pair.stated_distance(), 1e3 * pair.offset,
          degrees(pair.rotation), pair.frames,
          culprit ? "; the other tags agree with each other" : ""),
      .hint = hint_of(manifest, pair),
      .frames = pair.frames};
}

}  // namespace

std::vector<TagPairCheck> compare_tag_pairs(
    const Manifest& manifest, const std::vector<std::vector<TagDetection>>& detections,
    std::size_t min_frames, const BodyPoseOptions& options) {
  std::vector<TagPairCheck> checks;
  for (const auto& [body, markers] : markers_by_body(manifest)) {
    for (const Pair& pair : pairs_of(manifest, markers)) {
      const MarkerEntry& first = manifest.markers[pair.first];
      const MarkerEntry& second = manifest.markers[pair.second];
      std::vector<TagPairView> views;
      for (const std::vector<TagDetection>& frame : detections) {
        const TagDetection* a = find(frame, first.id);
        const TagDetection* b = find(frame, second.id);
        if (a != nullptr && b != nullptr) views.push_back({*a, *b});
      }
      if (views.empty() || views.size() < min_frames) continue;
      const Pose T_stated = first.T_parent_marker.inverse() * second.T_parent_marker;
      const auto seen =
          solve_tag_pair(views, first.size, second.size, T_stated, *manifest.camera, options);
      if (seen) checks.push_back(compared(pair, T_stated, *seen));
    }
  }
  return checks;
}

std::vector<ConsistencyFinding> check_tag_layout(const Manifest& manifest,
                                                 const std::vector<TagPairCheck>& pairs,
                                                 const ConsistencyOptions& options) {
  // The pair that is off the most, for each set of tags that are named.
  std::map<std::string, std::pair<double, ConsistencyFinding>> worst;
  for (const TagPairCheck& pair : pairs) {
    if (!is_reported(pair)) continue;
    ConsistencyFinding finding = finding_of(manifest, pairs, pair, options);
    const auto found = worst.find(finding.place);
    if (found != worst.end() && found->second.first >= pair.excess) continue;
    worst.insert_or_assign(finding.place, std::pair{pair.excess, std::move(finding)});
  }
  std::vector<ConsistencyFinding> findings;
  for (auto& [place, finding] : worst) findings.push_back(std::move(finding.second));
  return findings;
}

namespace {

/// The share of a pair's disagreement that the images' noise does not explain, as an error of the
/// body's pose; nothing where noise explains it all.
std::optional<LayoutDoubt> doubt_of(const Manifest& manifest, const TagPairCheck& pair) {
  if (6.0 * pair.excess * pair.excess <= kMaxSquare) return std::nullopt;
  const double share = std::sqrt(1.0 - 1.0 / (pair.excess * pair.excess));
  const double offset = share * pair.offset;
  // Either tag may be the wrong one, and both turn the body, or the camera, about them.
  const double rotation = std::max(
      share * pair.rotation, offset / std::max(pair.distance(), manifest.markers[pair.first].size));
  return LayoutDoubt{0.5 * offset, rotation};
}

}  // namespace

void widen_by_layout(const Manifest& manifest, const std::vector<TagPairCheck>& pairs,
                     CameraTrack& track) {
  for (const TagPairCheck& pair : pairs) {
    const MarkerEntry& first = manifest.markers[pair.first];
    const MarkerEntry& second = manifest.markers[pair.second];
    const std::optional<LayoutDoubt> doubt = doubt_of(manifest, pair);
    if (first.role != MarkerRole::base || !doubt) continue;
    const Eigen::Vector3d centre =
        0.5 * (first.T_parent_marker.translation() + second.T_parent_marker.translation());
    for (FramePlacement& frame : track.frames) {
      if (frame.status != PlacementStatus::placed) continue;
      const double distance = (frame.T_base_camera.translation() - centre).norm();
      frame.position_std =
          std::hypot(frame.position_std, doubt->offset, doubt->rotation * distance);
      frame.rotation_std = std::hypot(frame.rotation_std, doubt->rotation);
    }
  }
}

LayoutDoubt layout_doubt(const Manifest& manifest, const std::vector<TagPairCheck>& pairs,
                         const std::string& object) {
  LayoutDoubt all;
  for (const TagPairCheck& pair : pairs) {
    const MarkerEntry& first = manifest.markers[pair.first];
    if (first.role != MarkerRole::object || first.object != object) continue;
    const LayoutDoubt doubt = doubt_of(manifest, pair).value_or(LayoutDoubt{});
    all.offset = std::max(all.offset, doubt.offset);
    all.rotation = std::max(all.rotation, doubt.rotation);
  }
  return all;
}

}  // namespace pcavr
