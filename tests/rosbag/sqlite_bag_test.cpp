// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "support/file_tree.hpp"
#include "support/read_bag.hpp"
#include "support/sqlite_file.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class SqliteBag : public testing::Test {
 protected:
  test::ReadBag read(const std::string& sql) {
    const std::filesystem::path file =
        folder_.path() / ("bag_" + std::to_string(files_++) + ".db3");
    test::write_sqlite(file, sql);
    return test::read_all(open_bag(file));
  }
  void expect_error(const std::string& sql, const std::string& part) {
    const std::string error = read(sql).error;
    EXPECT_NE(error.find(part), std::string::npos) << sql << "\n" << error;
    EXPECT_NE(error.find(".db3: "), std::string::npos) << error;
  }

  TemporaryFolder folder_;
  int files_ = 0;
};

TEST_F(SqliteBag, IsReadWithoutWritingBesideIt) {
  const std::filesystem::path file = folder_.path() / "a b%?#.db3";
  test::write_sqlite(file, test::kBagTables + test::kBagTopic +
                               "INSERT INTO messages VALUES(1, 3, 20, x'6162'), (2, 3, 10, x'');");
  const FileTree before = tree(folder_.path());
  const test::ReadBag read = test::read_all(open_bag(file));
  EXPECT_EQ(read.error, "");
  ASSERT_EQ(read.messages.size(), 2U);
  EXPECT_EQ(read.messages[0].payload, "ab");
  EXPECT_EQ(read.messages[1].log_time, 10);
  EXPECT_EQ(tree(folder_.path()), before);
}

constexpr const char* kEndless =
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS id, ";

/// Whoever sends a bag may put a program in the place of each table.
TEST_F(SqliteBag, TablesThatAreComputedAreRefused) {
  const std::string topics =
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, "
      "serialization_format TEXT);" +
      test::kBagTopic;
  expect_error(topics + "CREATE VIEW messages AS " + kEndless +
                   "3 AS topic_id, i AS timestamp, x'00' AS data FROM n;",
               "its 'messages' is computed, not stored");
  expect_error(topics + "CREATE VIEW MESSAGES AS " + kEndless +
                   "3 AS topic_id, i AS timestamp, x'00' AS data FROM n;",
               "its 'messages' is computed, not stored");
  expect_error(std::string("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, "
                           "data); CREATE VIEW topics AS ") +
                   kEndless +
                   "'/' || i AS name, 't' AS type, 'cdr' AS serialization_format FROM n;",
               "its 'topics' is computed, not stored");
  expect_error(test::kBagTables + test::kBagTopic + "CREATE VIEW message_definitions AS " +
                   kEndless +
                   "'t' || i AS topic_type, '' AS encoding, '' AS encoded_message_definition "
                   "FROM n;",
               "its 'message_definitions' is computed, not stored");
  expect_error(topics +
                   "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp "
                   "INTEGER, data AS (zeroblob(900000000)));"
                   "INSERT INTO messages VALUES(1, 3, 1);",
               "its 'messages' is computed, not stored");
  expect_error(topics + "CREATE VIRTUAL TABLE messages USING fts5(topic_id, timestamp, data);",
               "its 'messages' is computed, not stored");
}

TEST_F(SqliteBag, TimesBeyondAnyRecordersClockAreRefused) {
  for (const char* stamp :
       {"-9223372036854775807 - 1", "9223372036854775807", "4700000000000000000"}) {
    expect_error(test::kBagTables + test::kBagTopic +
                     "INSERT INTO messages VALUES(1, 3, 5, x''), "
                     "(2, 3, " +
                     stamp + ", x'');",
                 "message 2: log time: ");
  }
}

TEST_F(SqliteBag, OtherDatabasesAreOneLine) {
  expect_error("CREATE TABLE a(b);", "no such table: topics");
  expect_error(test::kBagTables + "INSERT INTO messages VALUES(1, 7, 5, x'');",
               "message 1 is of topic 7, which is absent");
  expect_error("CREATE TABLE topics(id); CREATE TABLE messages(id);", "no such column");
}

/// Page numbers in the file as SQLite has them: big-endian.
void put_page(std::string& bytes, std::size_t at, unsigned page) {
  for (unsigned i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>((page >> (24 - 8 * i)) & 0xFF);
}

/// A page of messages whose pointers all lead to the first of them: read for ever, as each of a
/// few hundred pointers on each of twenty levels doubles it.
TEST_F(SqliteBag, PagesThatRepeatAreFound) {
  const std::filesystem::path file = folder_.path() / "a.db3";
  test::write_sqlite(file,
                     test::kBagTables + test::kBagTopic +
                         "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n LIMIT "
                         "200) INSERT INTO messages SELECT i, 3, i, zeroblob(100) FROM n;");
  std::string bytes = *read_file(file);
  const std::size_t root = bytes.find('\x05', 2 * 4096);  // an interior page of a table
  ASSERT_EQ(root % 4096, 0U);
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const std::size_t cells = 256U * byte(root + 3) + byte(root + 4);
  ASSERT_GE(cells, 2U);
  const auto cell = [&](std::size_t i) {
    const std::size_t at = root + 12 + 2 * i;
    return root + 256U * byte(at) + byte(at + 1);
  };
  const unsigned first = 256U * byte(cell(0) + 2) + byte(cell(0) + 3);
  for (std::size_t i = 1; i < cells; ++i) put_page(bytes, cell(i), first);
  ASSERT_TRUE(write_file(file, bytes));
  const test::ReadBag read = test::read_all(open_bag(file));
  EXPECT_LT(read.messages.size(), 100U);
  ASSERT_EQ(read.warnings.size(), 1U);
  EXPECT_NE(read.warnings[0].find("it repeats rows"), std::string::npos) << read.warnings[0];
}

}  // namespace
}  // namespace pcavr
