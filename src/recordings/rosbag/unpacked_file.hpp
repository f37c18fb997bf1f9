// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/base/core/expected.hpp"

#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/open_file.hpp"

namespace pcavr {

/// Writes a packed SQLite database, of which nothing was read beyond its first kilobyte, to a
/// temporary file without a name, which ends with the descriptor. An Error before it is written
/// where the temporary folder is absent or has no space for the size that the database states; at
/// most 64 GiB.
[[nodiscard]] Expected<OpenFile> unpack_database(ByteSource& source);

}  // namespace pcavr
