// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <utility>

#include "pcavr/recordings/rosbag/bag_reader.hpp"

#include "recordings/rosbag/bag_folder.hpp"
#include "recordings/rosbag/decompression.hpp"
#include "recordings/rosbag/mcap_reader.hpp"
#include "recordings/rosbag/record_fields.hpp"
#include "recordings/rosbag/ros1_bag_reader.hpp"
#include "recordings/rosbag/sqlite_bag_reader.hpp"
#include "recordings/rosbag/topic_table.hpp"
#include "recordings/rosbag/unpacked_file.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

enum class BagFormat { mcap, ros1, sqlite, zstd, bz2, unknown };

BagFormat format_by_start(std::string_view start) {
  if (start.starts_with("\x89MCAP")) return BagFormat::mcap;
  if (start.starts_with("#ROSBAG")) return BagFormat::ros1;
  if (start.starts_with("SQLite format 3")) return BagFormat::sqlite;
  if (start.starts_with("\x28\xB5\x2F\xFD")) return BagFormat::zstd;
  if (start.starts_with("BZh")) return BagFormat::bz2;
  return BagFormat::unknown;
}

/// The format that the name states, for files whose first bytes are wrong: their reader then
/// reports that.
BagFormat format_by_name(const std::string& name) {
  if (name.ends_with(".mcap")) return BagFormat::mcap;
  if (name.ends_with(".bag") || name.ends_with(".bag.active")) return BagFormat::ros1;
  if (name.ends_with(".db3")) return BagFormat::sqlite;
  return BagFormat::unknown;
}

Expected<BagFormat> find_format(ByteSource& source, const std::string& name) {
  const Expected<std::uint64_t> size = source.available(0, 16);
  if (!size) return size.error();
  const auto start = source.view(0, static_cast<std::size_t>(*size));
  if (!start) return start.error();
  const BagFormat format = format_by_start(text_of(*start));
  return format != BagFormat::unknown ? format : format_by_name(name);
}

Expected<std::unique_ptr<BagReader>> open_source(ByteSource source, BagFormat format) {
  if (format == BagFormat::mcap) return open_mcap(std::move(source));
  if (format == BagFormat::ros1) return open_ros1_bag(std::move(source));
  return Error{.message = "is no bag: neither a ROS 1 bag, nor MCAP, nor a rosbag2 database",
               .file = source.name(),
               .hint = "check that this is the intended file"};
}

/// SQLite reads here and there in its file; the other formats are read as they are unpacked.
Expected<std::unique_ptr<BagReader>> open_packed_database(ByteSource source) {
  const Expected<OpenFile> unpacked = unpack_database(source);
  if (!unpacked) return unpacked.error();
  return open_sqlite_bag(*unpacked, source.name());
}

Expected<std::unique_ptr<BagReader>> open_file(const fs::path& file) {
  Expected<ByteSource> source = ByteSource::open(file);
  if (!source) return source.error();
  Expected<BagFormat> format = find_format(*source, file.filename().string());
  if (!format) return format.error();
  const bool is_packed = *format == BagFormat::zstd || *format == BagFormat::bz2;
  if (is_packed) {
    Expected<ByteSource> inside = ByteSource::open_packed(
        file, *format == BagFormat::zstd ? Compression::zstd : Compression::bz2);
    if (!inside) return inside.error();
    format = find_format(*inside, file.stem().string());
    if (!format) return format.error();
    if (*format == BagFormat::sqlite) return open_packed_database(*std::move(inside));
    return open_source(*std::move(inside), *format);
  }
  if (*format == BagFormat::sqlite) return open_sqlite_bag(file, file.string());
  return open_source(*std::move(source), *format);
}

/// The files of a rosbag2 folder, one after another, with one list of topics.
class BagFolderReader final : public BagReader {
 public:
  explicit BagFolderReader(BagFolder folder) : folder_(std::move(folder)) {
    warnings_ = folder_.warnings;
  }

  Expected<std::optional<BagMessage>> next() override {
    while (!is_end_) {
      if (!reader_) {
        if (const Expected<void> opened = open_next(); !opened) return fail(opened.error());
        continue;
      }
      Expected<std::optional<BagMessage>> message = reader_->next();
      if (const Expected<void> updated = update_topics(); !updated) return fail(updated.error());
      if (!message) return fail(message.error());
      if (!*message) {
        for (const std::string& warning : reader_->warnings()) warnings_.push_back(warning);
        reader_.reset();
        continue;
      }
      (*message)->topic = topic_of_file_[(*message)->topic];
      if (folder_.is_message_compressed) {
        const Expected<void> unpacked = unpack((*message)->payload);
        if (!unpacked) return fail(unpacked.error());
        (*message)->payload = payload_;
      }
      return message;
    }
    return std::optional<BagMessage>();
  }

  const std::vector<BagTopic>& topics() const override { return topics_.topics(); }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  Error fail(Error error) {
    is_end_ = true;
    return error;
  }

  Expected<void> open_next() {
    is_end_ = next_file_ == folder_.files.size();
    if (is_end_) return {};
    Expected<std::unique_ptr<BagReader>> reader = open_file(folder_.files[next_file_++]);
    if (!reader) return reader.error();
    reader_ = *std::move(reader);
    topic_of_file_.clear();
    return update_topics();
  }

  Expected<void> update_topics() {
    const std::vector<BagTopic>& found = reader_->topics();
    while (topic_of_file_.size() < found.size()) {
      const Expected<std::size_t> index = topics_.add(found[topic_of_file_.size()]);
      if (!index) return Error{.message = index.error().message, .file = newest_file()};
      topic_of_file_.push_back(*index);
    }
    return {};
  }

  std::string newest_file() const { return folder_.files[next_file_ - 1].string(); }

  Expected<void> unpack(std::span<const std::uint8_t> packed) {
    payload_.clear();
    packed_bytes_ += packed.size();
    const std::uint64_t max_bytes =
        std::min(kMaxBagRecord, max_unpacked_size(packed_bytes_) - unpacked_bytes_);
    bool is_fed = false;
    const auto feed = [&]() -> Expected<std::span<const std::uint8_t>> {
      return std::exchange(is_fed, true) ? std::span<const std::uint8_t>() : packed;
    };
    const auto sink = [&](std::span<const std::uint8_t> piece) {
      payload_.insert(payload_.end(), piece.begin(), piece.end());
      return payload_.size() <= max_bytes;
    };
    const Expected<void> done = decompress_stream(Compression::zstd, feed, sink);
    if (done && payload_.size() <= max_bytes) {
      unpacked_bytes_ += payload_.size();
      return {};
    }
    return Error{.message = !done ? done.error().message
                                  : "compressed message of more than " + std::to_string(max_bytes) +
                                        " bytes",
                 .file = newest_file()};
  }

  BagFolder folder_;
  std::size_t next_file_ = 0;
  std::unique_ptr<BagReader> reader_;
  std::vector<std::size_t> topic_of_file_;  ///< index in topics_, by that of the file
  TopicTable topics_;
  std::vector<std::string> warnings_;
  std::vector<std::uint8_t> payload_;
  std::uint64_t packed_bytes_ = 0;  ///< of all messages up to now, where they are compressed
  std::uint64_t unpacked_bytes_ = 0;
  bool is_end_ = false;
};

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code code;
  if (fs::is_directory(path, code)) return is_bag_folder(path);
  const std::string name = path.filename().string();
  if (is_bag_name(name, {".bag", ".mcap", ".db3", ".bag.active"})) return true;
  Expected<ByteSource> source = ByteSource::open(path);
  if (!source) return false;
  const Expected<BagFormat> format = find_format(*source, name);
  return format && (*format == BagFormat::mcap || *format == BagFormat::ros1);
}

Expected<std::unique_ptr<BagReader>> open_bag(const fs::path& path) {
  std::error_code code;
  if (!fs::is_directory(path, code)) return open_file(path);
  Expected<BagFolder> folder = read_bag_folder(path);
  if (!folder) return folder.error();
  return std::unique_ptr<BagReader>(std::make_unique<BagFolderReader>(*std::move(folder)));
}

}  // namespace pcavr
