// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pcavr/base/core/stamp.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/geometry/trajectory.hpp"

namespace pcavr {

/// The frames of a bag and the transforms between them over time [ROS tf2]. Each frame has one
/// parent at a time. A static link holds until another replaces it, the first of them also before;
/// so does, at all times, one that never changes, whatever its stamps are (publishers of fixed
/// links stamp them in the future). Others are interpolated between their samples.
class TransformTree {
 public:
  /// All samples are kept.
  TransformTree() = default;
  /// For a live source: samples come in ascending order of stamps, each is in force at once, and
  /// finish() is not needed. Keeps at least `history` of each link, and a bounded number of frames.
  explicit TransformTree(Duration history) : history_(history) {}

  /// Adds a sample, in any order of stamps. A child's second parent is ignored.
  void add(const std::string& parent, const std::string& child, Stamp stamp,
           const Pose& T_parent_child);
  /// Adds a static link, which may have another parent than the child had before, in any order. It
  /// holds from `since` on: its arrival, as the stamps of static links do not matter. Where the
  /// child has samples of add() too, it is one of them.
  void add_static(const std::string& parent, const std::string& child, Stamp since,
                  const Pose& T_parent_child);
  /// Call once after the last add().
  void finish();

  /// A link on the way between two frames.
  struct Link {
    std::string parent, child;
    bool is_upward = false;  ///< from the child to the parent
    bool is_fixed = false;
  };
  /// The links from `base` to `frame` after the last replacement of static ones; nullopt where they
  /// are not connected.
  [[nodiscard]] std::optional<std::vector<Link>> chain(const std::string& base,
                                                       const std::string& frame) const;
  /// T_base_frame, by the links that hold at the stamp; nullopt where one has no samples within
  /// 0.5 s around it, or the frames are not connected then. Of a live source a stamp up to 0.5 s
  /// after the newest sample has that.
  [[nodiscard]] std::optional<Pose> lookup(const std::vector<Link>& links, Stamp stamp) const;
  /// The stamps of the chain's links that change, ascending; empty where all are fixed.
  [[nodiscard]] std::vector<Stamp> stamps(const std::vector<Link>& links) const;
  /// Frames whose second parent was ignored.
  [[nodiscard]] const std::vector<std::string>& reparented() const { return reparented_; }

  struct StaticValue {
    Stamp since;
    std::string parent;
    Pose T_parent_child;
  };
  /// The static links that were replaced by other ones: the values by child, ascending. Not of a
  /// live source.
  [[nodiscard]] std::map<std::string, std::vector<StaticValue>> replaced() const;

 private:
  struct Edge {
    std::string parent;                      ///< of the samples
    std::vector<StaticValue> static_values;  ///< ascending after finish(); empty: not static
    std::vector<TimedPose> samples;          ///< until finish()
    Trajectory T_parent_child;
    bool is_fixed = true;

    [[nodiscard]] bool has_samples() const { return !samples.empty() || !T_parent_child.empty(); }
  };

  /// The value that holds at the stamp; the edge is static.
  [[nodiscard]] static const StaticValue& value_at(const Edge& edge, Stamp stamp);
  [[nodiscard]] static const std::string& parent_at(const Edge& edge, Stamp stamp);
  /// The frames from `frame` to the root.
  [[nodiscard]] std::vector<std::string> ancestors(const std::string& frame, Stamp stamp) const;
  [[nodiscard]] std::optional<std::vector<Link>> chain_at(const std::string& base,
                                                          const std::string& frame,
                                                          Stamp stamp) const;
  [[nodiscard]] std::optional<Pose> lookup(const Edge& edge, Stamp stamp) const;
  void add_live(Edge& edge, Stamp stamp, const Pose& T_parent_child) const;

  std::optional<Duration> history_ = {};
  std::map<std::string, Edge> edges_;  ///< by child
  std::vector<std::string> reparented_;
};

/// "base_link -> link_1 -> link_ft (fixed)".
[[nodiscard]] std::string chain_text(const std::string& base,
                                     const std::vector<TransformTree::Link>& links);

}  // namespace pcavr
