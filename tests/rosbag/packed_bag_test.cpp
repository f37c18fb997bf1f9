// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "rosbag/packed_bytes.hpp"
#include "support/file_tree.hpp"
#include "support/read_bag.hpp"
#include "support/ros1_bag_text.hpp"
#include "support/sqlite_file.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

class PackedBag : public testing::Test {
 protected:
  /// The same messages in each format, by the format's ending.
  static std::string bag_bytes(const fs::path& folder, const std::string& ending) {
    const fs::path file = folder / ("plain" + ending);
    const std::string payload(3000, 'p');
    if (ending == ".db3") {
      test::write_sqlite(file, test::kBagTables + test::kBagTopic +
                                   "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n "
                                   "LIMIT 2000) INSERT INTO messages SELECT i, 3, i, "
                                   "CAST(printf('%.*c', 3000, 'p') AS BLOB) FROM n;");
    } else if (ending == ".mcap") {
      Expected<McapWriter> writer = McapWriter::create(file);
      const std::uint16_t channel = writer->add_channel("/a", "cdr", 0);
      for (int i = 1; i <= 2000; ++i) EXPECT_TRUE(writer->write(channel, {i}, payload));
      EXPECT_TRUE(writer->close());
    } else {
      Ros1BagText text;
      for (int i = 1; i <= 2000; ++i) text.add("/a", "std_msgs/String", {i}, payload);
      EXPECT_TRUE(write_file(file, text.bag()));
    }
    return *read_file(file);
  }
};

/// The bag has 6 MB, more than what is read at once.
TEST_F(PackedBag, IsReadAsThePlainOne) {
  const TemporaryFolder plain, folder;
  for (const char* ending : {".db3", ".mcap", ".bag"}) {
    const std::string bytes = bag_bytes(plain.path(), ending);
    const test::ReadBag expected =
        test::read_all(open_bag(plain.path() / (std::string("plain") + ending)));
    ASSERT_EQ(expected.messages.size(), 2000U) << ending;
    for (const char* packing : {".zst", ".zstd", ".bz2"}) {
      const fs::path file = folder.path() / ("a" + std::string(ending) + packing);
      const bool is_bz2 = std::string_view(packing) == ".bz2";
      const std::string packed =
          test::packed_bytes(is_bz2 ? Compression::bz2 : Compression::zstd, bytes);
      ASSERT_TRUE(write_file(file, packed));
      EXPECT_TRUE(is_bag(file));
      const FileTree before = tree(folder.path());
      const test::ReadBag read = test::read_all(open_bag(file));
      EXPECT_EQ(read.error, "") << file;
      EXPECT_TRUE(read.warnings.empty()) << file << read.warnings.front();
      EXPECT_TRUE(read.messages == expected.messages) << file;
      EXPECT_EQ(tree(folder.path()), before);
    }
  }
}

/// rosbag2 writes such folders with --compression-mode file.
TEST_F(PackedBag, IsReadInItsFolder) {
  const TemporaryFolder plain, folder;
  const std::string bytes = bag_bytes(plain.path(), ".db3");
  write_tree(folder.path(),
             {{"b_0.db3.zstd", test::packed_bytes(Compression::zstd, bytes)},
              {"metadata.yaml",
               "rosbag2_bagfile_information:\n  compression_format: zstd\n"
               "  compression_mode: FILE\n  relative_file_paths: [b_0.db3.zstd]\n"}});
  ASSERT_TRUE(is_bag(folder.path()));
  const test::ReadBag read = test::read_all(open_bag(folder.path()));
  EXPECT_EQ(read.error, "");
  EXPECT_EQ(read.messages.size(), 2000U);
}

/// A packed file that was cut is read as a bag that was cut.
TEST_F(PackedBag, CutIsReadUpToTheCut) {
  const TemporaryFolder plain, folder;
  for (const char* ending : {".mcap", ".bag"}) {
    const std::string packed =
        test::packed_bytes(Compression::bz2, bag_bytes(plain.path(), ending));
    const fs::path file = folder.path() / ("a" + std::string(ending) + ".bz2");
    ASSERT_TRUE(write_file(file, packed.substr(0, packed.size() / 2)));
    const test::ReadBag read = test::read_all(open_bag(file));
    EXPECT_EQ(read.error, "");
    EXPECT_GT(read.messages.size(), 500U) << ending;
    EXPECT_LT(read.messages.size(), 1900U) << ending;
    ASSERT_EQ(read.warnings.size(), 1U) << ending;
    EXPECT_NE(read.warnings[0].find("is cut at byte"), std::string::npos);
  }
}

/// 300 MiB that begin as the text does, packed as a stream for each MiB.
std::string packed_zeros_after(std::string text) {
  text.resize(1 << 20, '\0');
  std::string packed = test::packed_bytes(Compression::zstd, text);
  const std::string zeros =
      test::packed_bytes(Compression::zstd, std::string(std::size_t{1} << 20, '\0'));
  for (int i = 1; i < 300; ++i) packed += zeros;
  return packed;
}

TEST_F(PackedBag, WhatExpandsBeyondAnyRecordingIsRefused) {
  const TemporaryFolder folder;
  // An MCAP attachment, which is skipped; a database of zeros.
  const std::string attachment =
      std::string("\x89MCAP0\r\n\x09", 9) + Ros1BagText::number(std::uint64_t{300} << 20, 8);
  const std::string database = std::string("SQLite format 3\0\x10", 17);
  for (const auto& [name, start] :
       {std::pair("a.mcap.zst", attachment), std::pair("a.db3.zst", database)}) {
    ASSERT_TRUE(write_file(folder.path() / name, packed_zeros_after(start)));
    const std::string error = test::read_all(open_bag(folder.path() / name)).error;
    EXPECT_NE(error.find(name + std::string(": byte 269484032")), std::string::npos) << error;
    EXPECT_NE(error.find("bytes unpack to more than 1000 times as many and 256 MiB"),
              std::string::npos)
        << error;
  }
}

TEST_F(PackedBag, OfADatabaseNeedsATemporaryFolderWithSpace) {
  const TemporaryFolder folder;
  const char* variable = std::getenv("TMPDIR");
  const std::string before = variable == nullptr ? "/tmp" : variable;
  const std::string bytes = bag_bytes(folder.path(), ".db3");
  const auto error_of = [&](const std::string& database) {
    const fs::path file = folder.path() / "a.db3.zst";
    EXPECT_TRUE(write_file(file, test::packed_bytes(Compression::zstd, database)));
    const FileTree files = tree(folder.path());
    const std::string error = test::read_all(open_bag(file)).error;
    EXPECT_EQ(tree(folder.path()), files);
    return error;
  };
  ::setenv("TMPDIR", (folder.path() / "absent").c_str(), 1);
  EXPECT_NE(error_of(bytes).find("a.db3.zst: there is no temporary folder"), std::string::npos);
  ::setenv("TMPDIR", before.c_str(), 1);
  std::string large = bytes;
  large[28] = '\x7F';  // the number of pages: 8 TB
  EXPECT_NE(error_of(large).find("a.db3.zst: has 87"), std::string::npos) << error_of(large);
}

}  // namespace
}  // namespace pcavr
