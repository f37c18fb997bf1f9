// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <sys/mman.h>
#include <unistd.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"

#include "fuzz/targets.hpp"
#include "recordings/rosbag/byte_source.hpp"
#include "recordings/rosbag/mcap_reader.hpp"
#include "recordings/rosbag/open_file.hpp"
#include "recordings/rosbag/ros1_bag_reader.hpp"
#include "recordings/rosbag/sqlite_bag_reader.hpp"

namespace pcavr::fuzz {
namespace {

void require_reason(const Error& error) {
  PCAVR_REQUIRE(error.file == "the-file" && !error.message.empty(), error.to_string());
}

/// Reads all messages; each belongs to a topic.
void read_to_the_end(Expected<std::unique_ptr<BagReader>> reader) {
  if (!reader) return require_reason(reader.error());
  for (;;) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) require_reason(message.error());
    if (!message || !*message) break;
    PCAVR_REQUIRE((*message)->topic < (*reader)->topics().size());
    (void)decode_ros_message((*reader)->topics()[(*message)->topic], (*message)->payload);
  }
  const Expected<std::optional<BagMessage>> after = (*reader)->next();
  PCAVR_REQUIRE(after.has_value() && !after->has_value());
}

std::span<const std::uint8_t> span_of(std::string_view bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

}  // namespace

void mcap(std::string_view bytes) {
  read_to_the_end(open_mcap(ByteSource(span_of(bytes), "the-file")));
}

void ros1_bag(std::string_view bytes) {
  read_to_the_end(open_ros1_bag(ByteSource(span_of(bytes), "the-file")));
}

void sqlite_bag(std::string_view bytes) {
  // A file without a name in memory.
  const OpenFile file(::memfd_create("fuzz", MFD_CLOEXEC));
  PCAVR_REQUIRE(file.is_open());
  const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
  PCAVR_REQUIRE(written == static_cast<ssize_t>(bytes.size()), written);
  read_to_the_end(open_sqlite_bag(file, "the-file"));
}

void ros_message(std::string_view bytes) {
  constexpr const char* kTypes[] = {
      "sensor_msgs/Image",          "sensor_msgs/CompressedImage", "sensor_msgs/CameraInfo",
      "sensor_msgs/JointState",     "geometry_msgs/PoseStamped",   "nav_msgs/Odometry",
      "geometry_msgs/PointStamped", "geometry_msgs/WrenchStamped", "geometry_msgs/TransformStamped",
      "tf2_msgs/TFMessage"};
  if (bytes.empty()) return;
  const auto selected = static_cast<std::uint8_t>(bytes[0]);
  const BagTopic topic{.name = "/t",
                       .type = kTypes[(selected / 2) % std::size(kTypes)],
                       .encoding = selected % 2 == 0 ? "ros1" : "cdr",
                       .schema_encoding = {},
                       .schema = {}};
  const Expected<RosMessage> message = decode_ros_message(topic, span_of(bytes.substr(1)));
  if (!message) {
    PCAVR_REQUIRE(!message.error().message.empty());
    return;
  }
  if (const auto* image = std::get_if<RosImage>(&*message)) {
    PCAVR_REQUIRE(image->width > 0 && image->height > 0, image->width, image->height);
    PCAVR_REQUIRE(image->data.size() >=
                  std::uint64_t{image->step} * static_cast<std::uint64_t>(image->height));
  }
}

}  // namespace pcavr::fuzz
