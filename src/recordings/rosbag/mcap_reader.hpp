// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/chunked_reader.hpp"
#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {

struct McapRecord {
  std::uint8_t opcode = 0;
  std::span<const std::uint8_t> content;
};

/// Reads an MCAP file record by record, without its indexes. A file without footer is read up to
/// its last whole record, also in a chunk that is cut.
class McapReader : public ChunkedReader<McapRecord> {
 public:
  /// The source has the first 8 bytes of an MCAP file (check_mcap_magic).
  explicit McapReader(ByteSource source);

  // After the last message, or an Error:

  /// Whether the file needs no recovery: it has its end, and an index of all messages.
  [[nodiscard]] Expected<bool> is_whole();
  /// Whether all data were read: what is cut or damaged is their repetition and index.
  [[nodiscard]] bool has_all_data() const { return is_in_summary_; }
  /// Bytes from the first record on that is cut or damaged; in a chunk, of its unpacked content.
  [[nodiscard]] std::uint64_t unread_bytes() const;
  /// Whether the record at which the file is cut is a message.
  [[nodiscard]] bool is_message_cut() const { return is_message_cut_; }
  /// Records that are attachments; they are skipped.
  [[nodiscard]] std::uint64_t attachments() const { return attachments_; }

 protected:
  using Bytes = std::span<const std::uint8_t>;

  Expected<std::optional<BagMessage>> handle(const McapRecord& record) override;
  /// Whether the records are no longer the data but what repeats and indexes them.
  [[nodiscard]] bool is_in_summary() const { return is_in_summary_; }

 private:
  struct Schema {
    std::string name, encoding, data;

    [[nodiscard]] std::size_t size() const { return name.size() + encoding.size() + data.size(); }
  };

  Expected<std::optional<McapRecord>> next_of_file() override;
  Expected<std::optional<McapRecord>> next_of_chunk() override;
  static bool is_needed(std::uint8_t opcode);
  void leave_chunk();
  Expected<void> read_schema(Bytes content);
  Expected<void> read_channel(Bytes content);
  Expected<std::optional<BagMessage>> read_message(Bytes content);
  Expected<void> enter_chunk(RecordFields fields);
  void check_statistics(RecordFields fields);
  void read_metadata(RecordFields fields);
  void state_drops();
  std::optional<McapRecord> end_cut();
  Expected<void> read_footer(RecordFields fields);

  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  ///< index of the topic
  std::size_t schema_bytes_ = 0;
  std::vector<std::pair<std::string, std::uint64_t>> drops_;  ///< by topic
  std::uint64_t attachments_ = 0;
  std::size_t chunk_left_ = 0;  ///< [bytes] of the chunk, from the newest record on
  bool is_record_of_chunk_ = false;
  bool is_cut_chunk_ = false;
  bool is_message_cut_ = false;
  bool has_loose_messages_ = false;  ///< outside of chunks: no index has them
  bool is_in_summary_ = false;
  bool is_indexed_ = false;
};

/// An Error where the file does not begin as an MCAP file.
[[nodiscard]] Expected<void> check_mcap_magic(ByteSource& source);

/// Opens the file for an McapReader.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_mcap(ByteSource source);

}  // namespace pcavr
