// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_solver.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/LU>

#include "camera_anchor.hpp"
#include "camera_graph.hpp"

namespace pcavr::tracking {
namespace {

// Corner errors from one viewpoint are alike (blur, shading, print): more looks than these from
// where the camera stands still add nothing.
constexpr double kIndependentLooks = 8.0;

// A corner further off than this is counted as rejected; the loss has let it go by then.
constexpr double kRejectedCorner = 6.0;  // [sigma]

// Where the covariance could not be had: no claim is made.
constexpr NodeSigma kUnknown{HUGE_VAL, HUGE_VAL};

struct InSegment {
  int segment = -1;
  Pose T_segment_camera;
};

class TrackSolver {
 public:
  explicit TrackSolver(const SolverInput& input)
      : input_(input), graph_(std::max<std::size_t>(1, input.records->size())) {}

  CameraTrack solve() {
    locate();
    anchor();
    track_.is_fixed_camera = is_fixed();
    track_.is_fixed_camera ? build_fixed() : build_moving();
    graph_.solve();
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

  void locate();
  void anchor();
  [[nodiscard]] bool is_fixed() const;
  [[nodiscard]] bool is_anchored(std::size_t r) const;
  void build_fixed();
  void build_moving();
  void measure_tags(std::size_t r, std::size_t node, double looks);
  void measure_pose(std::size_t r, std::size_t node, double looks);
  void report_corners();
  void place_fixed();
  void place_moving();
  [[nodiscard]] std::vector<NodeSigma> node_sigmas() const;

  const SolverInput& input_;
  CameraTrack track_;
  PoseGraph graph_;
  std::vector<CornerFactor> corners_;
  std::vector<InSegment> located_;                 ///< by record
  std::map<int, Pose> T_base_segment_;             ///< of the anchored segments
  std::vector<std::optional<std::size_t>> nodes_;  ///< by record
  std::size_t node_count_ = 0;
};

/// Where each frame lies in its segment. A frame that stands alone, but sees base, is a segment.
void TrackSolver::locate() {
  located_.assign(records().size(), {});
  std::vector<int> members(keyframes().size(), 0);
  int next_segment = 0;
  for (const Keyframe& keyframe : keyframes()) {
    located_[keyframe.record] = {keyframe.segment, keyframe.T_segment_keyframe};
    next_segment = std::max(next_segment, keyframe.segment + 1);
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (located_[r].segment >= 0) continue;
    if (!records()[r].links.empty()) {
      const FrameLink& link = records()[r].links.front();
      const Keyframe& keyframe = keyframes()[link.keyframe];
      located_[r] = {keyframe.segment, keyframe.T_segment_keyframe * link.T_keyframe_frame};
    } else if (records()[r].base_from_tags.status == BodyPoseStatus::solved) {
      located_[r].segment = next_segment++;
    }
  }
}

void TrackSolver::anchor() {
  std::map<int, std::vector<AnchorSight>> sights;
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (located_[r].segment < 0) continue;
    sights[located_[r].segment].push_back({located_[r].T_segment_camera, &records()[r]});
  }
  for (const auto& [segment, seen] : sights) {
    const auto T_base_segment =
        anchor_segment(seen, *input_.base_tags, *input_.groundtruth, *input_.color_camera);
    if (T_base_segment) T_base_segment_[segment] = *T_base_segment;
  }
}

bool TrackSolver::is_anchored(std::size_t r) const {
  return located_[r].segment >= 0 && T_base_segment_.contains(located_[r].segment);
}

/// All frames of the one anchored segment stand where the first one stood.
bool TrackSolver::is_fixed() const {
  constexpr double kTypicalDepth = 1.0;  // [m]; turns an angle into a motion of what is seen
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
    if (motion > input_.options.fixed_camera_motion) return false;
    ++frames;
  }
  return frames > 1;
}

/// How much wider to take a measurement that is one of `looks` from the same place.
double inflation(double looks) { return std::sqrt(std::max(1.0, looks / kIndependentLooks)); }

/// Adds the base tags of frame `r` to a node.
void TrackSolver::measure_tags(std::size_t r, std::size_t node, double looks) {
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
      (void)input_.color_camera->distortion.distort(factor.rays[i], &factor.lens[i]);
    }
    factor.focal_length = input_.color_camera->fx;
    factor.sigma = input_.options.corner_sigma * inflation(looks);
    graph_.add_corners(factor);
    corners_.push_back(factor);
  }
}

/// Adds the pose that groundtruth gives for frame `r`, if it does, to a node.
void TrackSolver::measure_pose(std::size_t r, std::size_t node, double looks) {
  if (const auto given = input_.groundtruth->at(records()[r].stamp)) {
    graph_.add_prior(node, *given, input_.options.groundtruth_position_sigma * inflation(looks),
                     input_.options.groundtruth_rotation_sigma * inflation(looks));
  }
}

void TrackSolver::build_fixed() {
  double looks = 0.0;
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (is_anchored(r) && !records()[r].base_tags.empty()) looks += 1.0;
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (!is_anchored(r)) continue;
    if (node_count_ == 0) {
      node_count_ = 1 + graph_.add_node(T_base_segment_.at(located_[r].segment) *
                                        located_[r].T_segment_camera);
    }
    measure_tags(r, 0, looks);
    measure_pose(r, 0, static_cast<double>(records().size()));
  }
}

/// Keyframes and frames with a measurement of their own are nodes; all others hang on a keyframe.
void TrackSolver::build_moving() {
  nodes_.assign(records().size(), std::nullopt);
  std::vector<bool> is_keyframe(records().size(), false);
  for (const Keyframe& keyframe : keyframes()) is_keyframe[keyframe.record] = true;
  for (std::size_t r = 0; r < records().size(); ++r) {
    const FrameRecord& record = records()[r];
    const bool is_measured = !record.base_tags.empty() || record.links.size() > 1;
    if (!is_anchored(r) || !(is_keyframe[r] || is_measured)) continue;
    nodes_[r] =
        graph_.add_node(T_base_segment_.at(located_[r].segment) * located_[r].T_segment_camera);
    ++node_count_;
  }
  for (std::size_t r = 0; r < records().size(); ++r) {
    if (!nodes_[r]) continue;
    measure_tags(r, *nodes_[r], 1.0);
    // A given pose errs much like the ones before and after it: one a keyframe is enough.
    if (is_keyframe[r]) measure_pose(r, *nodes_[r], 1.0);
    for (const FrameLink& link : records()[r].links) {
      const auto keyframe = nodes_[keyframes()[link.keyframe].record];
      if (keyframe) {
        graph_.add_link(*keyframe, *nodes_[r], link.T_keyframe_frame, link.information);
      }
    }
  }
}

void TrackSolver::report_corners() {
  double squares = 0.0;
  for (const CornerFactor& factor : corners_) {
    for (const double error : graph_.corner_errors(factor)) {
      if (error > kRejectedCorner * input_.options.corner_sigma) {
        ++track_.tag_corners_rejected;
      } else {
        ++track_.tag_corners_used;
        squares += error * error;
      }
    }
  }
  if (track_.tag_corners_used > 0) {
    track_.tag_reprojection_rms = std::sqrt(squares / track_.tag_corners_used);
  }
}

FramePlacement placement_of(const FrameRecord& record) {
  FramePlacement placement;
  placement.frame = record.index;
  placement.stamp = record.stamp;
  placement.base_tags = static_cast<int>(record.base_tags.size());
  return placement;
}

void TrackSolver::place_fixed() {
  const NodeSigma sigma = graph_.sigmas({0}).front().value_or(kUnknown);
  for (std::size_t r = 0; r < records().size(); ++r) {
    FramePlacement placement = placement_of(records()[r]);
    if (is_anchored(r)) {
      placement.status = PlacementStatus::placed;
      placement.T_base_camera = graph_.pose(0);
      placement.position_sigma = sigma.position;
      placement.rotation_sigma = sigma.rotation;
    }
    track_.frames.push_back(placement);
  }
}

/// By node. Inverting the whole information matrix would take time with the square of the frames:
/// of many nodes some are looked at, and the ones between take the larger of their neighbours'.
std::vector<NodeSigma> TrackSolver::node_sigmas() const {
  constexpr std::size_t kMaxNodes = 200;
  const std::size_t stride = (node_count_ + kMaxNodes - 1) / kMaxNodes;
  std::vector<std::size_t> chosen;
  for (std::size_t node = 0; node < node_count_; node += std::max<std::size_t>(1, stride)) {
    chosen.push_back(node);
  }
  if (node_count_ > 0 && chosen.back() + 1 != node_count_) chosen.push_back(node_count_ - 1);
  const std::vector<std::optional<NodeSigma>> found = graph_.sigmas(chosen);
  std::vector<NodeSigma> sigmas(node_count_);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const NodeSigma sigma = found[i].value_or(kUnknown);
    const NodeSigma before = i > 0 ? found[i - 1].value_or(kUnknown) : sigma;
    for (std::size_t node = i > 0 ? chosen[i - 1] + 1 : 0; node < chosen[i]; ++node) {
      sigmas[node] = {std::max(before.position, sigma.position),
                      std::max(before.rotation, sigma.rotation)};
    }
    sigmas[chosen[i]] = sigma;
  }
  return sigmas;
}

/// Where a frame hangs on a keyframe, its errors add to the keyframe's.
NodeSigma hanging(const NodeSigma& keyframe, const FrameLink& link) {
  const Matrix6d covariance = link.information.inverse();
  return {
      std::sqrt(keyframe.position * keyframe.position + covariance.topLeftCorner<3, 3>().trace()),
      std::sqrt(keyframe.rotation * keyframe.rotation +
                covariance.bottomRightCorner<3, 3>().trace())};
}

void TrackSolver::place_moving() {
  const std::vector<NodeSigma> sigmas = node_sigmas();
  for (std::size_t r = 0; r < records().size(); ++r) {
    FramePlacement placement = placement_of(records()[r]);
    if (located_[r].segment >= 0) placement.status = PlacementStatus::not_anchored;
    if (is_anchored(r)) {
      placement.status = PlacementStatus::placed;
      NodeSigma sigma;
      if (nodes_[r]) {
        placement.T_base_camera = graph_.pose(*nodes_[r]);
        sigma = sigmas[*nodes_[r]];
      } else {
        const FrameLink& link = records()[r].links.front();
        const std::size_t node = *nodes_[keyframes()[link.keyframe].record];
        placement.T_base_camera = graph_.pose(node) * link.T_keyframe_frame;
        sigma = hanging(sigmas[node], link);
      }
      placement.position_sigma = sigma.position;
      placement.rotation_sigma = sigma.rotation;
    }
    track_.frames.push_back(placement);
  }
}

}  // namespace

CameraTrack solve_track(const SolverInput& input) { return TrackSolver(input).solve(); }

}  // namespace pcavr::tracking
