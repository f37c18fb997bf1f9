// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// Approximate time synchronisation: pairs of indices (a, b) of stamps that are mutual nearest
/// neighbours and at most `max_gap` apart; of two at the same distance the earlier is the nearest.
/// Both lists ascend strictly, and so do the pairs in both indices; no index occurs twice. O(n).
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> pair_by_time(
    std::span<const Stamp> a, std::span<const Stamp> b, Duration max_gap);

}  // namespace pcavr
