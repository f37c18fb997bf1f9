// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/byte_source.hpp"

namespace pcavr {

/// Reads a ROS 1 bag of version 2.0 [http://wiki.ros.org/Bags/Format/2.0] record by record; its
/// index is used only to find the end of the messages where other bytes lie between. A bag that was
/// not closed is read up to its last whole record, also in a chunk that is cut.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_ros1_bag(ByteSource source);

}  // namespace pcavr
