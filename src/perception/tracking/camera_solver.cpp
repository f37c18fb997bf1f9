// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_solver.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "pcavr/base/core/solvers.hpp"

#include "camera_anchor.hpp"
#include "camera_graph.hpp"
#include "camera_links.hpp"

namespace pcavr::tracking {
namespace {

// Corner errors from one viewpoint are correlated (blur, shading, print): more observations than
// these from one place add no information.
constexpr double kMaxIndependentObservations = 8.0;

// Stds if the covariance could not be computed.
constexpr NodeStd kUnknownStd{HUGE_VAL, HUGE_VAL};

/// A pose that is less certain than this is none [m, rad]: a room's width, and a quarter of the
/// view.
constexpr double kMaxPositionStd = 0.5;
constexpr double kMaxRotationStd = 0.35;

/// Share of the tags' corners that may be wrong, and their rms error in stds, for all frames to be
/// from one place: a camera that moves unnoticed is off by the corners' noise at most.
constexpr double kMaxRejectedShare = 0.05;
constexpr double kMaxCornerStds = 2.0;

class TrackSolver {
 public:
  /// `at_one_place`: all frames are taken as from one place, whatever they show.
  TrackSolver(const SolverInput& input, bool at_one_place)
      : input_(input),
        at_one_place_(at_one_place),
        selected_(
            select_links(*input.keyframes, *input.records, *input.groundtruth, input.options)),
        graph_(std::max<std::size_t>(1, input.records->size())) {}

  CameraTrack solve() {
    locate_in_segments();
    anchor_segments();
    track_.is_fixed_camera = is_fixed();
    track_.is_fixed_camera ? build_fixed() : build_moving();
    graph_.solve();
    // Given poses that are worse than stated make the track less certain, not less smooth.
    if (!track_.is_fixed_camera) graph_.scale_priors(graph_.prior_scatter(T_base_segment_.size()));
    track_.links_rejected = selected_.rejected;
    report_corners();
    track_.is_fixed_camera ? place_fixed() : place_moving();
    for (std::size_t r = 0; r < records().size(); ++r) {
      track_.frames[r].segment = located_[r].segment;
      track_.frames[r].T_segment_camera = located_[r].T_segment_camera;
    }
    return std::move(track_);
  }

 private:
  const std::vector<FrameRecord>& records() const { return *input_.records; }
  const std::vector<Keyframe>& keyframes() const { return *input_.keyframes; }
  const std::vector<FrameLink>& links(std::size_t r) const { return selected_.links[r]; }
  /// Whether nothing but its given pose places the frame, because its links contradict that.
  [[nodiscard]] bool is_by_given_pose_alone(std::size_t r) const {
    return links(r).empty() && !records()[r].links.empty();
  }

  void locate_in_segments();
  void anchor_segments();
  [[nodiscard]] bool is_fixed() const;
  [[nodiscard]] bool is_anchored(std::size_t r) const;
  void build_fixed();
  void build_moving();
  void add_tag_corners(std::size_t r, std::size_t node, double observations);
  void add_pose_prior(std::size_t r, std::size_t node, double observations);
  void report_corners();
  void place_fixed();
  void place_moving();
  [[nodiscard]] std::vector<NodeStd> node_stds() const;

  const SolverInput& input_;
  bool at_one_place_;
  SelectedLinks selected_;
  CameraTrack track_;
  PoseGraph graph_;
  std::vector<CornerFactor> corners_;
  std::vector<SegmentPose> located_;               ///< by record
  std::map<int, Pose> T_base_segment_;             ///< of the anchored segments
  std::vector<std::optional<std::size_t>> nodes_;  ///< by record
  std::size_t node_count_ = 0;
};

/// Sets each frame's pose in its segment. An unlinked frame that shows base is its own segment.
void TrackSolver::locate_in_segments() {
  located_.assign(records().size(), {});
  std::vector<int> members(keyframes().size(), 0);
  int next_segment = 0;
  for (std::size_t k = 0; k < keyframes().size(); ++k) {
    located_[keyframes()[k].record] = selected_.keyframes[k];
    next_segment = std::max(next_segment, selected_.keyframes[k].segment + 1);
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (at_one_place_) located_[r].segment = 0;
    if (located_[r].segment >= 0) continue;
    if (!links(r).empty()) {
      const FrameLink& link = links(r).front();
      const SegmentPose& keyframe = selected_.keyframes[link.keyframe];
      located_[r] = {keyframe.segment, keyframe.T_segment_camera * link.T_keyframe_frame};
    } else if (is_by_given_pose_alone(r) ||
               records()[r].base_from_tags.status == BodyPoseStatus::solved) {
      located_[r].segment = next_segment++;
    }
  }
}

void TrackSolver::anchor_segments() {
  std::map<int, std::vector<AnchorObservation>> observations;
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (located_[r].segment < 0) continue;
    observations[located_[r].segment].push_back({located_[r].T_segment_camera, &records()[r]});
  }
  for (const auto& [segment, of_segment] : observations) {
    const auto T_base_segment =
        anchor_segment(of_segment, *input_.base_tags, *input_.groundtruth, *input_.color_camera);
    if (T_base_segment) T_base_segment_[segment] = *T_base_segment;
  }
}

bool TrackSolver::is_anchored(std::size_t r) const {
  return located_[r].segment >= 0 && T_base_segment_.contains(located_[r].segment);
}

/// Whether there is one anchored segment and no frame of it moved relative to the first.
bool TrackSolver::is_fixed() const {
  constexpr double kTypicalDepth = 1.0;  // [m]; converts an angle to a displacement of the scene
  std::optional<std::size_t> first;
  int frames = 0;
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (!is_anchored(r)) continue;
    if (!first) first = r;
    if (located_[r].segment != located_[*first].segment) return false;
    const Pose T_first_frame =
        located_[*first].T_segment_camera.inverse() * located_[r].T_segment_camera;
    const double motion = T_first_frame.translation().norm() +
                          kTypicalDepth * rotation_distance(Pose(), T_first_frame);
    if (motion > input_.options.max_fixed_camera_motion) return false;
    ++frames;
  }
  return frames > 1;
}

/// Factor on the standard deviation of a measurement that is one of `observations` from the same
/// place.
double std_inflation(double observations) {
  return std::sqrt(std::max(1.0, observations / kMaxIndependentObservations));
}

/// Adds the base tags of frame `r` to a node.
void TrackSolver::add_tag_corners(std::size_t r, std::size_t node, double observations) {
  const FrameRecord& record = records()[r];
  for (const TagDetection& tag : record.base_tags) {
    const auto p_base = corners_in_base(*input_.base_tags, tag.id);
    if (!p_base) continue;
    CornerFactor factor;
    factor.node = node;
    factor.T_node_color = record.T_depth_color;
    factor.p_base = *p_base;
    for (std::size_t i = 0; i < 4; ++i) {
      factor.rays[i] = input_.color_camera->normalise(tag.corners[i]);
      (void)input_.color_camera->distortion.distort(factor.rays[i], &factor.lens_jacobians[i]);
    }
    factor.focal_length = input_.color_camera->fx;
    factor.corner_std = input_.options.body_pose.corner_std * std_inflation(observations);
    graph_.add_corners(factor);
    corners_.push_back(factor);
  }
}

/// Adds the groundtruth pose of frame `r`, if there is one, to a node.
void TrackSolver::add_pose_prior(std::size_t r, std::size_t node, double observations) {
  if (const auto given = input_.groundtruth->at(records()[r].stamp)) {
    graph_.add_prior(node, *given,
                     input_.options.groundtruth_position_std * std_inflation(observations),
                     input_.options.groundtruth_rotation_std * std_inflation(observations));
  }
}

void TrackSolver::build_fixed() {
  double observations = 0.0;
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (is_anchored(r) && !records()[r].base_tags.empty()) observations += 1.0;
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (!is_anchored(r)) continue;
    if (node_count_ == 0) {
      node_count_ = 1 + graph_.add_node(T_base_segment_.at(located_[r].segment) *
                                        located_[r].T_segment_camera);
    }
    add_tag_corners(r, 0, observations);
    add_pose_prior(r, 0, static_cast<double>(records().size()));
  }
}

/// Keyframes and frames with tags or several links are nodes; the others are relative to a
/// keyframe.
void TrackSolver::build_moving() {
  nodes_.assign(records().size(), std::nullopt);
  std::vector<bool> is_keyframe(records().size(), false);
  for (const Keyframe& keyframe : keyframes()) is_keyframe[keyframe.record] = true;
  for (std::size_t r = 0; r < records().size(); ++r) {
    const FrameRecord& record = records()[r];
    const bool is_measured =
        !record.base_tags.empty() || links(r).size() > 1 || is_by_given_pose_alone(r);
    if (!is_anchored(r) || !(is_keyframe[r] || is_measured)) continue;
    nodes_[r] =
        graph_.add_node(T_base_segment_.at(located_[r].segment) * located_[r].T_segment_camera);
    ++node_count_;
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (!nodes_[r]) continue;
    add_tag_corners(r, *nodes_[r], 1.0);
    // Errors of consecutive given poses are correlated: one per keyframe is enough.
    if (is_keyframe[r] || is_by_given_pose_alone(r)) add_pose_prior(r, *nodes_[r], 1.0);
    for (const FrameLink& link : links(r)) {
      const auto keyframe = nodes_[keyframes()[link.keyframe].record];
      if (keyframe) {
        graph_.add_link(*keyframe, *nodes_[r], link.T_keyframe_frame, link.information);
      }
    }
  }
}

void TrackSolver::report_corners() {
  double sum_squares = 0.0;
  for (const CornerFactor& factor : corners_) {
    for (const double error : graph_.corner_errors(factor)) {
      if (error > input_.options.corner_rejection_threshold * input_.options.body_pose.corner_std) {
        ++track_.tag_corners_rejected;
      } else {
        ++track_.tag_corners_used;
        sum_squares += error * error;
      }
    }
  }
  if (track_.tag_corners_used > 0) {
    track_.tag_reprojection_rms = std::sqrt(sum_squares / track_.tag_corners_used);
  }
}

FramePlacement placement_of(const FrameRecord& record) {
  FramePlacement placement;
  placement.frame = record.index;
  placement.stamp = record.stamp;
  placement.base_tags = static_cast<int>(record.base_tags.size());
  return placement;
}

/// Infinite stds, which could not be computed, say nothing.
bool is_undetermined(const NodeStd& std_dev) {
  return (std::isfinite(std_dev.position) && std_dev.position > kMaxPositionStd) ||
         (std::isfinite(std_dev.rotation) && std_dev.rotation > kMaxRotationStd);
}

void TrackSolver::place_fixed() {
  const NodeStd std_dev = graph_.node_stds({0}).front().value_or(kUnknownStd);
  for (std::size_t r = 0; r < records().size(); ++r) {
    FramePlacement placement = placement_of(records()[r]);
    if (is_anchored(r)) {
      placement.status = PlacementStatus::placed;
      placement.T_base_camera = graph_.pose(0);
      placement.position_std = std_dev.position;
      placement.rotation_std = std_dev.rotation;
      if (is_undetermined(std_dev)) placement.status = PlacementStatus::not_anchored;
    }
    track_.frames.push_back(placement);
  }
}

/// The stds by node. Inverting the whole information matrix takes time quadratic in the frames: of
/// many nodes only some are computed, and the ones between get the larger value of their
/// neighbours.
std::vector<NodeStd> TrackSolver::node_stds() const {
  constexpr std::size_t kMaxNodes = 200;  // bounds the time, see above
  const std::size_t stride = (node_count_ + kMaxNodes - 1) / kMaxNodes;
  std::vector<std::size_t> chosen;
  for (std::size_t node = 0; node < node_count_; node += std::max<std::size_t>(1, stride)) {
    chosen.push_back(node);
  }
  if (node_count_ > 0 && chosen.back() + 1 != node_count_) chosen.push_back(node_count_ - 1);
  const std::vector<std::optional<NodeStd>> found = graph_.node_stds(chosen);
  std::vector<NodeStd> stds(node_count_);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const NodeStd current = found[i].value_or(kUnknownStd);
    const NodeStd before = i > 0 ? found[i - 1].value_or(kUnknownStd) : current;
    for (std::size_t node = i > 0 ? chosen[i - 1] + 1 : 0; node < chosen[i]; ++node) {
      stds[node] = {std::max(before.position, current.position),
                    std::max(before.rotation, current.rotation)};
    }
    stds[chosen[i]] = current;
  }
  return stds;
}

/// Error propagation to a frame relative to a keyframe: the link's covariance adds.
NodeStd propagate_std(const NodeStd& keyframe, const FrameLink& link) {
  const Matrix6d covariance = link.information.inverse();
  return {
      std::sqrt(keyframe.position * keyframe.position + covariance.topLeftCorner<3, 3>().trace()),
      std::sqrt(keyframe.rotation * keyframe.rotation +
                covariance.bottomRightCorner<3, 3>().trace())};
}

void TrackSolver::place_moving() {
  const std::vector<NodeStd> stds = node_stds();
  for (std::size_t r = 0; r < records().size(); ++r) {
    FramePlacement placement = placement_of(records()[r]);
    if (located_[r].segment >= 0) placement.status = PlacementStatus::not_anchored;
    if (is_anchored(r)) {
      placement.status = PlacementStatus::placed;
      NodeStd std_dev;
      if (nodes_[r]) {
        placement.T_base_camera = graph_.pose(*nodes_[r]);
        std_dev = stds[*nodes_[r]];
      } else {
        const FrameLink& link = links(r).front();
        const std::size_t node = *nodes_[keyframes()[link.keyframe].record];
        placement.T_base_camera = graph_.pose(node) * link.T_keyframe_frame;
        std_dev = propagate_std(stds[node], link);
      }
      placement.position_std = std_dev.position;
      placement.rotation_std = std_dev.rotation;
      if (is_undetermined(std_dev)) placement.status = PlacementStatus::not_anchored;
    }
    track_.frames.push_back(placement);
  }
}

}  // namespace

CameraTrack solve_track(const SolverInput& input) {
  if (input.keyframes->empty()) {
    // Only the tags show whether the camera moves if there are no surfaces.
    CameraTrack track = TrackSolver(input, true).solve();
    const double rejected = track.tag_corners_rejected;
    const double corners = rejected + track.tag_corners_used;
    const double max_rms = kMaxCornerStds * input.options.body_pose.corner_std;
    const bool is_at_one_place = track.is_fixed_camera && track.tag_corners_used > 0 &&
                                 rejected <= kMaxRejectedShare * corners &&
                                 track.tag_reprojection_rms <= max_rms;
    if (is_at_one_place) return track;
  }
  return TrackSolver(input, false).solve();
}

}  // namespace pcavr::tracking
