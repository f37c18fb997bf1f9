// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "rosbag/ros1_bag_reader.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "rosbag/chunked_reader.hpp"
#include "rosbag/decompression.hpp"
#include "rosbag/ros1_fields.hpp"

namespace pcavr {
namespace {

using Ros1Bytes = std::span<const std::uint8_t>;

constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
constexpr const char* kRos1Hint = "the file is damaged; try 'rosbag reindex', or copy it again";
/// Of a record's header: a few short fields.
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
    if (index_at_ > record_at_ && index_at_ <= source_.size()) {
      offset_ = index_at_;
      return std::optional<Ros1Record>();
    }
    return damaged("record without fields");
  }

  Expected<std::optional<Ros1Record>> next_of_file() override {
    record_at_ = offset_;
    std::uint64_t left = source_.size() - offset_;
    if (left == 0) {
      if (index_at_ >= source_.size()) return finish_cut();
      if (index_at_ == 0) warn("was not closed by its recorder, and may lack its last messages");
      return finish();
    }
    if (left < 8) return finish_cut();
    const Expected<std::uint32_t> header_size = size_at(offset_);
    if (!header_size) return header_size.error();
    if (*header_size == 0) return skip_to_index();
    if (*header_size > kMaxRos1Header)
      return damaged("record header of " + std::to_string(*header_size) + " bytes");
    if (left < 8 + std::uint64_t{*header_size}) return finish_cut();
    const std::uint64_t data_at = offset_ + 8 + *header_size;
    const Expected<std::uint32_t> data_size = size_at(data_at - 4);
    if (!data_size) return data_size.error();
    if (*data_size > kMaxBagRecord) {
      return damaged("record of " + std::to_string(*data_size) +
                     " bytes, but 1 GiB is the maximum");
    }
    left = source_.size() - data_at;
    const std::uint64_t size = std::min<std::uint64_t>(*data_size, left);
    is_cut_ = *data_size > left;
    offset_ = data_at + size;
    const std::size_t whole = 8 + *header_size + static_cast<std::size_t>(size);
    const Expected<Ros1Bytes> bytes = source_.view(record_at_, whole);
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
    connections_[*id] = topics_.add(topic);
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
    if (*size > kMaxBagRecord) {
      return damaged("chunk of " + std::to_string(*size) + " bytes, but 1 GiB is the maximum");
    }
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
  bool is_cut_ = false;  ///< the record at record_at_ ends with the file
};

}  // namespace

Expected<std::unique_ptr<BagReader>> open_ros1_bag(ByteSource source) {
  const std::size_t size = std::min<std::uint64_t>(source.size(), kRos1Magic.size());
  const Expected<Ros1Bytes> magic = source.view(0, size);
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
