// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Content of an OctoMap binary tree (`.bt`), in cells of its finest level.
struct OctomapContent {
  double resolution = 0.0;  ///< [m]
  std::uint64_t free = 0;
  std::uint64_t occupied = 0;
  Eigen::AlignedBox3d known_base;  ///< bounding box of all known cells [m]
};

/// A leaf of the octree: a cube of `edge` cells with its lower corner at `corner` * resolution.
struct OctomapLeaf {
  Eigen::Vector3i corner = Eigen::Vector3i::Zero();
  int edge = 1;
  bool is_occupied = false;
};

/// Parses the file with bounds checks, which OctoMap's own reader lacks: a truncated file or extra
/// bytes are an Error. Calls `on_leaf` for each leaf in the file's order.
[[nodiscard]] Expected<OctomapContent> read_octomap(
    const std::filesystem::path& file,
    const std::function<void(const OctomapLeaf& leaf)>& on_leaf = {});
/// The same of a file's content; `file` names it in errors.
[[nodiscard]] Expected<OctomapContent> parse_octomap(
    std::string_view bytes, const std::string& file,
    const std::function<void(const OctomapLeaf& leaf)>& on_leaf = {});

}  // namespace pcavr
