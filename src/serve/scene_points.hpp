// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/content.hpp"

namespace pcavr {

/// cloud.bin of docs/live-protocol.md, from a scene's cloud.ply.
struct PageCloud {
  std::string bytes;
  std::size_t points = 0;
};
/// Quantizes the points: the error is at most half a step. Sorted by Morton code (Z-order curve)
/// [Morton 1966], which compresses better; of more than `max_points`, every n-th in that order is
/// kept.
[[nodiscard]] Expected<PageCloud> page_cloud(const std::filesystem::path& cloud_ply,
                                             const ContentOptions& options);

/// occupancy.bin of docs/live-protocol.md, from a scene's occupancy.bt.
struct PageOccupancy {
  std::string bytes;
  std::size_t cells = 0;
  double edge = 0.0;  ///< [m]
};
/// An Error if there are more than `max_cells`.
[[nodiscard]] Expected<PageOccupancy> page_occupancy(const std::filesystem::path& occupancy_bt,
                                                     const ContentOptions& options);

}  // namespace pcavr
