// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/rosbag/transform_tree.hpp"

#include <algorithm>
#include <iterator>
#include <set>

namespace pcavr {
namespace {

/// Below what a joint's encoder resolves; republished numbers are the same to rounding.
constexpr double kFixedTolerance = 1e-7;  // [m], [rad]
constexpr Duration kMaxTransformGap = std::chrono::milliseconds(500);
constexpr std::size_t kMaxLiveFrames = 1000;  // of a live source, which may send any names

bool is_same_pose(const Pose& a, const Pose& b) {
  return translation_distance(a, b) < kFixedTolerance &&
         rotation_distance(a, b) < 10 * kFixedTolerance;
}

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child, Stamp stamp,
                        const Pose& T_parent_child) {
  if (history_ && edges_.size() >= kMaxLiveFrames && !edges_.contains(child)) return;
  const auto [entry, is_new] = edges_.try_emplace(child);
  Edge& edge = entry->second;
  if (is_new) edge.parent = parent;
  if (edge.parent != parent) {
    if (std::find(reparented_.begin(), reparented_.end(), child) == reparented_.end()) {
      reparented_.push_back(child);
    }
    return;
  }
  if (history_) return add_live(edge, stamp, T_parent_child);
  std::vector<TimedPose>& samples = edge.samples;
  if (!samples.empty()) {
    edge.is_fixed = edge.is_fixed && is_same_pose(samples.front().pose, T_parent_child);
  }
  // A link at rest needs no more than the ends of the rest.
  const std::size_t n = samples.size();
  const bool is_rest = n >= 2 && stamp > samples[n - 1].stamp &&
                       samples[n - 1].stamp > samples[n - 2].stamp &&
                       stamp - samples[n - 2].stamp < kMaxTransformGap &&
                       is_same_pose(samples[n - 2].pose, T_parent_child) &&
                       is_same_pose(samples[n - 1].pose, T_parent_child);
  if (is_rest) samples.pop_back();
  samples.push_back({stamp, T_parent_child});
}

void TransformTree::add_live(Edge& edge, Stamp stamp, const Pose& T_parent_child) const {
  const std::vector<TimedPose>& kept = edge.T_parent_child.poses();
  if (!kept.empty() && stamp <= kept.back().stamp) {
    if (kept.back().stamp - stamp < *history_) return;
    edge.T_parent_child = Trajectory();  // the sender's clock was set back
  }
  if (kept.empty()) return edge.T_parent_child.append(stamp, T_parent_child);
  edge.is_fixed = edge.is_fixed && is_same_pose(kept.front().pose, T_parent_child);
  if (edge.is_fixed) {  // how long it has been so does not matter
    edge.T_parent_child = Trajectory({{stamp, kept.front().pose}});
    return;
  }
  edge.T_parent_child.append(stamp, T_parent_child);
  if (stamp - kept.front().stamp < 2 * *history_) return;
  const auto first = std::find_if(kept.begin(), kept.end(), [&](const TimedPose& sample) {
    return stamp - sample.stamp <= *history_;
  });
  edge.T_parent_child = Trajectory({first, kept.end()});
}

void TransformTree::finish() {
  for (auto& [child, edge] : edges_) {
    std::stable_sort(edge.samples.begin(), edge.samples.end(),
                     [](const TimedPose& a, const TimedPose& b) { return a.stamp < b.stamp; });
    for (const TimedPose& sample : edge.samples) {
      const std::vector<TimedPose>& kept = edge.T_parent_child.poses();
      if (kept.empty() || kept.back().stamp < sample.stamp) {
        edge.T_parent_child.append(sample.stamp, sample.pose);
      }
    }
    edge.samples = {};
  }
}

std::vector<std::string> TransformTree::ancestors(const std::string& frame) const {
  std::vector<std::string> found{frame};
  std::set<std::string> seen{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(found.back())) {
    if (!seen.insert(edge->second.parent).second) break;  // a loop
    found.push_back(edge->second.parent);
  }
  return found;
}

std::optional<std::vector<TransformTree::Link>> TransformTree::chain(
    const std::string& base, const std::string& frame) const {
  const std::vector<std::string> up = ancestors(base);
  const std::vector<std::string> down = ancestors(frame);
  const auto common = std::find_first_of(up.begin(), up.end(), down.begin(), down.end());
  if (common == up.end()) return std::nullopt;
  std::vector<Link> links;
  const auto link_of = [&](const std::string& child, bool is_upward) {
    const Edge& edge = edges_.at(child);
    links.push_back({edge.parent, child, is_upward, edge.is_fixed});
  };
  for (auto at = up.begin(); at != common; ++at) link_of(*at, true);
  const auto top = std::find(down.begin(), down.end(), *common);
  for (auto at = std::make_reverse_iterator(top); at != down.rend(); ++at) link_of(*at, false);
  return links;
}

std::optional<Pose> TransformTree::lookup(const std::vector<Link>& links, Stamp stamp) const {
  Pose T_base_frame;
  for (const Link& link : links) {
    const Edge& edge = edges_.at(link.child);
    const std::vector<TimedPose>& samples = edge.T_parent_child.poses();
    const bool is_newest =
        history_ && stamp > samples.back().stamp && stamp - samples.back().stamp < kMaxTransformGap;
    const std::optional<Pose> T_parent_child =
        edge.is_fixed ? samples.front().pose
        : is_newest   ? samples.back().pose
                      : edge.T_parent_child.at(stamp, kMaxTransformGap);
    if (!T_parent_child) return std::nullopt;
    T_base_frame = T_base_frame * (link.is_upward ? T_parent_child->inverse() : *T_parent_child);
  }
  return T_base_frame;
}

std::vector<Stamp> TransformTree::stamps(const std::vector<Link>& links) const {
  std::vector<Stamp> stamps;
  for (const Link& link : links) {
    if (link.is_fixed) continue;
    for (const TimedPose& sample : edges_.at(link.child).T_parent_child.poses()) {
      stamps.push_back(sample.stamp);
    }
  }
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

std::string chain_text(const std::string& base, const std::vector<TransformTree::Link>& links) {
  std::string text = base;
  for (const TransformTree::Link& link : links) {
    text +=
        " -> " + (link.is_upward ? link.parent : link.child) + (link.is_fixed ? " (fixed)" : "");
  }
  return text;
}

}  // namespace pcavr
