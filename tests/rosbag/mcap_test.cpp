// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/mcap_reader.hpp"
#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

using test::ReadBag;
using test::ReadMessage;

ReadBag read_mcap(const std::string& bytes) {
  return test::read_all(open_mcap(ByteSource(test::bytes_of(bytes), "a.mcap")));
}

std::vector<ReadMessage> expected_messages(std::size_t count) {
  std::vector<ReadMessage> messages;
  for (std::size_t i = 0; i < count; ++i) {
    const auto t = static_cast<std::int64_t>(1000 + i);
    messages.push_back({i % 2 == 0 ? "/a" : "/b", t, t - 5, "{\"i\":" + std::to_string(i) + "}"});
  }
  return messages;
}

/// A file of 40 messages on two topics, in chunks of some 300 bytes.
std::string write_mcap(const std::filesystem::path& file, bool close = true) {
  Expected<McapWriter> writer = McapWriter::create(file, {.max_chunk = 300});
  EXPECT_TRUE(writer);
  const std::uint16_t schema = writer->add_schema("Sample", "jsonschema", "{\"type\":\"object\"}");
  const std::uint16_t a = writer->add_channel("/a", "json", schema, {{"unit", "m"}});
  const std::uint16_t b = writer->add_channel("/b", "json", 0);
  for (const ReadMessage& m : expected_messages(40)) {
    EXPECT_TRUE(
        writer->write(m.topic == "/a" ? a : b, {m.log_time}, m.payload, Stamp{m.publish_time}));
  }
  if (close) {
    EXPECT_TRUE(writer->close());
    EXPECT_TRUE(writer->close());
  }
  const Expected<std::string> bytes = read_file(file);
  EXPECT_TRUE(bytes);
  return *bytes;
}

TEST(Mcap, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  const ReadBag read = read_mcap(write_mcap(folder.path() / "a.mcap"));
  EXPECT_EQ(read.error, "");
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_EQ(read.messages, expected_messages(40));
  ASSERT_EQ(read.topics.size(), 2U);
  EXPECT_EQ(read.topics[0].type, "Sample");
  EXPECT_EQ(read.topics[0].schema, "{\"type\":\"object\"}");
  EXPECT_EQ(read.topics[1].type, "");
  EXPECT_FALSE(McapWriter::create(folder.path() / "a.mcap"));
}

TEST(Mcap, WithoutCloseAllButTheLastChunkIsRead) {
  const TemporaryFolder folder;
  const ReadBag read = read_mcap(write_mcap(folder.path() / "a.mcap", false));
  EXPECT_EQ(read.error, "");
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_GE(read.messages.size(), 34U);
}

TEST(Mcap, CutAnywhereIsReadUpToTheLastWholeMessage) {
  const TemporaryFolder folder;
  const std::string bytes = write_mcap(folder.path() / "a.mcap");
  const std::vector<ReadMessage> all = expected_messages(40);
  std::size_t before = 0;
  for (std::size_t size = 8; size < bytes.size() - 8; ++size) {
    const ReadBag read = read_mcap(bytes.substr(0, size));
    ASSERT_EQ(read.error, "") << size;
    ASSERT_EQ(read.warnings.size(), 1U) << size;
    ASSERT_NE(read.warnings[0].find("is cut at byte"), std::string::npos);
    ASSERT_GE(read.messages.size(), before) << size;
    ASSERT_TRUE(std::equal(read.messages.begin(), read.messages.end(), all.begin())) << size;
    before = read.messages.size();
  }
  EXPECT_EQ(before, 40U);
}

TEST(Mcap, StatesWhatARecorderDroppedAtLast) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a.mcap";
  Expected<McapWriter> writer = McapWriter::create(file);
  const std::uint16_t channel = writer->add_channel("/a", "json", 0);
  ASSERT_TRUE(writer->write(channel, {1}, "{}"));
  ASSERT_TRUE(writer->write_metadata("notes", {{"by", "a test"}}));
  ASSERT_TRUE(writer->write_dropped({{"/a", 1}, {"/b", 2}}));
  ASSERT_TRUE(writer->write(channel, {2}, "{}"));
  ASSERT_TRUE(writer->write_dropped({{"/a", 3}, {"/b", 2}}));
  const auto drops_of_a = [](const ReadBag& bag) {
    return std::count_if(bag.warnings.begin(), bag.warnings.end(), [](const std::string& line) {
      return line.find("3 messages of /a were dropped") != std::string::npos;
    });
  };
  EXPECT_EQ(drops_of_a(test::read_all(open_bag(file))), 1);  // as after a kill
  ASSERT_TRUE(writer->close());
  const ReadBag bag = test::read_all(open_bag(file));
  EXPECT_EQ(bag.error, "");
  EXPECT_EQ(bag.messages.size(), 2U);
  EXPECT_EQ(bag.warnings.size(), 2U);
  EXPECT_EQ(drops_of_a(bag), 1);
}

TEST(Mcap, ChangedBytesAreFoundByTheCrcs) {
  const TemporaryFolder folder;
  std::string bytes = write_mcap(folder.path() / "a.mcap");
  const std::size_t at = bytes.find("{\"i\":3}");
  bytes[at + 5] = '4';
  EXPECT_NE(read_mcap(bytes).error.find("CRC"), std::string::npos);
  bytes[at + 5] = '3';
  bytes[bytes.rfind("jsonschema")] = 'J';  // in the summary
  const ReadBag read = read_mcap(bytes);
  EXPECT_EQ(read.messages.size(), 40U);
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("CRC of its summary"), std::string::npos);
}

/// A file with one chunk record that has these fields.
std::string chunk_file(std::uint64_t size, const std::string& compression) {
  const auto number = [](std::uint64_t value, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += static_cast<char>((value >> (8 * i)) & 0xFFU);
    return text;
  };
  const std::string chunk = number(0, 8) + number(0, 8) + number(size, 8) + number(0, 4) +
                            number(compression.size(), 4) + compression + number(3, 8) + "abc";
  return "\x89MCAP0\r\n\x06" + number(chunk.size(), 8) + chunk;
}

/// A small file may state the same definition for any number of topics.
TEST(Mcap, DefinitionsAreBounded) {
  const TemporaryFolder folder;
  const auto error_with = [&](int topics, int schemas) {
    const std::filesystem::path file = folder.path() / "a.mcap";
    Expected<McapWriter> writer = McapWriter::create(file, {.replace = true});
    for (int i = 0; i < std::max(topics, schemas); ++i) {
      static const std::string definition(1 << 20, 'x');
      const std::uint16_t schema =
          i < schemas ? writer->add_schema("T" + std::to_string(i), "ros2msg", definition) : 1;
      if (i >= topics) continue;
      const auto channel = writer->add_channel("/t" + std::to_string(i), "cdr", schema);
      EXPECT_TRUE(writer->write(channel, {1}, "x"));
    }
    EXPECT_TRUE(writer->close());
    return test::read_all(open_bag(file)).error;
  };
  EXPECT_EQ(error_with(60, 1), "");
  EXPECT_NE(error_with(70, 1).find("a.mcap: byte"), std::string::npos);
  EXPECT_NE(error_with(70, 1).find("more than 64 MiB"), std::string::npos);
  EXPECT_NE(error_with(1, 70).find("schemas of more than 64 MiB"), std::string::npos);
}

TEST(Mcap, ChunksThatUnpackToFarMoreThanTheFileAreRefused) {
  const std::string error = read_mcap(chunk_file(1'000'000'000, "zstd")).error;
  EXPECT_NE(error.find("chunks of 1000000000 bytes up to here, in a file of"), std::string::npos)
      << error;
}

TEST(Mcap, TimesBeyondAnyRecordersClockAreRefused) {
  const TemporaryFolder folder;
  Expected<McapWriter> writer = McapWriter::create(folder.path() / "a.mcap");
  const std::uint16_t channel = writer->add_channel("/a", "json", 0);
  ASSERT_TRUE(writer->write(channel, {std::numeric_limits<std::int64_t>::max()}, "{}"));
  ASSERT_TRUE(writer->close());
  EXPECT_NE(test::read_all(open_bag(folder.path() / "a.mcap")).error.find("out of range"),
            std::string::npos);
}

TEST(Mcap, BadFilesAreOneLine) {
  EXPECT_NE(read_mcap("#ROSBAG V2.0\n").error.find("first 8 bytes differ"), std::string::npos);
  EXPECT_NE(read_mcap("").error.find("first 8 bytes differ"), std::string::npos);
  EXPECT_EQ(read_mcap(chunk_file(1'000'000'000'000, "")).error,
            "a.mcap: byte 8: chunk of 1000000000000 bytes, but 1 GiB is the maximum; the file is "
            "damaged; try 'pcavr inspect --recover', or copy it again");
  EXPECT_NE(read_mcap(chunk_file(3, "snappy")).error.find("compression 'snappy' is not supported"),
            std::string::npos);
  EXPECT_NE(read_mcap(chunk_file(3, "zstd")).error.find("compressed data is damaged"),
            std::string::npos);
  EXPECT_NE(read_mcap(chunk_file(4, "")).error.find("3 of its 4 bytes"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
