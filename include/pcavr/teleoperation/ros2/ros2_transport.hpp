// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Quality of service of a topic [OMG DDS 1.4, 2.2.3], as far as ROS 2 has it.
struct Ros2Qos {
  bool is_reliable = false;         ///< false: best effort
  bool is_transient_local = false;  ///< late subscribers get the last messages, as for /tf_static
  int depth = 1;                    ///< messages kept
};

struct Ros2Topic {
  std::string name;  ///< with leading slash
  std::string type;  ///< "geometry_msgs/msg/PoseStamped"
  Ros2Qos qos;
};

/// The DDS names of a topic and a type: "rt/tool" of "/tool", and
/// "geometry_msgs::msg::dds_::PoseStamped_" of "geometry_msgs/msg/PoseStamped".
[[nodiscard]] std::string dds_topic_name(std::string_view topic);
[[nodiscard]] std::string dds_type_name(std::string_view type);
/// The type in ROS's notation; the name itself where it is of no ROS type.
[[nodiscard]] std::string ros_type_name(std::string_view dds_type);

/// Subscribed and published topics of ROS 2. Messages are serialized: CDR with its 4-byte header.
class Ros2Transport {
 public:
  Ros2Transport() = default;
  Ros2Transport(const Ros2Transport&) = delete;
  Ros2Transport& operator=(const Ros2Transport&) = delete;
  virtual ~Ros2Transport() = default;

  /// One message of subscription `topic`; the bytes are valid during the call.
  using Receiver = std::function<void(std::size_t topic, std::span<const std::uint8_t> message)>;
  /// Waits until messages arrive, at most `timeout`, and passes them to `receive`, topic by topic,
  /// each in order. For one thread.
  virtual void wait(std::chrono::milliseconds timeout, const Receiver& receive) = 0;
  /// Publishes a message; false if the middleware rejected it. For one thread, which may be another
  /// than that of wait(). May block for some milliseconds.
  virtual bool publish(std::size_t topic, std::span<const std::uint8_t> message) = 0;
  /// Notices about the peers since the last call, one line each: another type under a topic's name,
  /// an incompatible quality of service. For the thread of wait().
  [[nodiscard]] virtual std::vector<std::string> take_notices() = 0;
  /// Messages of subscription `topic` that publishers sent and that did not arrive, as far as the
  /// middleware knows. For the thread of wait().
  [[nodiscard]] virtual std::uint64_t lost(std::size_t topic) {
    (void)topic;
    return 0;
  }
};

/// Options for the network and the peers.
struct DdsOptions {
  std::uint32_t domain = 0;             ///< 0 to 232: ROS_DOMAIN_ID
  std::string interface = {};           ///< name or address, "lo"; empty: Cyclone DDS's choice
  std::vector<std::string> peers = {};  ///< addresses asked for participants, beside multicast
  std::optional<bool> multicast = {};   ///< nothing: Cyclone DDS's choice
  /// [bytes] of a message; a longer one is dropped.
  std::size_t max_message = std::size_t{64} << 20U;
};

/// A participant of Cyclone DDS. The environment's CYCLONEDDS_URI is applied first, then `options`.
/// An Error where there is no usable network. One domain is configured once a process: by the first
/// participant.
[[nodiscard]] Expected<std::unique_ptr<Ros2Transport>> open_dds(
    const std::vector<Ros2Topic>& subscribed, const std::vector<Ros2Topic>& published,
    const DdsOptions& options);

/// The topics of ROS 2 that are published, sorted by name: waits until `is_enough` is true of them,
/// at most `timeout`. Of a topic that is published with several types, the type that was found
/// first. Reliable and transient local are those whose publishers all are, so that a subscription
/// with this quality of service receives from each; the depth is 1. Opens a participant of its own.
[[nodiscard]] Expected<std::vector<Ros2Topic>> discover_ros2_topics(
    const DdsOptions& options, std::chrono::milliseconds timeout,
    const std::function<bool(const std::vector<Ros2Topic>&)>& is_enough);

}  // namespace pcavr
