// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/core/stamp.hpp"
#include "pcavr/geometry/pose.hpp"
#include "pcavr/geometry/trajectory.hpp"

namespace pcavr {

/// The frames of a bag and the transforms between them over time [ROS tf2]. Each frame has one
/// parent. A link that never changes holds at all times, whatever its stamps are (publishers of
/// fixed links stamp them in the future); others are interpolated between their samples.
class TransformTree {
 public:
  /// All samples are kept.
  TransformTree() = default;
  /// Of a live source: each sample is in force at once, in ascending order of stamps, and finish()
  /// is not needed. Keeps at least `history` of each link, and a bounded number of frames.
  explicit TransformTree(Duration history) : history_(history) {}

  /// Adds a sample, in any order of stamps. A child's second parent is ignored.
  void add(const std::string& parent, const std::string& child, Stamp stamp,
           const Pose& T_parent_child);
  /// Call once after the last add().
  void finish();

  /// A link on the way between two frames.
  struct Link {
    std::string parent, child;
    bool is_upward = false;  ///< from the child to the parent
    bool is_fixed = false;
  };
  /// The links from `base` to `frame`; nullopt where they are not connected.
  [[nodiscard]] std::optional<std::vector<Link>> chain(const std::string& base,
                                                       const std::string& frame) const;
  /// T_base_frame; nullopt where a link has no samples within 0.5 s around the stamp. Of a live
  /// source a stamp up to 0.5 s after the newest sample has that.
  [[nodiscard]] std::optional<Pose> lookup(const std::vector<Link>& links, Stamp stamp) const;
  /// The stamps of the chain's links that change, ascending; empty where all are fixed.
  [[nodiscard]] std::vector<Stamp> stamps(const std::vector<Link>& links) const;
  /// Frames whose second parent was ignored.
  [[nodiscard]] const std::vector<std::string>& reparented() const { return reparented_; }

 private:
  struct Edge {
    std::string parent;
    std::vector<TimedPose> samples;  ///< until finish()
    Trajectory T_parent_child;
    bool is_fixed = true;
  };

  /// From the frame to the root.
  [[nodiscard]] std::vector<std::string> ancestors(const std::string& frame) const;
  void add_live(Edge& edge, Stamp stamp, const Pose& T_parent_child) const;

  std::optional<Duration> history_ = {};
  std::map<std::string, Edge> edges_;  ///< by child
  std::vector<std::string> reparented_;
};

/// "base_link -> link_1 -> link_ft (fixed)".
[[nodiscard]] std::string chain_text(const std::string& base,
                                     const std::vector<TransformTree::Link>& links);

}  // namespace pcavr
