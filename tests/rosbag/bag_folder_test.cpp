// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include "pcavr/core/output.hpp"
#include "pcavr/rosbag/bag_reader.hpp"
#include "pcavr/rosbag/mcap_writer.hpp"

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

TEST(SqliteBag, IsReadWithoutWritingBesideIt) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "a b%?#.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const char* text =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format "
      "TEXT);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data "
      "BLOB);"
      "INSERT INTO topics VALUES(3, '/a', 'std_msgs/msg/String', 'cdr');"
      "INSERT INTO messages VALUES(1, 3, 20, x'6162'), (2, 3, 10, x'');";
  ASSERT_EQ(sqlite3_exec(database, text, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const FileTree before = tree(folder.path());
  const test::ReadBag read = test::read_all(open_bag(file));
  EXPECT_EQ(read.error, "");
  ASSERT_EQ(read.messages.size(), 2U);
  EXPECT_EQ(read.messages[0].payload, "ab");
  EXPECT_EQ(read.messages[1].log_time, 10);
  EXPECT_EQ(tree(folder.path()), before);
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
