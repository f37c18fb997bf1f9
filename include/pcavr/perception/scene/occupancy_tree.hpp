// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// An occupancy map on disk as OctoMap holds it, for clearance queries. Frame: base. Thread-safe to
/// query.
class OccupancyTree {
 public:
  /// Reads a binary tree (`.bt`: free or occupied) or a full one (`.ot`: log-odds; occupied from
  /// 0.5 on) with OctoMap, after a check of its bytes, which OctoMap's readers lack: a truncated
  /// file, extra bytes or a tree deeper than 16 levels are an Error.
  [[nodiscard]] static Expected<OccupancyTree> read(const std::filesystem::path& file);
  /// The same of a file's content; `file` names it in errors.
  [[nodiscard]] static Expected<OccupancyTree> parse(std::string_view bytes,
                                                     const std::string& file);
  OccupancyTree(OccupancyTree&&) noexcept;
  OccupancyTree& operator=(OccupancyTree&&) noexcept;
  ~OccupancyTree();

  [[nodiscard]] double resolution() const;  ///< [m]
  [[nodiscard]] bool is_occupied(const Eigen::Vector3d& p_base) const;
  /// Distance [m] from a point to the nearest occupied cell, 0 inside; nothing beyond `max` [m].
  [[nodiscard]] std::optional<double> clearance(const Eigen::Vector3d& p_base, double max) const;
  /// Each occupied leaf: its centre and edge [m].
  void for_each_occupied(
      const std::function<void(const Eigen::Vector3d& centre, double edge)>& use) const;
  /// Makes the occupied cells free for which `is_cleared` is true; it is also called with larger
  /// cubes, and must be true where it is for a cell of the cube. Returns their number. Not while
  /// others query.
  std::size_t clear_occupied(
      const std::function<bool(const Eigen::Vector3d& centre, double edge)>& is_cleared);
  /// The tree as in a `.bt` file after its header, and as in octomap_msgs/Octomap.
  [[nodiscard]] std::string binary_data() const;

 private:
  struct State;
  explicit OccupancyTree(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
