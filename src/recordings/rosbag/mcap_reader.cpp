// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/mcap_reader.hpp"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <libdeflate.h>

#include "recordings/rosbag/chunked_reader.hpp"
#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/log_time.hpp"
#include "recordings/rosbag/mcap_format.hpp"
#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint64_t kMaxMetadata = 1U << 20U;  // bytes: names of topics and counts
constexpr const char* kDamagedHint = "the file is damaged; try 'mcap recover', or copy it again";

struct SchemaRecord {
  std::string name, encoding, data;

  [[nodiscard]] std::size_t size() const { return name.size() + encoding.size() + data.size(); }
};

struct McapRecord {
  std::uint8_t opcode = 0;
  Bytes content;
};

Stamp stamp_of(std::uint64_t nanoseconds) {
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
  return {static_cast<std::int64_t>(std::min(nanoseconds, kMax))};
}

class McapReader final : public ChunkedReader<McapRecord> {
 public:
  explicit McapReader(ByteSource source)
      : ChunkedReader(std::move(source), mcap::kMagic.size(), kDamagedHint) {}

 private:
  Expected<std::optional<McapRecord>> next_of_file() override {
    record_at_ = offset_;
    const auto there = source_.available(offset_, mcap::kRecordHead);
    if (!there) return there.error();
    if (*there < mcap::kRecordHead) return end_cut();
    const Expected<Bytes> head = source_.view(offset_, mcap::kRecordHead);
    if (!head) return head.error();
    RecordFields fields(*head);
    const auto opcode = fields.integer<std::uint8_t>();
    const auto length = fields.integer<std::uint64_t>();
    const std::uint64_t begin = offset_ + mcap::kRecordHead;
    if (opcode == 0) return damaged("record with opcode 0");
    const bool is_read = is_needed(opcode) || (opcode == mcap::kMetadata && length <= kMaxMetadata);
    if (is_read && length > kMaxBagRecord) {
      return damaged("record of " + std::to_string(length) + " bytes, but 1 GiB is the maximum");
    }
    const Expected<std::uint64_t> left =
        is_read ? source_.available(begin, length) : source_.skip(begin, length);
    if (!left) return left.error();
    offset_ = begin + *left;
    if (*left < length) {
      // Killed while it wrote a chunk: its first messages may be there.
      if (opcode == mcap::kChunk) is_cut_chunk_ = true;
      if (opcode != mcap::kChunk) end_cut();
      if (is_end_) return std::optional<McapRecord>();
    }
    if (!is_read) return std::optional<McapRecord>();
    const auto size = static_cast<std::size_t>(*left);
    const Expected<Bytes> content = source_.view(begin, size);
    if (!content) return content.error();
    return std::optional(McapRecord{opcode, *content});
  }

  /// Indexes, attachments and metadata other than the recorder's drops are skipped; so are opcodes
  /// of the future.
  static bool is_needed(std::uint8_t opcode) {
    using namespace mcap;
    return (opcode >= kHeader && opcode <= kChunk) || opcode == kStatistics || opcode == kDataEnd;
  }

  Expected<std::optional<McapRecord>> next_of_chunk() override {
    const std::size_t left = chunk_.size();
    if (left == 0) {
      leave_chunk();
      return std::optional<McapRecord>();
    }
    RecordFields fields(chunk_);
    const auto opcode = fields.integer<std::uint8_t>();
    const auto length = fields.integer<std::uint64_t>();
    const Bytes content = fields.take(length);
    if (!fields.is_valid()) {
      if (!is_cut_chunk_) return damaged("record that exceeds its chunk");
      leave_chunk();
      return std::optional<McapRecord>();
    }
    chunk_ = fields.rest();
    if (opcode != mcap::kSchema && opcode != mcap::kChannel && opcode != mcap::kMessage) {
      return damaged("chunk with a record of opcode " + std::to_string(opcode));
    }
    return std::optional(McapRecord{opcode, content});
  }

  void leave_chunk() {
    is_in_chunk_ = false;
    chunk_ = {};
    if (is_cut_chunk_) end_cut();
  }

  Expected<std::optional<BagMessage>> handle(const McapRecord& record) override {
    RecordFields fields(record.content);
    Expected<void> done;
    switch (record.opcode) {
      case mcap::kMessage:
        if (!is_in_summary_) return read_message(fields);
        break;
      case mcap::kSchema:
        done = read_schema(fields);
        break;
      case mcap::kChannel:
        done = read_channel(fields);
        break;
      case mcap::kChunk:
        done = enter_chunk(fields);
        break;
      case mcap::kMetadata:
        read_metadata(fields);
        break;
      case mcap::kDataEnd:
        is_in_summary_ = true;
        break;
      case mcap::kStatistics:
        check_statistics(fields);
        break;
      case mcap::kFooter:
        done = read_footer(fields);
        break;
      default:
        break;
    }
    if (!done) return done.error();
    return std::optional<BagMessage>();
  }

  Expected<void> read_schema(RecordFields fields) {
    const auto id = fields.integer<std::uint16_t>();
    SchemaRecord schema;
    schema.name = fields.text();
    schema.encoding = fields.text();
    schema.data = fields.text();
    if (!fields.is_valid() || id == 0) return damaged("schema record that is not valid");
    SchemaRecord& kept = schemas_[id];  // writers repeat them
    schema_bytes_ += schema.size();
    schema_bytes_ -= std::exchange(kept, std::move(schema)).size();
    if (schema_bytes_ > kMaxTopicBytes) return damaged("schemas of more than 64 MiB");
    return {};
  }

  Expected<void> read_channel(RecordFields fields) {
    const auto id = fields.integer<std::uint16_t>();
    const auto schema_id = fields.integer<std::uint16_t>();
    BagTopic topic;
    topic.name = fields.text();
    topic.encoding = fields.text();
    if (!fields.is_valid()) return damaged("channel record that is not valid");
    if (schema_id != 0) {
      const auto schema = schemas_.find(schema_id);
      if (schema == schemas_.end()) {
        return damaged("channel '" + topic.name.substr(0, 80) + "' of schema " +
                       std::to_string(schema_id) + ", which is absent");
      }
      topic.type = schema->second.name;
      topic.schema_encoding = schema->second.encoding;
      topic.schema = schema->second.data;
    }
    const Expected<std::size_t> index = add_topic(std::move(topic));
    if (!index) return index.error();
    channels_[id] = *index;
    return {};
  }

  Expected<std::optional<BagMessage>> read_message(RecordFields fields) {
    const auto channel_id = fields.integer<std::uint16_t>();
    (void)fields.integer<std::uint32_t>();  // sequence
    const auto log_time = fields.integer<std::uint64_t>();
    const auto publish_time = fields.integer<std::uint64_t>();
    if (!fields.is_valid()) return damaged("message record that is not valid");
    const auto channel = channels_.find(channel_id);
    if (channel == channels_.end()) {
      return damaged("message of channel " + std::to_string(channel_id) + ", which is absent");
    }
    const Stamp stamp = stamp_of(log_time);
    if (const auto error = check_log_time(stamp)) return damaged(error->message);
    ++messages_;
    return std::optional(BagMessage{.topic = channel->second,
                                    .log_time = stamp,
                                    .publish_time = stamp_of(publish_time),
                                    .payload = fields.rest()});
  }

  Expected<void> enter_chunk(RecordFields fields) {
    (void)fields.take(16);  // start and end time
    const auto size = fields.integer<std::uint64_t>();
    const auto crc = fields.integer<std::uint32_t>();
    const std::string_view name = fields.text();
    const auto packed_size = fields.integer<std::uint64_t>();
    if (!fields.is_valid()) {
      if (!is_cut_chunk_) return damaged("chunk record that is not valid");
      end_cut();
      return {};
    }
    if (const Expected<void> checked = check_chunk_size(size); !checked) return checked;
    const Expected<Compression> compression = parse_compression(name);
    if (!compression) return damaged(compression.error().message);
    const Bytes packed = is_cut_chunk_ ? fields.rest() : fields.take(packed_size);
    if (!fields.is_valid()) return damaged("chunk that exceeds its record");
    const Expected<void> unpacked = decompress_chunk(
        *compression, packed, {.size = size, .may_be_cut = is_cut_chunk_}, unpacked_);
    if (!unpacked) return damaged(unpacked.error().message);
    if (crc != 0 && !is_cut_chunk_ &&
        libdeflate_crc32(0, unpacked_.data(), unpacked_.size()) != crc) {
      return damaged("chunk whose CRC differs");
    }
    chunk_ = unpacked_;
    is_in_chunk_ = true;
    return {};
  }

  void check_statistics(RecordFields fields) {
    const auto count = fields.integer<std::uint64_t>();
    if (!fields.is_valid() || count == messages_) return;
    warn("states " + std::to_string(count) + " messages, but has " + std::to_string(messages_));
  }

  /// Keeps the drops that the recorder counted; each such record replaces the last. One that is not
  /// valid is ignored, as all other metadata.
  void read_metadata(RecordFields fields) {
    if (fields.text() != mcap::kDropsMetadata) return;
    RecordFields entries(fields.sized());
    std::vector<std::pair<std::string, std::uint64_t>> drops;
    while (!entries.rest().empty()) {
      std::string topic = printable_name(entries.text());
      const std::string_view text = entries.text();
      std::uint64_t count = 0;
      const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), count);
      if (!entries.is_valid() || code != std::errc{} || end != text.data() + text.size()) return;
      if (count > 0) drops.emplace_back(std::move(topic), count);
    }
    drops_ = std::move(drops);
  }

  void state_drops() {
    constexpr std::size_t kMaxStated = 20;
    for (std::size_t i = 0; i < std::min(drops_.size(), kMaxStated); ++i) {
      warn(std::to_string(drops_[i].second) + " messages of " + drops_[i].first +
           " were dropped while it was recorded");
    }
  }

  std::optional<McapRecord> end_cut() {
    state_drops();
    return finish_cut();
  }

  Expected<void> read_footer(RecordFields fields) {
    state_drops();
    const auto summary_start = fields.integer<std::uint64_t>();
    (void)fields.integer<std::uint64_t>();  // offsets
    const auto crc = fields.integer<std::uint32_t>();
    is_end_ = true;
    if (!fields.is_valid()) return damaged("footer that is not valid");
    const std::uint64_t crc_end = record_at_ + mcap::kRecordHead + mcap::kFooterSize - 4;
    if (summary_start == 0 || crc == 0 || source_.is_ascending()) return {};
    if (summary_start > record_at_) {
      warn("its footer states a summary beyond its end; the summary is not used");
      return {};
    }
    std::uint32_t found = 0;
    for (std::uint64_t at = summary_start; at < crc_end;) {
      constexpr std::uint64_t kPart = 1U << 20;
      const auto size = static_cast<std::size_t>(std::min(kPart, crc_end - at));
      const Expected<Bytes> part = source_.view(at, size);
      if (!part) return part.error();
      found = libdeflate_crc32(found, part->data(), part->size());
      at += size;
    }
    if (found != crc) warn("the CRC of its summary differs; only its messages are used");
    return {};
  }

  std::map<std::uint16_t, SchemaRecord> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;  ///< index of the topic
  std::size_t schema_bytes_ = 0;
  std::vector<std::pair<std::string, std::uint64_t>> drops_;  ///< by topic
  bool is_cut_chunk_ = false;
  bool is_in_summary_ = false;
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_mcap(ByteSource source) {
  const Expected<std::uint64_t> size = source.available(0, mcap::kMagic.size());
  if (!size) return size.error();
  bool is_mcap = *size == mcap::kMagic.size();
  if (is_mcap) {
    const Expected<Bytes> magic = source.view(0, mcap::kMagic.size());
    if (!magic) return magic.error();
    is_mcap = std::equal(magic->begin(), magic->end(), mcap::kMagic.begin());
  }
  if (!is_mcap) {
    return Error{.message = "is not an MCAP file of version 0: its first 8 bytes differ",
                 .file = source.name(),
                 .hint = "check that this is the intended file"};
  }
  return std::unique_ptr<BagReader>(std::make_unique<McapReader>(std::move(source)));
}

}  // namespace pcavr
