// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/transform_tree.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>
#include <utility>

namespace pcavr {
namespace {

/// Below what a joint's encoder resolves; republished numbers are the same to rounding.
constexpr double kFixedTolerance = 1e-7;  // [m], [rad]
constexpr Duration kMaxTransformGap = std::chrono::milliseconds(500);
constexpr std::size_t kMaxLiveFrames = 1000;  // of a live source, which may send any names
constexpr Stamp kEnd{std::numeric_limits<std::int64_t>::max()};

bool is_same_pose(const Pose& a, const Pose& b) {
  return translation_distance(a, b) < kFixedTolerance &&
         rotation_distance(a, b) < 10 * kFixedTolerance;
}

const std::string& base_of(const std::vector<TransformTree::Link>& links) {
  return links.front().is_upward ? links.front().child : links.front().parent;
}
const std::string& frame_of(const std::vector<TransformTree::Link>& links) {
  return links.back().is_upward ? links.back().parent : links.back().child;
}

/// Orders the values by time. Keeps the last added of one time, and none that repeats the one
/// before.
void order(std::vector<TransformTree::StaticValue>& values) {
  std::stable_sort(values.begin(), values.end(),
                   [](const auto& a, const auto& b) { return a.since < b.since; });
  std::vector<TransformTree::StaticValue> kept;
  for (TransformTree::StaticValue& value : values) {
    if (!kept.empty() && kept.back().since == value.since) kept.pop_back();
    const bool is_repeated = !kept.empty() && kept.back().parent == value.parent &&
                             is_same_pose(kept.back().T_parent_child, value.T_parent_child);
    if (!is_repeated) kept.push_back(std::move(value));
  }
  values = std::move(kept);
}

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child, Stamp stamp,
                        const Pose& T_parent_child) {
  if (history_ && edges_.size() >= kMaxLiveFrames && !edges_.contains(child)) return;
  Edge& edge = edges_[child];
  if (!edge.has_samples()) edge.parent = parent;
  if (edge.parent != parent) {
    if (std::find(reparented_.begin(), reparented_.end(), child) == reparented_.end()) {
      reparented_.push_back(child);
    }
    return;
  }
  if (history_) {
    edge.static_values.clear();
    return add_live(edge, stamp, T_parent_child);
  }
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

void TransformTree::add_static(const std::string& parent, const std::string& child, Stamp since,
                               const Pose& T_parent_child) {
  if (history_ && edges_.size() >= kMaxLiveFrames && !edges_.contains(child)) return;
  Edge& edge = edges_[child];
  std::vector<StaticValue>& values = edge.static_values;
  if (history_ && edge.has_samples()) return;
  if (history_) values.clear();
  // Publishers repeat them.
  const bool is_repeated = !values.empty() && values.back().since <= since &&
                           values.back().parent == parent &&
                           is_same_pose(values.back().T_parent_child, T_parent_child);
  if (!is_repeated) values.push_back({since, parent, T_parent_child});
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
    if (edge.has_samples()) {  // then it is not static
      for (const StaticValue& value : std::exchange(edge.static_values, {})) {
        add(value.parent, child, value.since, value.T_parent_child);
      }
    }
    order(edge.static_values);
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

const TransformTree::StaticValue& TransformTree::value_at(const Edge& edge, Stamp stamp) {
  const std::vector<StaticValue>& values = edge.static_values;
  const auto after =
      std::upper_bound(values.begin(), values.end(), stamp,
                       [](Stamp t, const StaticValue& value) { return t < value.since; });
  return after == values.begin() ? values.front() : *std::prev(after);
}

const std::string& TransformTree::parent_at(const Edge& edge, Stamp stamp) {
  return edge.static_values.empty() ? edge.parent : value_at(edge, stamp).parent;
}

std::vector<std::string> TransformTree::ancestors(const std::string& frame, Stamp stamp) const {
  std::vector<std::string> found{frame};
  std::set<std::string> seen{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(found.back())) {
    const std::string& parent = parent_at(edge->second, stamp);
    if (!seen.insert(parent).second) break;  // a loop
    found.push_back(parent);
  }
  return found;
}

std::optional<std::vector<TransformTree::Link>> TransformTree::chain(
    const std::string& base, const std::string& frame) const {
  return chain_at(base, frame, kEnd);
}

std::optional<std::vector<TransformTree::Link>> TransformTree::chain_at(const std::string& base,
                                                                        const std::string& frame,
                                                                        Stamp stamp) const {
  const std::vector<std::string> up = ancestors(base, stamp);
  const std::vector<std::string> down = ancestors(frame, stamp);
  const auto common = std::find_first_of(up.begin(), up.end(), down.begin(), down.end());
  if (common == up.end()) return std::nullopt;
  std::vector<Link> links;
  const auto link_of = [&](const std::string& child, bool is_upward) {
    const Edge& edge = edges_.at(child);
    const bool is_fixed = edge.is_fixed || !edge.static_values.empty();
    links.push_back({parent_at(edge, stamp), child, is_upward, is_fixed});
  };
  for (auto at = up.begin(); at != common; ++at) link_of(*at, true);
  const auto top = std::find(down.begin(), down.end(), *common);
  for (auto at = std::make_reverse_iterator(top); at != down.rend(); ++at) link_of(*at, false);
  return links;
}

std::optional<Pose> TransformTree::lookup(const Edge& edge, Stamp stamp) const {
  if (!edge.static_values.empty()) return value_at(edge, stamp).T_parent_child;
  const std::vector<TimedPose>& samples = edge.T_parent_child.poses();
  if (edge.is_fixed) return samples.front().pose;
  const bool is_newest =
      history_ && stamp > samples.back().stamp && stamp - samples.back().stamp < kMaxTransformGap;
  if (is_newest) return samples.back().pose;
  return edge.T_parent_child.at(stamp, kMaxTransformGap);
}

std::optional<Pose> TransformTree::lookup(const std::vector<Link>& links, Stamp stamp) const {
  Pose T_base_frame;
  for (const Link& link : links) {
    const Edge& edge = edges_.at(link.child);
    if (parent_at(edge, stamp) != link.parent) {  // it was replaced later
      const auto then = chain_at(base_of(links), frame_of(links), stamp);
      return then ? lookup(*then, stamp) : std::nullopt;
    }
    const std::optional<Pose> T_parent_child = lookup(edge, stamp);
    if (!T_parent_child) return std::nullopt;
    T_base_frame = T_base_frame * (link.is_upward ? T_parent_child->inverse() : *T_parent_child);
  }
  return T_base_frame;
}

std::vector<Stamp> TransformTree::stamps(const std::vector<Link>& links) const {
  std::set<std::string> moving;
  const auto add_moving = [&](const std::vector<Link>& chain) {
    for (const Link& link : chain) {
      if (!link.is_fixed) moving.insert(link.child);
    }
  };
  add_moving(links);
  for (const auto& [child, values] : replaced()) {
    for (const StaticValue& value : values) {
      const auto then =
          links.empty() ? std::nullopt : chain_at(base_of(links), frame_of(links), value.since);
      if (then) add_moving(*then);
    }
  }
  std::vector<Stamp> stamps;
  for (const std::string& child : moving) {
    for (const TimedPose& sample : edges_.at(child).T_parent_child.poses()) {
      stamps.push_back(sample.stamp);
    }
  }
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  return stamps;
}

std::map<std::string, std::vector<TransformTree::StaticValue>> TransformTree::replaced() const {
  std::map<std::string, std::vector<StaticValue>> found;
  for (const auto& [child, edge] : edges_) {
    if (edge.static_values.size() > 1) found.emplace(child, edge.static_values);
  }
  return found;
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
