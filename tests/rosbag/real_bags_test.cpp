// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "support/read_bag.hpp"
#include "support/shared_data.hpp"

namespace pcavr {
namespace {

test::ReadBag read_shared(const std::string& name) {
  return test::read_all(open_bag(shared_data("real/bags/" + name)));
}

/// Bags that other tools wrote: as many messages as those tools count.
TEST(RealBags, AreReadToTheLastMessage) {
  PCAVR_NEEDS_SHARED_DATA("real/bags");
  const std::pair<const char*, std::size_t> kBags[] = {
      {"ros1/Test_metal_1.bag", 7076},
      {"ros1/fake_joint_state.bag", 2725},
      {"ros1/out_lz4.bag", 194},
      {"tagslam/test_18/tag_detections.bag.bz2", 1085},
      {"rosbag2_test", 4695},
      {"rosbag2_samples/mcap/reindex_multiple_files", 3177},
      {"delay_mcap/empty_rosbag2_2025_12_05-16_27_19", 0}};
  for (const auto& [name, count] : kBags) {
    const test::ReadBag read = read_shared(name);
    EXPECT_EQ(read.error, "") << name;
    EXPECT_TRUE(read.warnings.empty()) << name << ": " << read.warnings.front();
    EXPECT_EQ(read.messages.size(), count) << name;
  }
}

/// The same messages as MCAP (zstd and uncompressed) and as SQLite (all layouts).
TEST(RealBags, McapAndSqliteTwinsAreEqual) {
  PCAVR_NEEDS_SHARED_DATA("real/bags");
  for (const char* name : {"talker", "wbag", "convert_b", "cdr_test"}) {
    test::ReadBag mcap = read_shared(std::string("rosbag2_samples/mcap/") + name);
    test::ReadBag sqlite = read_shared(std::string("rosbag2_samples/sqlite3/") + name);
    EXPECT_EQ(mcap.error + sqlite.error, "") << name;
    for (test::ReadBag* bag : {&mcap, &sqlite}) {
      for (test::ReadMessage& message : bag->messages) message.publish_time = 0;
      std::sort(bag->messages.begin(), bag->messages.end());
    }
    ASSERT_FALSE(mcap.messages.empty()) << name;
    EXPECT_EQ(mcap.messages, sqlite.messages) << name;
  }
}

}  // namespace
}  // namespace pcavr
