// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/rosbag/ros1_bag_reader.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "recordings/rosbag/chunked_reader.hpp"
#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/ros1_fields.hpp"

namespace pcavr {
namespace {

using Ros1Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
constexpr const char* kRos1Hint = "the file is damaged; try 'rosbag reindex', or copy it again";
/// Largest size of a record's header [bytes], which has a few short fields.
constexpr std::uint32_t kMaxRos1Header = 1U << 20;

enum Ros1Op : std::uint8_t {
  kRos1Message = 2,
  kRos1BagHeader = 3,
  kRos1Chunk = 5,
  kRos1ChunkInfo = 6,
  kRos1Connection = 7,
};

struct Ros1Record {
  std::uint8_t op = 0;
  Ros1Fields fields;
  Ros1Bytes data;
};

class Ros1BagReader final : public ChunkedReader<Ros1Record> {
 public:
  explicit Ros1BagReader(ByteSource source)
      : ChunkedReader(std::move(source), kRos1Magic.size(), kRos1Hint) {}

 private:
  std::optional<Ros1Record> finish() {
    is_end_ = true;
    if (has_counts_ && counted_ != messages_) {
      warn("its index counts " + std::to_string(counted_) + " messages, but it has " +
           std::to_string(messages_));
    }
    return std::nullopt;
  }

  /// Bytes that are no record: before the index they are skipped.
  Expected<std::optional<Ros1Record>> skip_to_index() {
    if (index_at_ > record_at_) {
      const std::uint64_t skipped = index_at_ - record_at_;
      const Expected<std::uint64_t> there = source_.skip(record_at_, skipped);
      if (!there) return there.error();
      offset_ = index_at_;
      if (*there == skipped) return std::optional<Ros1Record>();
    }
    return damaged("record without fields");
  }

  Expected<std::optional<Ros1Record>> next_of_file() override {
    record_at_ = offset_;
    const Expected<std::uint64_t> there = source_.available(offset_, 8);
    if (!there) return there.error();
    if (*there == 0) {
      // An index of no connection and no chunk is empty: it begins where the file ends.
      if (index_at_ > offset_ || (index_at_ == offset_ && !is_empty_)) return finish_cut();
      if (index_at_ == 0) warn("was not closed by its recorder, and may lack its last messages");
      return finish();
    }
    if (*there < 8) return finish_cut();
    const Expected<std::uint32_t> header_size = size_at(offset_);
    if (!header_size) return header_size.error();
    if (*header_size == 0) return skip_to_index();
    if (*header_size > kMaxRos1Header)
      return damaged("record header of " + std::to_string(*header_size) + " bytes");
    const std::uint64_t head = 8 + std::uint64_t{*header_size};
    const Expected<std::uint64_t> head_there = source_.available(offset_, head);
    if (!head_there) return head_there.error();
    if (*head_there < head) return finish_cut();
    const Expected<std::uint32_t> data_size = size_at(offset_ + head - 4);
    if (!data_size) return data_size.error();
    if (*data_size > kMaxBagRecord) {
      return damaged("record of " + std::to_string(*data_size) +
                     " bytes, but 1 GiB is the maximum");
    }
    const Expected<std::uint64_t> whole = source_.available(offset_, head + *data_size);
    if (!whole) return whole.error();
    is_cut_ = *whole < head + *data_size;
    offset_ += *whole;
    const Expected<Ros1Bytes> bytes = source_.view(record_at_, static_cast<std::size_t>(*whole));
    if (!bytes) return bytes.error();
    return record_of(bytes->subspan(4, *header_size), bytes->subspan(8 + *header_size));
  }

  Expected<std::uint32_t> size_at(std::uint64_t offset) {
    const Expected<Ros1Bytes> bytes = source_.view(offset, 4);
    if (!bytes) return bytes.error();
    return RecordFields(*bytes).integer<std::uint32_t>();
  }

  Expected<std::optional<Ros1Record>> record_of(Ros1Bytes header, Ros1Bytes data) const {
    const std::optional<Ros1Fields> fields = Ros1Fields::parse(header);
    const std::optional<std::uint8_t> op =
        fields ? fields->integer<std::uint8_t>("op") : std::nullopt;
    if (!op) return damaged("record whose header has no field op");
    return std::optional(Ros1Record{*op, *fields, data});
  }

  Expected<std::optional<Ros1Record>> next_of_chunk() override {
    RecordFields rest(chunk_);
    const Ros1Bytes header = rest.sized();
    const Ros1Bytes data = rest.sized();
    if (chunk_.empty() || !rest.is_valid()) {
      if (!chunk_.empty() && !is_cut_) return damaged("record that exceeds its chunk");
      is_in_chunk_ = false;
      if (is_cut_) return finish_cut();
      return std::optional<Ros1Record>();
    }
    chunk_ = rest.rest();
    return record_of(header, data);
  }

  Expected<std::optional<BagMessage>> handle(const Ros1Record& record) override {
    Expected<void> done;
    if (is_cut_ && !is_in_chunk_ && record.op != kRos1Chunk) {
      finish_cut();
      return std::optional<BagMessage>();
    }
    switch (record.op) {
      case kRos1Message:
        return read_message(record);
      case kRos1BagHeader:
        done = read_bag_header(record);
        break;
      case kRos1Chunk:
        if (is_in_chunk_) return damaged("chunk in a chunk");
        done = enter_chunk(record);
        break;
      case kRos1ChunkInfo:
        count_messages(record);
        break;
      case kRos1Connection:
        done = read_connection(record);
        break;
      default:
        break;
    }
    if (!done) return done.error();
    return std::optional<BagMessage>();
  }

  Expected<void> read_bag_header(const Ros1Record& record) {
    const std::string_view encryptor = record.fields.text("encryptor").value_or("");
    if (!encryptor.empty()) {
      return Error{.message = "is encrypted with '" + std::string(encryptor.substr(0, 80)) + "'",
                   .file = source_.name(),
                   .hint = "decrypt it with 'rosbag decrypt'"};
    }
    index_at_ = record.fields.integer<std::uint64_t>("index_pos").value_or(0);
    is_empty_ = record.fields.integer<std::uint32_t>("conn_count") == 0U &&
                record.fields.integer<std::uint32_t>("chunk_count") == 0U;
    return {};
  }

  Expected<void> read_connection(const Ros1Record& record) {
    const auto id = record.fields.integer<std::uint32_t>("conn");
    const std::optional<Ros1Fields> details = Ros1Fields::parse(record.data);
    if (!id || !details) return damaged("connection that is not valid");
    BagTopic topic{.name = std::string(record.fields.text("topic").value_or("")),
                   .type = std::string(details->text("type").value_or("")),
                   .encoding = "ros1",
                   .schema_encoding = "ros1msg",
                   .schema = std::string(details->text("message_definition").value_or(""))};
    if (topic.name.empty()) topic.name = details->text("topic").value_or("");
    const Expected<std::size_t> index = add_topic(std::move(topic));
    if (!index) return index.error();
    connections_[*id] = *index;
    return {};
  }

  Expected<std::optional<BagMessage>> read_message(const Ros1Record& record) {
    const auto id = record.fields.integer<std::uint32_t>("conn");
    const auto time = record.fields.integer<std::uint64_t>("time");
    if (!id || !time) return damaged("message without connection or time");
    const auto connection = connections_.find(*id);
    if (connection == connections_.end()) {
      return damaged("message of connection " + std::to_string(*id) + ", which is absent");
    }
    ++messages_;
    const auto seconds = static_cast<std::int64_t>(*time & 0xFFFFFFFFU);
    const auto nanoseconds = static_cast<std::int64_t>(*time >> 32U);
    const Stamp stamp{seconds * 1'000'000'000 + nanoseconds};
    return std::optional(BagMessage{.topic = connection->second,
                                    .log_time = stamp,
                                    .publish_time = stamp,
                                    .payload = record.data});
  }

  Expected<void> enter_chunk(const Ros1Record& record) {
    const auto size = record.fields.integer<std::uint32_t>("size");
    const auto compression = parse_compression(record.fields.text("compression").value_or(""));
    if (!size) return damaged("chunk without size");
    if (!compression) return damaged(compression.error().message);
    if (const Expected<void> checked = check_chunk_size(*size); !checked) return checked;
    const Expected<void> unpacked = decompress_chunk(
        *compression, record.data, {.size = *size, .may_be_cut = is_cut_}, unpacked_);
    if (!unpacked) return damaged(unpacked.error().message);
    chunk_ = unpacked_;
    is_in_chunk_ = true;
    return {};
  }

  /// The counts by connection in the index of a chunk.
  void count_messages(const Ros1Record& record) {
    RecordFields rest(record.data);
    while (!rest.is_at_end()) {
      (void)rest.integer<std::uint32_t>();
      counted_ += rest.integer<std::uint32_t>();
    }
    has_counts_ = true;
  }

  std::map<std::uint32_t, std::size_t> connections_;  ///< index of the topic
  std::uint64_t index_at_ = 0;                        ///< 0: the bag was not closed
  std::uint64_t counted_ = 0;                         ///< by the index
  bool has_counts_ = false;
  bool is_empty_ = false;  ///< by the bag's header
  bool is_cut_ = false;    ///< the record at record_at_ ends with the file
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_ros1_bag(ByteSource source) {
  const Expected<std::uint64_t> size = source.available(0, kRos1Magic.size());
  if (!size) return size.error();
  const Expected<Ros1Bytes> magic = source.view(0, static_cast<std::size_t>(*size));
  if (!magic) return magic.error();
  if (text_of(*magic) != kRos1Magic) {
    const bool is_older = text_of(*magic).starts_with("#ROSBAG V");
    return Error{
        .message = is_older ? "is a ROS 1 bag of another version than 2.0"
                            : "is not a ROS 1 bag: its first line is not '#ROSBAG V2.0'",
        .file = source.name(),
        .hint = is_older ? "convert it with 'rosbag fix'" : "check that this is the intended file"};
  }
  return std::unique_ptr<BagReader>(std::make_unique<Ros1BagReader>(std::move(source)));
}

}  // namespace pcavr
