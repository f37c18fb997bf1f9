// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "rosbag/packed_bytes.hpp"
#include "support/file_tree.hpp"
#include "support/read_bag.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

void write_one(const std::filesystem::path& file, const std::string& payload) {
  Expected<McapWriter> writer = McapWriter::create(file);
  ASSERT_TRUE(writer);
  const std::uint16_t channel = writer->add_channel("/a", "cdr", 0);
  ASSERT_TRUE(writer->write(channel, {1}, payload));
  ASSERT_TRUE(writer->close());
}

TEST(BagFolder, FilesAreReadInTheOrderOfTheirNumbers) {
  const TemporaryFolder folder;
  for (const char* number : {"2", "10", "0"}) {
    write_one(folder.path() / (std::string("bag_") + number + ".mcap"), number);
  }
  ASSERT_TRUE(is_bag(folder.path()));
  const test::ReadBag read = test::read_all(open_bag(folder.path()));
  ASSERT_EQ(read.messages.size(), 3U);
  EXPECT_EQ(read.messages[0].payload + read.messages[1].payload + read.messages[2].payload, "0210");
  EXPECT_EQ(read.topics.size(), 1U);
}

TEST(BagFolder, MetadataNamesTheFiles) {
  const TemporaryFolder folder;
  write_one(folder.path() / "b_0.mcap", "zero");
  write_one(folder.path() / "b_1.mcap", "one");
  const std::string start = "rosbag2_bagfile_information:\n  relative_file_paths:\n";
  write_tree(folder.path(), {{"metadata.yaml", start + "    - old/b_1.mcap\n    - gone.mcap\n"}});
  const test::ReadBag read = test::read_all(open_bag(folder.path()));
  ASSERT_EQ(read.messages.size(), 1U);
  EXPECT_EQ(read.messages[0].payload, "one");
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("gone.mcap: is listed"), std::string::npos);
  write_tree(folder.path(), {{"metadata.yaml", "rosbag2_bagfile_information: [}"}});
  EXPECT_EQ(test::read_all(open_bag(folder.path())).messages.size(), 2U);
}

TEST(BagFolder, PackedFilesAreReadOnce) {
  const TemporaryFolder folder;
  write_one(folder.path() / "b_0.mcap", "zero");
  const Expected<std::string> bytes = read_file(folder.path() / "b_0.mcap");
  const std::string packed = test::packed_bytes(Compression::zstd, *bytes);
  // Someone packed the file after it was recorded, and kept it.
  write_tree(folder.path(), {{"b_0.mcap.zst", packed}});
  EXPECT_EQ(test::read_all(open_bag(folder.path())).messages.size(), 1U);
  std::filesystem::remove(folder.path() / "b_0.mcap");
  write_tree(folder.path(), {{"metadata.yaml",
                              "rosbag2_bagfile_information:\n"
                              "  relative_file_paths: [b_0.mcap]\n"}});
  const test::ReadBag read = test::read_all(open_bag(folder.path()));
  ASSERT_EQ(read.messages.size(), 1U);
  EXPECT_EQ(read.messages[0].payload, "zero");
  EXPECT_TRUE(read.warnings.empty());
}

TEST(OpenBag, OtherFilesAreOneLine) {
  const TemporaryFolder folder;
  write_tree(folder.path(), {{"a.db3", "no database"}, {"a.txt", "text"}, {"a.mcap", ""}});
  const auto error_of = [&](const char* name) {
    return test::read_all(open_bag(folder.path() / name)).error;
  };
  EXPECT_NE(error_of("a.db3").find("is not a readable rosbag2 database"), std::string::npos);
  EXPECT_NE(error_of("a.txt").find("is no bag"), std::string::npos);
  EXPECT_NE(error_of("a.mcap").find("is not an MCAP file"), std::string::npos);
  EXPECT_NE(error_of("none.bag").find("No such file"), std::string::npos);
  EXPECT_FALSE(is_bag(folder.path() / "a.txt"));
}

}  // namespace
}  // namespace pcavr
