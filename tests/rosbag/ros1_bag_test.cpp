// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/ros1_bag_reader.hpp"
#include "support/read_bag.hpp"
#include "support/ros1_bag_text.hpp"

namespace pcavr {
namespace {

test::ReadBag read_ros1(const std::string& bytes) {
  return test::read_all(open_ros1_bag(ByteSource(test::bytes_of(bytes), "a.bag")));
}

Ros1BagText three_messages() {
  Ros1BagText text;
  text.add("/a", "std_msgs/String", {1'500'000'000}, "first");
  text.add("/b", "std_msgs/String", {1'400'000'000}, "second");
  text.add("/a", "std_msgs/String", {1'600'000'001}, "third");
  return text;
}

TEST(Ros1Bag, IsReadInTheOrderOfTheFile) {
  const test::ReadBag read = read_ros1(three_messages().bag());
  EXPECT_EQ(read.error, "");
  EXPECT_TRUE(read.warnings.empty());
  ASSERT_EQ(read.messages.size(), 3U);
  EXPECT_EQ(read.messages[1].topic, "/b");
  EXPECT_EQ(read.messages[2].log_time, 1'600'000'001);
  EXPECT_EQ(read.messages[2].payload, "third");
  ASSERT_EQ(read.topics.size(), 2U);
  EXPECT_EQ(read.topics[0].type, "std_msgs/String");
}

TEST(Ros1Bag, ZerosBeforeTheIndexAreSkipped) {
  const test::ReadBag read = read_ros1(three_messages().bag(std::string(49, '\0')));
  EXPECT_EQ(read.error, "");
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(read.messages.size(), 3U);
}

TEST(Ros1Bag, CutAnywhereIsReadUpToTheLastWholeMessage) {
  const std::string bytes = three_messages().bag();
  const test::ReadBag whole = read_ros1(bytes);
  std::size_t before = 0;
  for (std::size_t size = 13; size < bytes.size(); ++size) {
    const test::ReadBag read = read_ros1(bytes.substr(0, size));
    ASSERT_EQ(read.error, "") << size;
    ASSERT_GE(read.messages.size(), before) << size;
    ASSERT_TRUE(std::equal(read.messages.begin(), read.messages.end(), whole.messages.begin()));
    before = read.messages.size();
  }
  EXPECT_EQ(before, 3U);
}

/// Closed by its recorder before any topic came.
TEST(Ros1Bag, AnEmptyBagIsWhole) {
  using Text = Ros1BagText;
  const std::string start = "#ROSBAG V2.0\n";
  const auto bag = [&](std::uint64_t index_at, std::uint64_t connections) {
    return start + Text::record({{"op", Text::op(3)},
                                 {"index_pos", Text::number(index_at, 8)},
                                 {"conn_count", Text::number(connections, 4)},
                                 {"chunk_count", Text::number(0, 4)}},
                                std::string(100, ' '));
  };
  const std::size_t size = bag(0, 0).size();
  const test::ReadBag empty = read_ros1(bag(size, 0));
  EXPECT_EQ(empty.error, "");
  EXPECT_TRUE(empty.warnings.empty()) << empty.warnings.front();
  // Cut before its index, or where its index should be.
  EXPECT_EQ(read_ros1(bag(size, 1)).warnings.size(), 1U);
  EXPECT_EQ(read_ros1(bag(size + 1, 0)).warnings.size(), 1U);
  EXPECT_EQ(read_ros1(bag(0, 0)).warnings.size(), 1U) << "not closed";
}

TEST(Ros1Bag, AnIndexThatMiscountsIsReported) {
  Ros1BagText text = three_messages();
  text.messages = 5;
  const test::ReadBag read = read_ros1(text.bag());
  EXPECT_EQ(read.messages.size(), 3U);
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("counts 5 messages, but it has 3"), std::string::npos);
}

TEST(Ros1Bag, BadFilesAreOneLine) {
  using Text = Ros1BagText;
  const std::string start = "#ROSBAG V2.0\n";
  const auto error_of = [&](const std::string& bytes) { return read_ros1(bytes).error; };
  EXPECT_NE(error_of("#ROSBAG V1.2\n").find("another version than 2.0"), std::string::npos);
  EXPECT_NE(error_of("PK").find("is not a ROS 1 bag"), std::string::npos);
  EXPECT_NE(error_of(start + Text::bag_header(0, "rosbag/AesCbcEncryptor")).find("is encrypted"),
            std::string::npos);
  const auto chunk = [&](const std::string& compression, std::uint64_t size) {
    return error_of(start + Text::bag_header(0, "") + Text::chunk_record(compression, size, "abc"));
  };
  EXPECT_NE(chunk("zip", 3).find("compression 'zip' is not supported"), std::string::npos);
  EXPECT_NE(chunk("none", 4'000'000'000).find("1 GiB is the maximum"), std::string::npos);
  EXPECT_NE(chunk("bz2", 3).find("compressed data is damaged"), std::string::npos);
  EXPECT_NE(chunk("lz4", 3).find("compressed data ends early"), std::string::npos);
  EXPECT_NE(chunk("none", 5).find("3 of its 5 bytes"), std::string::npos);
  const std::string message = Text::record(
      {{"op", Text::op(2)}, {"conn", Text::number(9, 4)}, {"time", Text::number(0, 8)}}, "x");
  EXPECT_NE(error_of(start + Text::bag_header(0, "") + message).find("connection 9"),
            std::string::npos);
}

}  // namespace
}  // namespace pcavr
