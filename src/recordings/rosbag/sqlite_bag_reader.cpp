// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/sqlite_bag_reader.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include <sqlite3.h>
#include <sys/mman.h>
#include <unistd.h>

#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/log_time.hpp"
#include "recordings/rosbag/topic_table.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Steps of SQLite's machine for one row or statement: reading a row takes some ten, a schema some
/// hundred for each table. What takes more has no end.
constexpr int kMaxSteps = 10'000'000;
constexpr int kStepsPerCheck = 10'000;

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
    if (pages_ != nullptr) ::munmap(pages_, size_);
  }

  Expected<void> open(const fs::path& file) {
    const int code = sqlite3_open_v2(immutable_uri(file).c_str(), &database_,
                                     SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    if (code != SQLITE_OK) return failure();
    std::error_code none;
    size_ = fs::file_size(file, none);
    const std::uintmax_t journal = fs::file_size(file.string() + "-wal", none);
    if (!none && journal > 0) {
      warnings_.push_back(name_ +
                          "-wal: messages in this journal of an unclosed recorder are not "
                          "read; open the database once with sqlite3 to merge them");
    }
    return start();
  }

  /// A file without a name, which SQLite can't open: it reads the file's pages in memory.
  Expected<void> open_unnamed(const OpenFile& file) {
    const off_t size = ::lseek(file.get(), 0, SEEK_END);
    size_ = size > 0 ? static_cast<std::uint64_t>(size) : 0;
    void* pages =
        ::mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_NORESERVE, file.get(), 0);
    if (pages == MAP_FAILED) return Error{.message = "can't be read", .file = name_};
    pages_ = static_cast<std::uint8_t*>(pages);
    // The versions of a database with a journal, which is not there. The change is not written.
    constexpr std::size_t kWriteVersion = 18, kReadVersion = 19;
    if (size_ > kReadVersion) pages_[kWriteVersion] = pages_[kReadVersion] = 1;
    if (sqlite3_open(":memory:", &database_) != SQLITE_OK) return failure();
    const auto count = static_cast<sqlite3_int64>(size_);
    const int code =
        sqlite3_deserialize(database_, "main", pages_, count, count, SQLITE_DESERIALIZE_READONLY);
    return code == SQLITE_OK ? start() : failure();
  }

  Expected<std::optional<BagMessage>> next() override {
    while (!is_end_) {
      const int code = step(messages_);
      if (code != SQLITE_ROW) is_end_ = true;
      if (code == SQLITE_DONE) break;
      if (code != SQLITE_ROW) {
        if (count_ == 0) return failure();
        warnings_.push_back(name_ + ": is cut or damaged (" + reason() + "); " +
                            std::to_string(count_) + " messages before are read");
        break;
      }
      Expected<BagMessage> message = read_message();
      if (message) return std::optional(*std::move(message));
      is_end_ = true;
      return message.error();
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  /// Opens the database's tables with bounds for files that were made to have no end.
  Expected<void> start() {
    // Links of a damaged file may repeat its pages: no row is longer than the file.
    sqlite3_limit(database_, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min<std::uintmax_t>(size_, kMaxBagRecord)));
    sqlite3_progress_handler(
        database_, kStepsPerCheck,
        [](void* steps) {
          return (*static_cast<int*>(steps) += kStepsPerCheck) > kMaxSteps ? 1 : 0;
        },
        &steps_);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    for (const char* table : {"topics", "messages", "message_definitions"}) {
      if (const Expected<void> checked = check_table(table); !checked) return checked;
    }
    if (const Expected<void> read = read_topics(); !read) return read;
    messages_ = rows_of("messages", "topic_id, timestamp, data");
    return messages_.is_valid() ? Expected<void>() : failure();
  }

  Error failure() const {
    return {.message = "is not a readable rosbag2 database: " + reason(),
            .file = name_,
            .hint = "check that this is the intended file, and that it was copied whole"};
  }

  std::string reason() const {
    if (database_ == nullptr) return "out of memory";
    if (is_repeated_) return "it repeats rows";
    if (steps_ > kMaxSteps) return "it takes too long to read";
    return sqlite3_errmsg(database_);
  }

  /// The rows in the order of their numbers, which the first column has.
  SqliteStatement rows_of(const std::string& table, const std::string& columns) {
    steps_ = 0;
    newest_row_.reset();
    return {database_, "SELECT rowid, " + columns + " FROM " + table + " ORDER BY rowid"};
  }

  /// The next of rows_of(): each is later than the one before, or the file repeats its pages.
  int step(SqliteStatement& rows) {
    steps_ = 0;
    const int code = rows.step();
    if (code != SQLITE_ROW) return code;
    is_repeated_ = newest_row_ && rows.integer(0) <= *newest_row_;
    newest_row_ = rows.integer(0);
    return is_repeated_ ? SQLITE_CORRUPT : SQLITE_ROW;
  }

  /// Views, tables of modules and computed columns are programs of whoever made the file, which
  /// may not end; rosbag2 writes none. A table that is absent is left to its statement.
  Expected<void> check_table(const std::string& table) {
    SqliteStatement schema(
        database_, "SELECT type = 'table' AND rootpage > 0 FROM sqlite_master WHERE name = '" +
                       table + "' COLLATE NOCASE");
    if (!schema.is_valid()) return failure();
    int code = SQLITE_OK;
    while ((code = schema.step()) == SQLITE_ROW) {
      if (schema.integer(0) == 0) return no_plain_table(table);
    }
    if (code != SQLITE_DONE) return failure();
    SqliteStatement columns(database_, "PRAGMA table_xinfo(" + table + ")");
    constexpr int kHidden = 6;
    while (columns.is_valid() && (code = columns.step()) == SQLITE_ROW) {
      if (columns.integer(kHidden) != 0) return no_plain_table(table);
    }
    return code == SQLITE_DONE ? Expected<void>() : failure();
  }

  Error no_plain_table(const std::string& table) const {
    return {.message = "is no rosbag2 database: its '" + table + "' is computed, not stored",
            .file = name_,
            .hint = "it was not written by a recorder; check where it is from"};
  }

  Expected<BagMessage> read_message() {
    const std::string place = "message " + std::to_string(count_ + 1);
    const auto topic = topic_of_id_.find(messages_.integer(1));
    if (topic == topic_of_id_.end()) {
      return Error{.message = place + " is of topic " + std::to_string(messages_.integer(1)) +
                              ", which is absent",
                   .file = name_};
    }
    const Stamp stamp{messages_.integer(2)};
    if (const auto error = check_log_time(stamp)) {
      return Error{.message = error->message, .file = name_, .place = place, .hint = error->hint};
    }
    const std::span<const std::uint8_t> payload = messages_.blob(3);
    bytes_ += payload.size();
    if (bytes_ > size_) {
      return Error{
          .message = "its messages are longer than the file", .file = name_, .place = place};
    }
    ++count_;
    return BagMessage{
        .topic = topic->second, .log_time = stamp, .publish_time = stamp, .payload = payload};
  }

  using Definitions = std::map<std::string, std::pair<std::string, std::string>>;

  /// The definitions of the types, which came with layout 4.
  Expected<Definitions> read_definitions() {
    Definitions definitions;
    SqliteStatement types =
        rows_of("message_definitions", "topic_type, encoding, encoded_message_definition");
    std::size_t bytes = 0;
    while (types.is_valid() && step(types) == SQLITE_ROW) {
      bytes += types.blob(1).size() + types.blob(3).size();
      if (bytes > kMaxTopicBytes) {
        return Error{.message = "definitions of more than 64 MiB", .file = name_};
      }
      definitions[types.text(1)] = {types.text(2), types.text(3)};
    }
    return definitions;
  }

  /// The same in all layouts.
  Expected<void> read_topics() {
    const Expected<Definitions> definitions = read_definitions();
    if (!definitions) return definitions.error();
    SqliteStatement rows = rows_of("topics", "id, name, type, serialization_format");
    if (!rows.is_valid()) return failure();
    int code = SQLITE_OK;
    while ((code = step(rows)) == SQLITE_ROW) {
      BagTopic topic{.name = rows.text(2),
                     .type = rows.text(3),
                     .encoding = rows.text(4),
                     .schema_encoding = {},
                     .schema = {}};
      if (const auto known = definitions->find(topic.type); known != definitions->end()) {
        std::tie(topic.schema_encoding, topic.schema) = known->second;
      }
      const Expected<std::size_t> index = topics_.add(std::move(topic));
      if (!index) return Error{.message = index.error().message, .file = name_};
      topic_of_id_[rows.integer(1)] = *index;
    }
    return code == SQLITE_DONE ? Expected<void>() : failure();
  }

  std::string name_;
  sqlite3* database_ = nullptr;
  std::uint8_t* pages_ = nullptr;  ///< of an unnamed file
  SqliteStatement messages_;
  TopicTable topics_;
  std::map<std::int64_t, std::size_t> topic_of_id_;
  std::vector<std::string> warnings_;
  std::uint64_t count_ = 0;
  std::uint64_t bytes_ = 0;  ///< of all messages up to now
  std::uint64_t size_ = 0;   ///< of the file [bytes]
  int steps_ = 0;            ///< of SQLite's machine since the last row
  std::optional<std::int64_t> newest_row_ = {};
  bool is_repeated_ = false;
  bool is_end_ = false;
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_sqlite_bag(const fs::path& file,
                                                     const std::string& name) {
  auto reader = std::make_unique<SqliteBagReader>(name);
  if (const Expected<void> opened = reader->open(file); !opened) return opened.error();
  return std::unique_ptr<BagReader>(std::move(reader));
}

Expected<std::unique_ptr<BagReader>> open_sqlite_bag(const OpenFile& file,
                                                     const std::string& name) {
  auto reader = std::make_unique<SqliteBagReader>(name);
  if (const Expected<void> opened = reader->open_unnamed(file); !opened) return opened.error();
  return std::unique_ptr<BagReader>(std::move(reader));
}

}  // namespace pcavr
