// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/stamp.hpp"

namespace pcavr {

/// A topic of a bag. Connections or channels of one topic with the same type and encoding are one.
struct BagTopic {
  std::string name;             ///< as written; a leading slash may be absent
  std::string type;             ///< as written: "sensor_msgs/Image", "sensor_msgs/msg/Image"
  std::string encoding;         ///< of the payload: "ros1", "cdr", "json", ...
  std::string schema_encoding;  ///< "ros1msg", "ros2msg", "jsonschema"; empty where not stated
  std::string schema;           ///< the definition of the type; empty where not stated

  friend bool operator==(const BagTopic&, const BagTopic&) = default;
};

struct BagMessage {
  std::size_t topic = 0;                  ///< index in BagReader::topics()
  Stamp log_time;                         ///< when the recorder received it; in ranges::kStamp
  Stamp publish_time;                     ///< = log_time where the format has none
  std::span<const std::uint8_t> payload;  ///< valid until the next call of next()
};

/// Reads the messages of a bag one after another, in the order of the file, which need not be that
/// of time. Holds one chunk at a time. Not thread-safe.
class BagReader {
 public:
  BagReader() = default;
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;
  virtual ~BagReader() = default;

  /// The next message; nullopt at the end. After an Error the reader is at its end.
  [[nodiscard]] virtual Expected<std::optional<BagMessage>> next() = 0;

  /// The topics found up to now; complete, with those that have no message, at the end.
  [[nodiscard]] virtual const std::vector<BagTopic>& topics() const = 0;

  /// Found up to now, one line each: the file is cut, its statistics differ from its messages.
  [[nodiscard]] virtual const std::vector<std::string>& warnings() const = 0;
};

/// Whether `path` looks like a bag, by name or first bytes: a file .bag, .mcap or .db3 (also
/// packed: .bz2, .zst, .zstd), or a folder with such .mcap or .db3 files.
[[nodiscard]] bool is_bag(const std::filesystem::path& path);

/// Opens a ROS 1 bag (version 2.0), an MCAP file, a rosbag2 SQLite database or a rosbag2 folder.
/// Packed files are unpacked as they are read, a packed database to a temporary file that has no
/// name. Nothing is written beside the bag. Safe for untrusted files: memory, time and space are
/// bounded by the file's size.
[[nodiscard]] Expected<std::unique_ptr<BagReader>> open_bag(const std::filesystem::path& path);

}  // namespace pcavr
