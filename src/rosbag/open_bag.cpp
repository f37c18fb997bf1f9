// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/rosbag/bag_reader.hpp"

#include "rosbag/mcap_reader.hpp"

namespace pcavr {

bool is_bag(const std::filesystem::path& path) { return path.extension() == ".mcap"; }

Expected<std::unique_ptr<BagReader>> open_bag(const std::filesystem::path& path) {
  Expected<ByteSource> source = ByteSource::open(path);
  if (!source) return source.error();
  return open_mcap(*std::move(source));
}

}  // namespace pcavr
