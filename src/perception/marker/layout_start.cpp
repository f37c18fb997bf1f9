// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/layout_start.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "pcavr/perception/marker/tag_pair.hpp"

namespace pcavr {
namespace {

/// A tag whose place is roughly known is not left out yet [px].
constexpr double kMaxStartResidual = 30.0;

const TagDetection* find_detection(const std::vector<TagDetection>& frame, const MarkerId& id) {
  const auto found = std::find_if(frame.begin(), frame.end(),
                                  [&](const TagDetection& one) { return one.id == id; });
  return found == frame.end() ? nullptr : &*found;
}

using Counts = std::vector<std::vector<std::size_t>>;

/// By pair of tags: the number of frames that show both; on the diagonal, that show the tag.
Counts count_pairs(const LayoutInput& input) {
  const std::size_t n = input.tags.size();
  Counts counts(n, std::vector<std::size_t>(n, 0));
  for (const std::vector<TagDetection>& frame : input.frames) {
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < n; ++i) {
      if (find_detection(frame, input.tags[i].id) != nullptr) seen.push_back(i);
    }
    for (const std::size_t i : seen) {
      for (const std::size_t j : seen) ++counts[i][j];
    }
  }
  return counts;
}

std::optional<Pose> pose_in(const LayoutInput& input, std::size_t first, std::size_t second) {
  const LayoutTag& a = input.tags[first];
  const LayoutTag& b = input.tags[second];
  std::vector<TagPairView> views;
  for (const std::vector<TagDetection>& frame : input.frames) {
    const TagDetection* one = find_detection(frame, a.id);
    const TagDetection* other = find_detection(frame, b.id);
    if (one != nullptr && other != nullptr) views.push_back({*one, *other});
  }
  const Pose T_stated =
      a.T_body_tag && b.T_body_tag ? a.T_body_tag->inverse() * *b.T_body_tag : Pose();
  const auto pair = solve_tag_pair(views, a.size, b.size, T_stated, input.camera, input.options);
  if (!pair) return std::nullopt;
  return pair->T_first_second;
}

}  // namespace

LayoutStart start_layout(const LayoutInput& input) {
  Counts counts = count_pairs(input);
  const std::size_t n = input.tags.size();
  std::size_t datum = 0;
  const auto partners = [&](std::size_t tag) {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += i == tag ? 0 : counts[tag][i];
    return sum;
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (partners(i) > partners(datum)) datum = i;
  }
  LayoutStart start{{datum}, {Pose()}};
  std::vector<bool> is_placed(n, false);
  is_placed[datum] = true;
  while (true) {
    std::size_t from = 0, to = 0, most = 0;  // position in start.tags, tag, frames
    for (std::size_t p = 0; p < start.tags.size(); ++p) {
      for (std::size_t i = 0; i < n; ++i) {
        if (is_placed[i] || counts[start.tags[p]][i] <= most) continue;
        from = p;
        to = i;
        most = counts[start.tags[p]][i];
      }
    }
    if (most == 0) return start;
    counts[start.tags[from]][to] = 0;  // tried
    const std::optional<Pose> T_from_to = pose_in(input, start.tags[from], to);
    if (!T_from_to) continue;
    is_placed[to] = true;
    start.T_datum_tag.push_back(start.T_datum_tag[from] * *T_from_to);
    start.tags.push_back(to);
  }
}

LayoutProblem place_cameras(const LayoutInput& input, const LayoutStart& start) {
  LayoutProblem problem{.camera = input.camera};
  std::vector<TagPlacement> placements;
  for (std::size_t i = 0; i < start.tags.size(); ++i) {
    const LayoutTag& tag = input.tags[start.tags[i]];
    placements.push_back({tag.id, tag.size, start.T_datum_tag[i]});
    problem.sizes.push_back(tag.size);
    problem.T_layout_tag.push_back(start.T_datum_tag[i]);
  }
  BodyPoseOptions rough = input.options;
  rough.max_tag_residual = kMaxStartResidual;
  for (std::size_t frame = 0; frame < input.frames.size(); ++frame) {
    LayoutView view{.frame = frame};
    for (std::size_t i = 0; i < placements.size(); ++i) {
      const TagDetection* detection = find_detection(input.frames[frame], placements[i].id);
      if (detection == nullptr) continue;
      const double own =
          detection->corner_std > 0.0 ? detection->corner_std : input.options.corner_std;
      view.seen.push_back({i, detection->corners, std::hypot(own, input.options.model_std)});
    }
    if (view.seen.size() < 2) continue;
    const BodyPose pose = solve_body_pose(placements, input.frames[frame], input.camera, {}, rough);
    if (pose.status != BodyPoseStatus::solved) continue;
    view.T_camera_layout = pose.pose.T_camera_body;
    problem.views.push_back(std::move(view));
  }
  return problem;
}

}  // namespace pcavr
