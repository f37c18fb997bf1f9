// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

namespace pcavr {

/// Rows that come in blocks, many within next to no time and then none for long: their stamps are
/// of when a driver's buffer was read, so that no speed between rows is true. A warning that names
/// `stream`, the rows of a block and the time between blocks; nullopt where stamps are spread, with
/// jitter, gaps or losses. `t` [s] ascending. Thread-safe.
[[nodiscard]] std::optional<std::string> warn_of_stamp_blocks(const std::string& stream,
                                                              std::span<const double> t);

}  // namespace pcavr
