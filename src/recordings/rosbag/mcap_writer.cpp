// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>
#include <map>

#include <fcntl.h>
#include <libdeflate.h>
#include <unistd.h>

#include "pcavr/base/core/check.hpp"

#include "recordings/rosbag/mcap_format.hpp"
#include "recordings/rosbag/mcap_records.hpp"
#include "recordings/rosbag/open_file.hpp"

namespace pcavr {
namespace {

using Clock = std::chrono::steady_clock;

struct ChunkIndexEntry {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t offset = 0, length = 0;                    ///< of the chunk's record
  std::map<std::uint16_t, std::uint64_t> message_indexes;  ///< offset, by channel
  std::uint64_t message_indexes_length = 0;
  std::uint64_t size = 0;
};

/// Keys and values as the content of a map field.
std::string text_table(const McapWriter::Metadata& entries) {
  mcap::RecordText text;
  for (const auto& [key, value] : entries) text.text(key).text(value);
  return text.bytes();
}

}  // namespace

struct McapWriter::State {
  std::filesystem::path path;
  McapWriterOptions options;
  OpenFile file;
  std::uint64_t offset = 0;                    ///< bytes written
  std::uint32_t data_crc = 0;                  ///< of these
  std::vector<std::string> schemas, channels;  ///< their records, by id; schemas from 1
  // The chunk in memory.
  std::string chunk;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_messages;
  Clock::time_point chunk_begin;
  std::vector<ChunkIndexEntry> chunks;
  std::vector<std::string> metadata_indexes;  ///< their records
  std::map<std::uint16_t, std::uint64_t> counts;
  std::uint64_t messages = 0;
  std::uint64_t first_time = std::numeric_limits<std::uint64_t>::max(), last_time = 0;
  bool is_closed = false;

  /// Appends to the file. After a failure the writer stays closed: what follows would be
  /// unreadable.
  Expected<void> append(std::string_view bytes);
  Expected<void> write_chunk();
  Expected<void> write_summary();
};

Expected<void> McapWriter::State::append(std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(file.get(), bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      is_closed = true;
      return Error{.message = std::string("can't be written: ") + std::strerror(errno),
                   .file = path.string(),
                   .hint = "free space on the disk, or choose another folder"};
    }
    done += static_cast<std::size_t>(count);
  }
  data_crc = libdeflate_crc32(data_crc, bytes.data(), bytes.size());
  offset += bytes.size();
  return {};
}

Expected<void> McapWriter::State::write_chunk() {
  if (chunk.empty()) return {};
  ChunkIndexEntry entry{.offset = offset, .message_indexes = {}, .size = chunk.size()};
  if (!chunk_messages.empty()) entry.start_time = std::numeric_limits<std::uint64_t>::max();
  for (const auto& [channel, messages_of] : chunk_messages) {
    for (const auto& [time, at] : messages_of) {
      entry.start_time = std::min(entry.start_time, time);
      entry.end_time = std::max(entry.end_time, time);
    }
  }
  mcap::RecordText head;
  head.integer(entry.start_time).integer(entry.end_time).integer(std::uint64_t{chunk.size()});
  head.integer(libdeflate_crc32(0, chunk.data(), chunk.size())).text("");
  head.integer(std::uint64_t{chunk.size()});
  std::string bytes =
      mcap::record_head(mcap::kChunk, head.bytes().size() + chunk.size()) + head.bytes() + chunk;
  entry.length = bytes.size();
  for (const auto& [channel, messages_of] : chunk_messages) {
    entry.message_indexes[channel] = offset + bytes.size();
    mcap::RecordText index;
    index.integer(channel).integer(static_cast<std::uint32_t>(16 * messages_of.size()));
    for (const auto& [time, at] : messages_of) index.integer(time).integer(at);
    bytes += index.record(mcap::kMessageIndex);
  }
  entry.message_indexes_length = bytes.size() - entry.length;
  chunk.clear();
  chunk_messages.clear();
  chunks.push_back(std::move(entry));
  return append(bytes);
}

Expected<void> McapWriter::State::write_summary() {
  std::string bytes = mcap::RecordText().integer(data_crc).record(mcap::kDataEnd);
  const std::uint64_t summary_start = offset + bytes.size();
  const std::size_t summary_in_bytes = bytes.size();
  std::string offsets;
  const auto add_group = [&](std::uint8_t opcode, const std::string& group) {
    if (group.empty()) return;
    mcap::RecordText entry;
    entry.integer(opcode).integer(std::uint64_t{offset + bytes.size()});
    entry.integer(std::uint64_t{group.size()});
    offsets += entry.record(mcap::kSummaryOffset);
    bytes += group;
  };
  std::string group;
  for (const std::string& record : schemas) group += record;
  add_group(mcap::kSchema, group);
  group.clear();
  for (const std::string& record : channels) group += record;
  add_group(mcap::kChannel, group);
  mcap::RecordText statistics;
  statistics.integer(messages).integer(static_cast<std::uint16_t>(schemas.size()));
  statistics.integer(static_cast<std::uint32_t>(channels.size()));
  statistics.integer(std::uint32_t{0});  // attachments
  statistics.integer(static_cast<std::uint32_t>(metadata_indexes.size()));
  statistics.integer(static_cast<std::uint32_t>(chunks.size()));
  statistics.integer(messages > 0 ? first_time : 0).integer(last_time).table(counts);
  add_group(mcap::kStatistics, statistics.record(mcap::kStatistics));
  group.clear();
  for (const ChunkIndexEntry& entry : chunks) {
    mcap::RecordText index;
    index.integer(entry.start_time).integer(entry.end_time);
    index.integer(entry.offset).integer(entry.length).table(entry.message_indexes);
    index.integer(entry.message_indexes_length).text("");
    index.integer(entry.size).integer(entry.size);
    group += index.record(mcap::kChunkIndex);
  }
  add_group(mcap::kChunkIndex, group);
  group.clear();
  for (const std::string& record : metadata_indexes) group += record;
  add_group(mcap::kMetadataIndex, group);
  const std::uint64_t offsets_start = offset + bytes.size();
  bytes += offsets;
  bytes += mcap::record_head(mcap::kFooter, mcap::kFooterSize);
  bytes += mcap::RecordText().integer(summary_start).integer(offsets_start).bytes();
  const std::uint32_t crc =
      libdeflate_crc32(0, bytes.data() + summary_in_bytes, bytes.size() - summary_in_bytes);
  bytes += mcap::RecordText().integer(crc).bytes();
  bytes.append(mcap::kMagic.begin(), mcap::kMagic.end());
  return append(bytes);
}

McapWriter::McapWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
McapWriter::McapWriter(McapWriter&&) noexcept = default;
McapWriter& McapWriter::operator=(McapWriter&&) noexcept = default;

McapWriter::~McapWriter() {
  if (state_) (void)close();
}

Expected<McapWriter> McapWriter::create(const std::filesystem::path& file,
                                        const McapWriterOptions& options) {
  PCAVR_REQUIRE(options.max_chunk > 0 && options.flush_interval >= 0.0, options.flush_interval);
  auto state = std::make_unique<State>();
  state->path = file;
  state->options = options;
  const int flags = O_WRONLY | O_CREAT | O_CLOEXEC | (options.replace ? O_TRUNC : O_EXCL);
  state->file = OpenFile(::open(file.c_str(), flags, 0666));
  if (!state->file.is_open()) {
    const bool is_there = errno == EEXIST;
    return Error{
        .message =
            is_there ? "already exists" : std::string("can't be written: ") + std::strerror(errno),
        .file = file.string(),
        .hint = is_there ? "choose another name" : "choose a folder that you may write to"};
  }
  std::string start(mcap::kMagic.begin(), mcap::kMagic.end());
  start += mcap::RecordText().text(options.profile).text("pcavr").record(mcap::kHeader);
  if (const Expected<void> written = state->append(start); !written) return written.error();
  return McapWriter(std::move(state));
}

std::uint16_t McapWriter::add_schema(std::string_view name, std::string_view encoding,
                                     std::string_view data) {
  PCAVR_REQUIRE(state_->schemas.size() < 65535);
  const auto id = static_cast<std::uint16_t>(state_->schemas.size() + 1);
  state_->schemas.push_back(
      mcap::RecordText().integer(id).text(name).text(encoding).text(data).record(mcap::kSchema));
  if (state_->chunk.empty()) state_->chunk_begin = Clock::now();
  state_->chunk += state_->schemas.back();
  return id;
}

std::uint16_t McapWriter::add_channel(std::string_view topic, std::string_view message_encoding,
                                      std::uint16_t schema, const Metadata& metadata) {
  PCAVR_REQUIRE(state_->channels.size() < 65536);
  PCAVR_REQUIRE(schema <= state_->schemas.size(), static_cast<int>(schema));
  const auto id = static_cast<std::uint16_t>(state_->channels.size());
  mcap::RecordText record;
  record.integer(id).integer(schema).text(topic).text(message_encoding).text(text_table(metadata));
  state_->channels.push_back(record.record(mcap::kChannel));
  if (state_->chunk.empty()) state_->chunk_begin = Clock::now();
  state_->chunk += state_->channels.back();
  return id;
}

Expected<void> McapWriter::write(std::uint16_t channel, Stamp log_time,
                                 std::span<const std::uint8_t> payload,
                                 std::optional<Stamp> publish_time,
                                 std::optional<std::uint32_t> sequence) {
  const Stamp published = publish_time.value_or(log_time);
  PCAVR_REQUIRE(channel < state_->channels.size(), static_cast<int>(channel));
  PCAVR_REQUIRE(log_time.nanoseconds >= 0 && published.nanoseconds >= 0);
  if (state_->is_closed) {
    return Error{.message = "is closed after an error", .file = state_->path.string()};
  }
  State& state = *state_;
  const auto time = static_cast<std::uint64_t>(log_time.nanoseconds);
  if (state.chunk.empty()) state.chunk_begin = Clock::now();
  state.chunk_messages[channel].emplace_back(time, state.chunk.size());
  mcap::RecordText head;
  const auto count = static_cast<std::uint32_t>(state.counts[channel]++);
  head.integer(channel).integer(sequence.value_or(count));
  head.integer(time).integer(static_cast<std::uint64_t>(published.nanoseconds));
  state.chunk += mcap::record_head(mcap::kMessage, head.bytes().size() + payload.size());
  state.chunk += head.bytes();
  state.chunk.append(reinterpret_cast<const char*>(payload.data()), payload.size());
  ++state.messages;
  state.first_time = std::min(state.first_time, time);
  state.last_time = std::max(state.last_time, time);
  return state.chunk.size() >= state.options.max_chunk ? flush() : flush_if_due();
}

Expected<void> McapWriter::write(std::uint16_t channel, Stamp log_time, std::string_view payload,
                                 std::optional<Stamp> publish_time) {
  return write(channel, log_time,
               std::span(reinterpret_cast<const std::uint8_t*>(payload.data()), payload.size()),
               publish_time);
}

Expected<void> McapWriter::write_metadata(std::string_view name, const Metadata& entries) {
  if (const Expected<void> written = flush(); !written) return written;
  if (state_->is_closed) {
    return Error{.message = "is closed after an error", .file = state_->path.string()};
  }
  const std::string record =
      mcap::RecordText().text(name).text(text_table(entries)).record(mcap::kMetadata);
  mcap::RecordText index;
  index.integer(state_->offset).integer(std::uint64_t{record.size()}).text(name);
  state_->metadata_indexes.push_back(index.record(mcap::kMetadataIndex));
  return state_->append(record);
}

Expected<void> McapWriter::write_dropped(const std::map<std::string, std::uint64_t>& dropped) {
  Metadata entries;
  for (const auto& [topic, count] : dropped) entries.emplace_back(topic, std::to_string(count));
  return write_metadata(mcap::kDropsMetadata, entries);
}

Expected<void> McapWriter::flush() {
  return state_->is_closed ? Expected<void>() : state_->write_chunk();
}

Expected<void> McapWriter::flush_if_due() {
  if (state_->chunk.empty()) return {};
  const std::chrono::duration<double> waited = Clock::now() - state_->chunk_begin;
  return waited.count() >= state_->options.flush_interval ? flush() : Expected<void>();
}

Expected<void> McapWriter::close() {
  if (state_->is_closed) return {};
  if (const Expected<void> written = flush(); !written) return written;
  const Expected<void> written = state_->write_summary();
  state_->is_closed = true;
  state_->file = OpenFile();
  return written;
}

std::uint64_t McapWriter::message_count() const { return state_->messages; }
std::uint64_t McapWriter::bytes_written() const { return state_->offset; }

}  // namespace pcavr
