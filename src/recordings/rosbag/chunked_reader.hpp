// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/topic_table.hpp"

namespace pcavr {

/// Reads a file of records, of which some are chunks of further records. A format derives from it.
template <typename Record>
class ChunkedReader : public BagReader {
 public:
  Expected<std::optional<BagMessage>> next() final {
    while (!is_end_) {
      const Expected<std::optional<Record>> record =
          is_in_chunk_ ? next_of_chunk() : next_of_file();
      if (!record) return fail(record.error());
      if (!*record) continue;
      Expected<std::optional<BagMessage>> message = handle(**record);
      if (!message) return fail(message.error());
      if (*message) return message;
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const final { return topics_.topics(); }
  const std::vector<std::string>& warnings() const final { return warnings_; }

 protected:
  /// `begin`: the first record's offset in bytes. `damaged_hint`: of an error about a record.
  ChunkedReader(ByteSource source, std::uint64_t begin, const char* damaged_hint)
      : source_(std::move(source)), offset_(begin), damaged_hint_(damaged_hint) {}

  /// nullopt: there is nothing to handle.
  virtual Expected<std::optional<Record>> next_of_file() = 0;
  virtual Expected<std::optional<Record>> next_of_chunk() = 0;
  /// A message, or nullopt for any other record.
  virtual Expected<std::optional<BagMessage>> handle(const Record& record) = 0;

  Error damaged(const std::string& what) const {
    return source_.error_at(record_at_, what, damaged_hint_);
  }

  void warn(const std::string& text) { warnings_.push_back(source_.name() + ": " + text); }

  /// The topic's index; an Error where the names and definitions are too many.
  Expected<std::size_t> add_topic(BagTopic topic) {
    const Expected<std::size_t> index = topics_.add(std::move(topic));
    if (!index) return damaged(index.error().message);
    return index;
  }

  /// Checks before a chunk is decompressed that all together are no more than a recording can have.
  Expected<void> check_chunk_size(std::uint64_t size) {
    if (size > kMaxBagRecord) {
      return damaged("chunk of " + std::to_string(size) + " bytes, but 1 GiB is the maximum");
    }
    chunk_bytes_ += size;
    if (chunk_bytes_ <= max_unpacked_size(source_.stored_size())) return {};
    return damaged("chunks of " + std::to_string(chunk_bytes_) +
                   " bytes up to here, in a file of " + std::to_string(source_.stored_size()));
  }

  /// The file ends before its last record does.
  std::optional<Record> finish_cut() {
    is_end_ = true;
    warn("is cut at byte " + std::to_string(record_at_) + "; " + std::to_string(messages_) +
         " messages before it are read");
    return std::nullopt;
  }

  ByteSource source_;
  TopicTable topics_;
  std::vector<std::uint8_t> unpacked_;
  std::span<const std::uint8_t> chunk_;  ///< the rest of `unpacked_`
  std::uint64_t offset_;                 ///< of the next record, bytes
  std::uint64_t record_at_ = 0;          ///< offset of the newest one
  std::uint64_t messages_ = 0;
  bool is_in_chunk_ = false;
  bool is_end_ = false;

 private:
  Error fail(Error error) {
    is_end_ = true;
    return error;
  }

  const char* damaged_hint_;
  std::uint64_t chunk_bytes_ = 0;  ///< of all chunks up to now, unpacked
  std::vector<std::string> warnings_;
};

}  // namespace pcavr
