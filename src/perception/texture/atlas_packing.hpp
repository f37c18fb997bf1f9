// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace pcavr {

/// Packs rectangles into a strip by the skyline method, bottom left, highest first [Jylanki 2010,
/// sec. 4]: their lower corners; nullopt where they do not fit into `width` x `height`.
[[nodiscard]] std::optional<std::vector<Eigen::Vector2i>> pack_rectangles(
    const std::vector<Eigen::Vector2i>& sizes, int width, int height);

}  // namespace pcavr
