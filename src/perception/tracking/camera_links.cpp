// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_links.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "pcavr/perception/tracking/stated_poses.hpp"

namespace pcavr::tracking {
namespace {

constexpr double kMaxStds = 5.0;
/// Hand-eye calibrations are off by up to 20 mm, commanded poses by 15 mm and 2 degrees: of two
/// poses, and over some distance, by up to this [m, rad].
constexpr double kUsualOffset = 0.1;
constexpr double kUsualRotation = 6.0 * std::numbers::pi / 180.0;
/// Errors of an alignment between two views that are far apart, beside those of stated poses
/// [m, rad].
constexpr double kAlignmentOffset = 0.02;
constexpr double kAlignmentRotation = 1.0 * std::numbers::pi / 180.0;
/// A pose whose way from the one before to the one after it is this many times the direct one has
/// jumped and returned.
constexpr double kJumpRatio = 3.0;

bool is_near(const Pose& T_a_b, const Pose& T_a_b_given, const CameraTrackerOptions& options) {
  // Stds of the difference of two given poses, all axes combined.
  const double position_std = std::sqrt(6.0) * options.groundtruth_position_std;
  const double rotation_std = std::sqrt(6.0) * options.groundtruth_rotation_std;
  const double lever = T_a_b_given.translation().norm();
  const bool is_stated = are_pose_stds_stated(options);
  const double min_offset = is_stated ? kAlignmentOffset : kUsualOffset;
  const double min_rotation = is_stated ? kAlignmentRotation : kUsualRotation;
  return translation_distance(T_a_b, T_a_b_given) <=
             std::max(min_offset, kMaxStds * std::hypot(position_std, rotation_std * lever)) &&
         rotation_distance(T_a_b, T_a_b_given) <= std::max(min_rotation, kMaxStds * rotation_std);
}

class LinkSelection {
 public:
  LinkSelection(const std::vector<Keyframe>& keyframes, const std::vector<FrameRecord>& records,
                const Trajectory& given, const CameraTrackerOptions& options)
      : keyframes_(keyframes), records_(records), options_(options) {
    for (const FrameRecord& record : records) given_.push_back(given.at(record.stamp));
  }

  SelectedLinks select() {
    for (const FrameRecord& record : records_) selected_.links.push_back(record.links);
    for (const Keyframe& keyframe : keyframes_) {
      selected_.keyframes.push_back({keyframe.segment, keyframe.T_segment_keyframe});
    }
    if (!are_given_poses_credible()) return std::move(selected_);
    for (std::size_t r = 0; r < records_.size(); ++r) {
      selected_.rejected += std::erase_if(selected_.links[r], [&](const FrameLink& link) {
        return contradicts(r, link) && !has_jumped(r) && !has_jumped(record_of(link));
      });
    }
    if (selected_.rejected > 0) locate_keyframes();
    return std::move(selected_);
  }

 private:
  [[nodiscard]] std::size_t record_of(const FrameLink& link) const {
    return keyframes_[link.keyframe].record;
  }
  [[nodiscard]] bool is_comparable(std::size_t r, const FrameLink& link) const {
    return given_[r] && given_[record_of(link)];
  }
  [[nodiscard]] bool contradicts(std::size_t r, const FrameLink& link) const {
    return is_comparable(r, link) &&
           !is_near(link.T_keyframe_frame, given_[record_of(link)]->inverse() * *given_[r],
                    options_);
  }
  [[nodiscard]] bool are_given_poses_credible() const {
    if (are_pose_stds_stated(options_)) return true;
    std::size_t comparable = 0;
    std::size_t contradicted = 0;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      for (const FrameLink& link : records_[r].links) {
        comparable += is_comparable(r, link) ? 1 : 0;
        contradicted += contradicts(r, link) ? 1 : 0;
      }
    }
    return 2 * contradicted <= comparable;
  }
  [[nodiscard]] bool has_jumped(std::size_t r) const {
    if (are_pose_stds_stated(options_)) return false;
    if (r == 0 || r + 1 >= records_.size()) return false;
    const auto& before = given_[r - 1];
    const auto& after = given_[r + 1];
    if (!before || !after) return false;
    const double direct = translation_distance(*before, *after);
    const double way =
        translation_distance(*before, *given_[r]) + translation_distance(*given_[r], *after);
    return way > kUsualOffset && way > kJumpRatio * direct;
  }

  /// Poses of two keyframes relative to each other, by one frame that is linked to both.
  struct Edge {
    std::size_t from = 0;
    std::size_t to = 0;
    Pose T_from_to;
  };
  [[nodiscard]] std::vector<Edge> edges() const {
    std::vector<std::optional<std::size_t>> keyframe_of(records_.size());
    for (std::size_t k = 0; k < keyframes_.size(); ++k) keyframe_of[keyframes_[k].record] = k;
    std::vector<Edge> edges;
    for (std::size_t r = 0; r < records_.size(); ++r) {
      const std::vector<FrameLink>& links = selected_.links[r];
      for (std::size_t i = 0; i < links.size(); ++i) {
        if (keyframe_of[r]) {
          edges.push_back({links[i].keyframe, *keyframe_of[r], links[i].T_keyframe_frame});
        } else if (i > 0) {
          edges.push_back({links[0].keyframe, links[i].keyframe,
                           links[0].T_keyframe_frame * links[i].T_keyframe_frame.inverse()});
        }
      }
    }
    return edges;
  }

  /// The connected parts of the keyframes become the segments.
  void locate_keyframes() {
    const std::vector<Edge> all = edges();
    for (SegmentPose& keyframe : selected_.keyframes) keyframe = {};
    int segments = 0;
    for (SegmentPose& first : selected_.keyframes) {
      if (first.segment >= 0) continue;
      first.segment = segments++;
      for (bool has_grown = true; has_grown;) {
        has_grown = false;
        for (const Edge& edge : all) {
          SegmentPose& from = selected_.keyframes[edge.from];
          SegmentPose& to = selected_.keyframes[edge.to];
          if ((from.segment < 0) == (to.segment < 0)) continue;
          has_grown = true;
          if (to.segment < 0) {
            to = {from.segment, from.T_segment_camera * edge.T_from_to};
          } else {
            from = {to.segment, to.T_segment_camera * edge.T_from_to.inverse()};
          }
        }
      }
    }
  }

  const std::vector<Keyframe>& keyframes_;
  const std::vector<FrameRecord>& records_;
  const CameraTrackerOptions& options_;
  std::vector<std::optional<Pose>> given_;  ///< by record
  SelectedLinks selected_;
};

}  // namespace

SelectedLinks select_links(const std::vector<Keyframe>& keyframes,
                           const std::vector<FrameRecord>& records, const Trajectory& given,
                           const CameraTrackerOptions& options) {
  return LinkSelection(keyframes, records, given, options).select();
}

}  // namespace pcavr::tracking
