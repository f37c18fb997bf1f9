// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <set>
#include <utility>

#include "pcavr/rosbag/bag_reader.hpp"

#include "rosbag/bag_folder.hpp"
#include "rosbag/decompression.hpp"
#include "rosbag/mcap_reader.hpp"
#include "rosbag/record_fields.hpp"
#include "rosbag/ros1_bag_reader.hpp"
#include "rosbag/sqlite_bag_reader.hpp"
#include "rosbag/topic_table.hpp"
#include "rosbag/unpacked_file.hpp"

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

/// By the name, for files whose first bytes are wrong: their reader then reports that.
BagFormat format_by_name(const std::string& name) {
  if (name.ends_with(".mcap")) return BagFormat::mcap;
  if (name.ends_with(".bag") || name.ends_with(".bag.active")) return BagFormat::ros1;
  if (name.ends_with(".db3")) return BagFormat::sqlite;
  return BagFormat::unknown;
}

Expected<BagFormat> find_format(const fs::path& file) {
  Expected<ByteSource> source = ByteSource::open(file);
  if (!source) return source.error();
  const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(source->size(), 16));
  const auto start = source->view(0, size);
  if (!start) return start.error();
  const BagFormat format = format_by_start(text_of(*start));
  return format != BagFormat::unknown ? format : format_by_name(file.filename().string());
}

/// The reader of an unpacked file, which lives as long.
class UnpackedBagReader final : public BagReader {
 public:
  UnpackedBagReader(OpenFile file, std::unique_ptr<BagReader> reader)
      : file_(std::move(file)), reader_(std::move(reader)) {}
  Expected<std::optional<BagMessage>> next() override { return reader_->next(); }
  const std::vector<BagTopic>& topics() const override { return reader_->topics(); }
  const std::vector<std::string>& warnings() const override { return reader_->warnings(); }

 private:
  OpenFile file_;
  std::unique_ptr<BagReader> reader_;
};

Expected<std::unique_ptr<BagReader>> open_unpacked(const fs::path& file, BagFormat format,
                                                   const std::string& name) {
  if (format == BagFormat::sqlite) return open_sqlite_bag(file, name);
  Expected<ByteSource> source = ByteSource::open(file, name);
  if (!source) return source.error();
  if (format == BagFormat::mcap) return open_mcap(*std::move(source));
  if (format == BagFormat::ros1) return open_ros1_bag(*std::move(source));
  return Error{.message = "is no bag: neither a ROS 1 bag, nor MCAP, nor a rosbag2 database",
               .file = name,
               .hint = "check that this is the intended file"};
}

Expected<std::unique_ptr<BagReader>> open_file(const fs::path& file) {
  const Expected<BagFormat> format = find_format(file);
  if (!format) return format.error();
  if (*format != BagFormat::zstd && *format != BagFormat::bz2) {
    return open_unpacked(file, *format, file.string());
  }
  Expected<OpenFile> unpacked =
      unpack_file(file, *format == BagFormat::zstd ? Compression::zstd : Compression::bz2);
  if (!unpacked) return unpacked.error();
  const fs::path path = "/proc/self/fd/" + std::to_string(unpacked->get());
  const Expected<BagFormat> inside = find_format(path);
  if (!inside) return inside.error();
  Expected<std::unique_ptr<BagReader>> reader = open_unpacked(path, *inside, file.string());
  if (!reader) return reader.error();
  return std::unique_ptr<BagReader>(
      std::make_unique<UnpackedBagReader>(*std::move(unpacked), *std::move(reader)));
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
      update_topics();
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
    update_topics();
    return {};
  }

  void update_topics() {
    const std::vector<BagTopic>& found = reader_->topics();
    while (topic_of_file_.size() < found.size()) {
      topic_of_file_.push_back(topics_.add(found[topic_of_file_.size()]));
    }
  }

  Expected<void> unpack(std::span<const std::uint8_t> packed) {
    payload_.clear();
    bool is_fed = false;
    const auto feed = [&]() -> Expected<std::span<const std::uint8_t>> {
      return std::exchange(is_fed, true) ? std::span<const std::uint8_t>() : packed;
    };
    const auto sink = [&](std::span<const std::uint8_t> piece) {
      payload_.insert(payload_.end(), piece.begin(), piece.end());
      return payload_.size() <= kMaxBagRecord;
    };
    const Expected<void> done = decompress_stream(Compression::zstd, feed, sink);
    if (done && payload_.size() <= kMaxBagRecord) return {};
    return Error{.message = done ? "compressed message of more than 1 GiB" : done.error().message,
                 .file = folder_.files[next_file_ - 1].string()};
  }

  BagFolder folder_;
  std::size_t next_file_ = 0;
  std::unique_ptr<BagReader> reader_;
  std::vector<std::size_t> topic_of_file_;  ///< index in topics_, by that of the file
  TopicTable topics_;
  std::vector<std::string> warnings_;
  std::vector<std::uint8_t> payload_;
  bool is_end_ = false;
};

}  // namespace

bool is_bag(const fs::path& path) {
  std::error_code code;
  if (fs::is_directory(path, code)) return is_bag_folder(path);
  const std::string name = path.filename().string();
  for (const char* ending : {".bag", ".mcap", ".db3", ".bag.active"}) {
    for (const char* packing : {"", ".bz2", ".zst", ".zstd"}) {
      if (name.ends_with(std::string(ending) + packing)) return true;
    }
  }
  const Expected<BagFormat> format = find_format(path);
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
