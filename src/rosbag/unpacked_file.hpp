// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "pcavr/core/expected.hpp"

#include "rosbag/decompression.hpp"
#include "rosbag/open_file.hpp"

namespace pcavr {

/// Unpacks a file to a temporary one without a name, which ends with the descriptor. Its path is
/// /proc/self/fd/NUMBER. At most 64 GiB.
[[nodiscard]] Expected<OpenFile> unpack_file(const std::filesystem::path& file,
                                             Compression compression);

}  // namespace pcavr
