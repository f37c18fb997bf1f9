// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

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

/// Walks through the file with every step checked, which OctoMap's own reader leaves to luck: a
/// file that is cut short or holds more than its tree is an Error.
[[nodiscard]] Expected<OctomapContent> read_octomap(const std::filesystem::path& file);

}  // namespace pcavr
