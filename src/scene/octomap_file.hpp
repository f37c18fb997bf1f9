// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include <Eigen/Geometry>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// What an OctoMap binary tree (`.bt`) holds, in cells of its finest level.
struct OctomapContent {
  double resolution = 0.0;  ///< [m]
  std::uint64_t free = 0;
  std::uint64_t occupied = 0;
  Eigen::AlignedBox3d known_base;  ///< box around all cells that are known [m]
};

/// A cube of cells that are alike: `edge` cells wide, from the cell whose lowest corner lies at
/// `corner` times the resolution.
struct OctomapLeaf {
  Eigen::Vector3i corner = Eigen::Vector3i::Zero();
  int edge = 1;
  bool is_occupied = false;
};

/// Walks through the file with every step checked, which OctoMap's own reader leaves to luck: a
/// file that is cut short or holds more than its tree is an Error. Hands out each leaf in the
/// file's order.
[[nodiscard]] Expected<OctomapContent> read_octomap(
    const std::filesystem::path& file,
    const std::function<void(const OctomapLeaf& leaf)>& on_leaf = {});

}  // namespace pcavr
