// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/byte_source.hpp"

namespace pcavr {

/// Reads an MCAP file record by record, without its indexes. A file without footer is read up to
/// its last whole record, also in a chunk that is cut.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_mcap(ByteSource source);

}  // namespace pcavr
