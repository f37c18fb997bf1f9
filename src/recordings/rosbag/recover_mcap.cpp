// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/rosbag/recover_mcap.hpp"

#include <map>
#include <string_view>
#include <utility>

#include "pcavr/base/core/output_file.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"

#include "recordings/rosbag/mcap_content.hpp"
#include "recordings/rosbag/mcap_format.hpp"
#include "recordings/rosbag/mcap_reader.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxIds = 65535;  // of schemas, and of channels, in a file

bool is_mcap_file(const fs::path& file) {
  Expected<ByteSource> source = ByteSource::open(file);
  return source && check_mcap_magic(*source);
}

/// The ids in the new file of what the old one calls by an id. A record that repeats an id with
/// other content is another one.
class NewIds {
 public:
  /// nullptr where the content is not known yet under this id.
  [[nodiscard]] const std::uint16_t* find(std::uint16_t id, std::string_view content) const {
    const auto entry = ids_.find(id);
    return entry != ids_.end() && entry->second.content == content ? &entry->second.id : nullptr;
  }
  [[nodiscard]] bool is_full() const { return added_ == kMaxIds; }
  void add(std::uint16_t id, std::string_view content, std::uint16_t new_id) {
    ids_[id] = {std::string(content), new_id};
    ++added_;
  }
  [[nodiscard]] std::uint16_t of(std::uint16_t id) const { return ids_.at(id).id; }

 private:
  struct Entry {
    std::string content;
    std::uint16_t id = 0;
  };
  std::map<std::uint16_t, Entry> ids_;
  std::size_t added_ = 0;
};

/// Writes each record that is read, and is sound, to another file.
class CopyingReader final : public McapReader {
 public:
  CopyingReader(ByteSource source, fs::path output)
      : McapReader(std::move(source)), output_(std::move(output)) {}

  /// Ends the copy, after the last message.
  [[nodiscard]] Expected<void> close() { return writer_ ? writer_->close() : Expected<void>(); }
  /// Why the copy could not be written.
  [[nodiscard]] const std::optional<Error>& write_error() const { return write_error_; }

 private:
  Expected<std::optional<BagMessage>> handle(const McapRecord& record) override {
    Expected<std::optional<BagMessage>> message = McapReader::handle(record);
    if (!message || is_in_summary() || write_error_) return message;
    if (!writer_) {
      if (const Expected<void> created = create(record); !created) return failed(created.error());
    }
    const Expected<void> copied = copy(record);
    if (!copied) return failed(copied.error());
    return message;
  }

  Error failed(Error error) {
    write_error_ = error;
    return error;
  }

  /// The first record, the header, has the profile.
  Expected<void> create(const McapRecord& record) {
    McapWriterOptions options;
    options.replace = true;        // the output's own empty file
    options.flush_interval = 1e9;  // chunks by size alone: the same bytes at each run
    if (record.opcode == mcap::kHeader) options.profile = RecordFields(record.content).text();
    Expected<McapWriter> writer = McapWriter::create(output_, options);
    if (!writer) return writer.error();
    writer_ = *std::move(writer);
    return {};
  }

  Expected<void> copy(const McapRecord& record) {
    switch (record.opcode) {
      case mcap::kSchema:
        return copy_schema(record.content);
      case mcap::kChannel:
        return copy_channel(record.content);
      case mcap::kMessage:
        return copy_message(record.content);
      case mcap::kMetadata:
        return copy_metadata(record.content);
      default:
        return {};
    }
  }

  Expected<void> copy_schema(Bytes content) {
    const auto schema = *mcap::parse_schema(content);  // the reader took it
    if (schemas_.find(schema.id, text_of(content)) != nullptr) return {};
    if (schemas_.is_full()) return damaged("more than 65535 schemas");
    schemas_.add(schema.id, text_of(content),
                 writer_->add_schema(schema.name, schema.encoding, schema.data));
    return {};
  }

  Expected<void> copy_channel(Bytes content) {
    const auto channel = *mcap::parse_channel(content);
    const std::uint16_t schema =
        channel.schema == 0 ? std::uint16_t{0} : schemas_.of(channel.schema);
    if (channels_.find(channel.id, text_of(content)) != nullptr) return {};
    if (channels_.is_full()) return damaged("more than 65535 channels");
    const auto metadata = mcap::parse_text_map(channel.metadata).value_or(mcap::TextMap());
    channels_.add(channel.id, text_of(content),
                  writer_->add_channel(channel.topic, channel.message_encoding, schema, metadata));
    return {};
  }

  Expected<void> copy_message(Bytes content) {
    const auto message = *mcap::parse_message(content);
    return writer_->write(channels_.of(message.channel), mcap::stamp_of(message.log_time),
                          message.data, mcap::stamp_of(message.publish_time), message.sequence);
  }

  Expected<void> copy_metadata(Bytes content) {
    RecordFields fields(content);
    const std::string_view name = fields.text();
    const auto entries = mcap::parse_text_map(fields.sized());
    if (!fields.is_valid() || !entries) return {};  // ignored by readers, too
    return writer_->write_metadata(name, *entries);
  }

  fs::path output_;
  std::optional<McapWriter> writer_;
  std::optional<Error> write_error_;
  NewIds schemas_, channels_;
};

/// Reads to the end, or to the first damage, and copies what comes before.
Expected<McapRecovery> copy_whole_records(CopyingReader& reader, std::uint64_t size) {
  McapRecovery recovery{.bytes = size};
  for (;;) {
    const Expected<std::optional<BagMessage>> message = reader.next();
    if (reader.write_error()) return *reader.write_error();
    if (!message) recovery.damage = message.error().place + ": " + message.error().message;
    if (!message || !*message) break;
    ++recovery.messages;
  }
  recovery.topics = reader.topics().size();
  recovery.left_out_attachments = reader.attachments();
  if (recovery.damage.empty()) {
    const Expected<bool> is_whole = reader.is_whole();
    if (!is_whole) return is_whole.error();
    recovery.is_whole = *is_whole;
  }
  // A cut or damaged summary loses nothing: it repeats what the data state.
  if (!recovery.is_whole && !reader.has_all_data()) {
    recovery.lost_bytes = reader.unread_bytes();
    recovery.lost_messages = reader.is_message_cut() ? 1 : 0;
    if (!recovery.damage.empty()) recovery.lost_messages.reset();
  }
  return recovery;
}

}  // namespace

Expected<McapRecovery> recover_mcap(const fs::path& file, const fs::path& output,
                                    const McapRecoveryOptions& options) {
  Expected<ByteSource> source = ByteSource::open(file);
  if (!source) return source.error();
  const std::uint64_t size = source->stored_size();
  if (const Expected<void> checked = check_mcap_magic(*source); !checked) return checked.error();
  std::error_code code;
  const bool is_input = fs::equivalent(file, output, code);
  Expected<OutputFile> target = OutputFile::create(output, {.replace = options.replace || is_input,
                                                            .kind = "MCAP file",
                                                            .is_replaceable = is_mcap_file});
  if (!target) return target.error();
  CopyingReader reader(*std::move(source), target->path());
  const Expected<McapRecovery> recovery = copy_whole_records(reader, size);
  if (!recovery || recovery->is_whole) return recovery;
  if (recovery->messages == 0) {
    return Error{.message = "has no whole message" +
                            (recovery->damage.empty() ? "" : "; " + recovery->damage),
                 .file = file.string(),
                 .hint = "there is nothing to recover; record it again"};
  }
  if (!recovery->damage.empty() && is_input && !options.replace) {
    return Error{.message = "is damaged before its end (" + recovery->damage +
                            "): replacing it would lose what comes after",
                 .file = file.string(),
                 .hint = "give another name with -o, or --force"};
  }
  if (const Expected<void> closed = reader.close(); !closed) return closed.error();
  if (const Expected<void> committed = target->commit(); !committed) return committed.error();
  return recovery;
}

}  // namespace pcavr
