// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/mcap_reader.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

#include <libdeflate.h>

#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/log_time.hpp"
#include "recordings/rosbag/mcap_content.hpp"
#include "recordings/rosbag/mcap_format.hpp"
#include "recordings/rosbag/record_fields.hpp"

namespace pcavr {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint64_t kMaxMetadata = 1U << 20U;  // bytes: names of topics and counts
constexpr const char* kDamagedHint =
    "the file is damaged; try 'pcavr inspect --recover', or copy it again";

}  // namespace

McapReader::McapReader(ByteSource source)
    : ChunkedReader(std::move(source), mcap::kMagic.size(), kDamagedHint) {}

Expected<std::optional<McapRecord>> McapReader::next_of_file() {
  record_at_ = offset_;
  is_record_of_chunk_ = false;
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
    is_message_cut_ = opcode == mcap::kMessage;
    if (opcode != mcap::kChunk) end_cut();
    if (is_end_) return std::optional<McapRecord>();
  }
  if (opcode == mcap::kAttachment && !is_in_summary_) ++attachments_;
  if (!is_read) return std::optional<McapRecord>();
  const auto size = static_cast<std::size_t>(*left);
  const Expected<Bytes> content = source_.view(begin, size);
  if (!content) return content.error();
  return std::optional(McapRecord{opcode, *content});
}

/// Indexes, attachments and metadata other than the recorder's drops are skipped; so are opcodes
/// of the future.
bool McapReader::is_needed(std::uint8_t opcode) {
  using namespace mcap;
  return (opcode >= kHeader && opcode <= kChunk) || opcode == kStatistics || opcode == kDataEnd;
}

Expected<std::optional<McapRecord>> McapReader::next_of_chunk() {
  is_record_of_chunk_ = true;
  chunk_left_ = chunk_.size();
  if (chunk_left_ == 0) {
    leave_chunk();
    return std::optional<McapRecord>();
  }
  RecordFields fields(chunk_);
  const auto opcode = fields.integer<std::uint8_t>();
  const auto length = fields.integer<std::uint64_t>();
  const Bytes content = fields.take(length);
  if (!fields.is_valid()) {
    if (!is_cut_chunk_) return damaged("record that exceeds its chunk");
    is_message_cut_ = opcode == mcap::kMessage;
    leave_chunk();
    return std::optional<McapRecord>();
  }
  chunk_ = fields.rest();
  if (opcode != mcap::kSchema && opcode != mcap::kChannel && opcode != mcap::kMessage) {
    return damaged("chunk with a record of opcode " + std::to_string(opcode));
  }
  return std::optional(McapRecord{opcode, content});
}

void McapReader::leave_chunk() {
  is_in_chunk_ = false;
  chunk_ = {};
  if (is_cut_chunk_) end_cut();
}

Expected<std::optional<BagMessage>> McapReader::handle(const McapRecord& record) {
  RecordFields fields(record.content);
  Expected<void> done;
  switch (record.opcode) {
    case mcap::kMessage:
      if (!is_in_chunk_) has_loose_messages_ = true;
      if (!is_in_summary_) return read_message(record.content);
      break;
    case mcap::kSchema:
      done = read_schema(record.content);
      break;
    case mcap::kChannel:
      done = read_channel(record.content);
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

Expected<void> McapReader::read_schema(Bytes content) {
  const std::optional<mcap::SchemaContent> read = mcap::parse_schema(content);
  if (!read) return damaged("schema record that is not valid");
  Schema schema{.name = std::string(read->name),
                .encoding = std::string(read->encoding),
                .data = std::string(read->data)};
  Schema& kept = schemas_[read->id];  // writers repeat them
  schema_bytes_ += schema.size();
  schema_bytes_ -= std::exchange(kept, std::move(schema)).size();
  if (schema_bytes_ > kMaxTopicBytes) return damaged("schemas of more than 64 MiB");
  return {};
}

Expected<void> McapReader::read_channel(Bytes content) {
  const std::optional<mcap::ChannelContent> read = mcap::parse_channel(content);
  if (!read) return damaged("channel record that is not valid");
  BagTopic topic;
  topic.name = read->topic;
  topic.encoding = read->message_encoding;
  if (read->schema != 0) {
    const auto schema = schemas_.find(read->schema);
    if (schema == schemas_.end()) {
      return damaged("channel '" + topic.name.substr(0, 80) + "' of schema " +
                     std::to_string(read->schema) + ", which is absent");
    }
    topic.type = schema->second.name;
    topic.schema_encoding = schema->second.encoding;
    topic.schema = schema->second.data;
  }
  const Expected<std::size_t> index = add_topic(std::move(topic));
  if (!index) return index.error();
  channels_[read->id] = *index;
  return {};
}

Expected<std::optional<BagMessage>> McapReader::read_message(Bytes content) {
  const std::optional<mcap::MessageContent> read = mcap::parse_message(content);
  if (!read) return damaged("message record that is not valid");
  const auto channel = channels_.find(read->channel);
  if (channel == channels_.end()) {
    return damaged("message of channel " + std::to_string(read->channel) + ", which is absent");
  }
  const Stamp stamp = mcap::stamp_of(read->log_time);
  if (const auto error = check_log_time(stamp)) return damaged(error->message);
  ++messages_;
  return std::optional(BagMessage{.topic = channel->second,
                                  .log_time = stamp,
                                  .publish_time = mcap::stamp_of(read->publish_time),
                                  .payload = read->data});
}

Expected<void> McapReader::enter_chunk(RecordFields fields) {
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

void McapReader::check_statistics(RecordFields fields) {
  const auto count = fields.integer<std::uint64_t>();
  if (!fields.is_valid() || count == messages_) return;
  warn("states " + std::to_string(count) + " messages, but has " + std::to_string(messages_));
}

/// Keeps the drops that the recorder counted; each such record replaces the last. One that is not
/// valid is ignored, as all other metadata.
void McapReader::read_metadata(RecordFields fields) {
  if (fields.text() != mcap::kDropsMetadata) return;
  const std::optional<mcap::TextMap> entries = mcap::parse_text_map(fields.sized());
  if (!entries) return;
  std::vector<std::pair<std::string, std::uint64_t>> drops;
  for (const auto& [topic, text] : *entries) {
    std::uint64_t count = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (code != std::errc{} || end != text.data() + text.size()) return;
    if (count > 0) drops.emplace_back(printable_name(topic), count);
  }
  drops_ = std::move(drops);
}

void McapReader::state_drops() {
  constexpr std::size_t kMaxStated = 20;
  for (std::size_t i = 0; i < std::min(drops_.size(), kMaxStated); ++i) {
    warn(std::to_string(drops_[i].second) + " messages of " + drops_[i].first +
         " were dropped while it was recorded");
  }
}

std::optional<McapRecord> McapReader::end_cut() {
  state_drops();
  return finish_cut();
}

Expected<void> McapReader::read_footer(RecordFields fields) {
  state_drops();
  const auto summary_start = fields.integer<std::uint64_t>();
  (void)fields.integer<std::uint64_t>();  // offsets
  const auto crc = fields.integer<std::uint32_t>();
  is_end_ = true;
  if (!fields.is_valid()) return damaged("footer that is not valid");
  const std::uint64_t crc_end = record_at_ + mcap::kRecordHead + mcap::kFooterSize - 4;
  is_indexed_ = summary_start != 0;
  if (summary_start == 0 || crc == 0 || source_.is_ascending()) return {};
  if (summary_start > record_at_) {
    is_indexed_ = false;
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
  is_indexed_ = found == crc;
  if (found != crc) warn("the CRC of its summary differs; only its messages are used");
  return {};
}

Expected<bool> McapReader::is_whole() {
  if (!is_indexed_ || has_loose_messages_) return false;
  const std::size_t size = mcap::kMagic.size();
  if (offset_ + size != source_.stored_size()) return false;
  const Expected<Bytes> magic = source_.view(offset_, size);
  if (!magic) return magic.error();
  return std::equal(magic->begin(), magic->end(), mcap::kMagic.begin());
}

std::uint64_t McapReader::unread_bytes() const {
  const std::uint64_t size = source_.stored_size();
  if (!is_record_of_chunk_) return size - record_at_;
  // What is left of a chunk is known unpacked: no more than the chunk has in the file.
  return std::min(size - offset_ + chunk_left_, size - record_at_);
}

Expected<void> check_mcap_magic(ByteSource& source) {
  const Expected<std::uint64_t> size = source.available(0, mcap::kMagic.size());
  if (!size) return size.error();
  bool is_mcap = *size == mcap::kMagic.size();
  if (is_mcap) {
    const Expected<Bytes> magic = source.view(0, mcap::kMagic.size());
    if (!magic) return magic.error();
    is_mcap = std::equal(magic->begin(), magic->end(), mcap::kMagic.begin());
  }
  if (is_mcap) return {};
  return Error{.message = "is not an MCAP file of version 0: its first 8 bytes differ",
               .file = source.name(),
               .hint = "check that this is the intended file"};
}

Expected<std::unique_ptr<BagReader>> open_mcap(ByteSource source) {
  const Expected<void> checked = check_mcap_magic(source);
  if (!checked) return checked.error();
  return std::unique_ptr<BagReader>(std::make_unique<McapReader>(std::move(source)));
}

}  // namespace pcavr
