// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "rosbag/sqlite_bag_reader.hpp"

#include <map>
#include <set>
#include <utility>

#include <sqlite3.h>

#include "rosbag/decompression.hpp"
#include "rosbag/topic_table.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// The database's name as a URI, in which some characters have a meaning.
std::string immutable_uri(const fs::path& file) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : file.string()) {
    const auto byte = static_cast<unsigned char>(c);
    const bool is_plain = c == '/' || c == '.' || c == '_' || c == '-' || (c >= '0' && c <= '9') ||
                          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (is_plain) uri += c;
    if (!is_plain) (uri += '%') += {kDigits[byte / 16], kDigits[byte % 16]};
  }
  return uri + "?mode=ro&immutable=1";
}

class SqliteStatement {
 public:
  SqliteStatement() = default;
  SqliteStatement(sqlite3* database, const std::string& text) {
    sqlite3_prepare_v2(database, text.c_str(), -1, &statement_, nullptr);
  }
  SqliteStatement(const SqliteStatement&) = delete;
  SqliteStatement& operator=(SqliteStatement&& other) noexcept {
    std::swap(statement_, other.statement_);
    return *this;
  }
  ~SqliteStatement() { sqlite3_finalize(statement_); }

  [[nodiscard]] bool is_valid() const { return statement_ != nullptr; }
  /// Whether there is another row; an error of the database otherwise than at the end.
  int step() { return sqlite3_step(statement_); }
  [[nodiscard]] std::int64_t integer(int column) const {
    return sqlite3_column_int64(statement_, column);
  }
  [[nodiscard]] std::span<const std::uint8_t> blob(int column) const {
    const auto* bytes = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement_, column));
    return {bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }
  [[nodiscard]] std::string text(int column) const {
    const std::span<const std::uint8_t> bytes = blob(column);
    return {bytes.begin(), bytes.end()};
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
};

class SqliteBagReader final : public BagReader {
 public:
  explicit SqliteBagReader(std::string name) : name_(std::move(name)) {}
  ~SqliteBagReader() override {
    messages_ = SqliteStatement();
    sqlite3_close_v2(database_);
  }

  Expected<void> open(const fs::path& file) {
    const int code = sqlite3_open_v2(immutable_uri(file).c_str(), &database_,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    if (code != SQLITE_OK) return failure();
    sqlite3_limit(database_, SQLITE_LIMIT_LENGTH, static_cast<int>(kMaxBagRecord));
    sqlite3_db_config(database_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    std::error_code none;
    const std::uintmax_t journal = fs::file_size(file.string() + "-wal", none);
    if (!none && journal > 0) {
      warnings_.push_back(name_ +
                          "-wal: messages in this journal of an unclosed recorder are not "
                          "read; open the database once with sqlite3 to merge them");
    }
    if (const Expected<void> read = read_topics(); !read) return read;
    messages_ = SqliteStatement(
        database_, "SELECT topic_id, timestamp, data FROM messages ORDER BY messages.id");
    return messages_.is_valid() ? Expected<void>() : failure();
  }

  Expected<std::optional<BagMessage>> next() override {
    while (!is_end_) {
      const int code = messages_.step();
      if (code != SQLITE_ROW) is_end_ = true;
      if (code == SQLITE_DONE) break;
      if (code != SQLITE_ROW) {
        if (count_ == 0) return failure();
        warnings_.push_back(name_ + ": is cut or damaged (" + sqlite3_errmsg(database_) + "); " +
                            std::to_string(count_) + " messages before are read");
        break;
      }
      const auto topic = topic_of_id_.find(messages_.integer(0));
      if (topic == topic_of_id_.end()) {
        is_end_ = true;
        return Error{.message = "message " + std::to_string(count_ + 1) + " is of topic " +
                                std::to_string(messages_.integer(0)) + ", which is absent",
                     .file = name_};
      }
      ++count_;
      const Stamp stamp{messages_.integer(1)};
      return std::optional(BagMessage{.topic = topic->second,
                                      .log_time = stamp,
                                      .publish_time = stamp,
                                      .payload = messages_.blob(2)});
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  Error failure() const {
    return {.message = std::string("is not a readable rosbag2 database: ") +
                       (database_ != nullptr ? sqlite3_errmsg(database_) : "out of memory"),
            .file = name_,
            .hint = "check that this is the intended file, and that it was copied whole"};
  }

  /// Topics are the same in all layouts; definitions of types came with layout 4.
  Expected<void> read_topics() {
    SqliteStatement rows(database_, "SELECT id, name, type, serialization_format FROM topics");
    if (!rows.is_valid()) return failure();
    std::map<std::string, std::pair<std::string, std::string>> definitions;
    SqliteStatement types(
        database_,
        "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    while (types.is_valid() && types.step() == SQLITE_ROW) {
      definitions[types.text(0)] = {types.text(1), types.text(2)};
    }
    int code = SQLITE_OK;
    while ((code = rows.step()) == SQLITE_ROW) {
      BagTopic topic{.name = rows.text(1),
                     .type = rows.text(2),
                     .encoding = rows.text(3),
                     .schema_encoding = {},
                     .schema = {}};
      if (const auto definition = definitions.find(topic.type); definition != definitions.end()) {
        std::tie(topic.schema_encoding, topic.schema) = definition->second;
      }
      topic_of_id_[rows.integer(0)] = topics_.add(topic);
    }
    return code == SQLITE_DONE ? Expected<void>() : failure();
  }

  std::string name_;
  sqlite3* database_ = nullptr;
  SqliteStatement messages_;
  TopicTable topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  std::vector<std::string> warnings_;
  std::uint64_t count_ = 0;
  bool is_end_ = false;
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_sqlite_bag(const fs::path& file,
                                                     const std::string& name) {
  auto reader = std::make_unique<SqliteBagReader>(name);
  if (const Expected<void> opened = reader->open(file); !opened) return opened.error();
  return std::unique_ptr<BagReader>(std::move(reader));
}

}  // namespace pcavr
