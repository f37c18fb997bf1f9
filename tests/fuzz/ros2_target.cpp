// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "pcavr/base/core/check.hpp"
#include "pcavr/robots/robot/urdf.hpp"

#include "fuzz/targets.hpp"
#include "teleoperation/ros2/ros2_intake.hpp"

namespace pcavr::fuzz {
namespace {

constexpr char kArm[] = R"(<robot name="arm"><link name="base_link"/><link name="tip"/>
  <joint name="turn" type="revolute"><parent link="base_link"/><child link="tip"/>
    <origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/></joint></robot>)";

Ros2Setup setup_of(bool has_joints) {
  Ros2Setup setup;
  setup.tool = {
      "/tool", has_joints ? "sensor_msgs/msg/JointState" : "geometry_msgs/msg/PoseStamped", {}};
  if (has_joints) setup.tool_urdf = "arm.urdf";
  setup.tool_frame = "tip";
  setup.wrench = Ros2Topic{"/wrench", "geometry_msgs/msg/WrenchStamped", {}};
  setup.transforms = Ros2Topic{"/tf", "tf2_msgs/msg/TFMessage", {}};
  setup.objects = {{"box", {"/box", "geometry_msgs/msg/PoseStamped", {}}, 0.002}};
  return setup;
}

/// Samples that reach the site's thread are finite and ascend, whatever the peers send.
void require_sound(RecordQueue& samples,
                   std::map<std::pair<Ros2Sample::Kind, std::uint64_t>, double>& last) {
  Ros2Sample sample;
  for (std::vector<std::uint8_t> bytes; samples.pop(bytes);) {
    PCAVR_REQUIRE(bytes.size() == sizeof(sample), bytes.size());
    std::memcpy(&sample, bytes.data(), sizeof(sample));
    PCAVR_REQUIRE(std::isfinite(sample.t), sample.t);
    for (const double value : sample.values) PCAVR_REQUIRE(std::isfinite(value), value);
    const auto [entry, is_new] = last.try_emplace({sample.kind, sample.object}, sample.t);
    PCAVR_REQUIRE(is_new || sample.t > entry->second, sample.t, entry->second);
    entry->second = sample.t;
  }
}

}  // namespace

void ros2_intake(std::string_view bytes) {
  if (bytes.empty()) return;
  const bool has_joints = bytes[0] % 2 != 0;
  const Ros2Setup setup = setup_of(has_joints);
  const std::size_t topics = subscriptions_of(setup).size();
  RecordQueue samples(1U << 16U), lines(1U << 14U);
  Ros2Notices notices(lines);
  Ros2Intake intake(setup, {0}, samples, notices);
  if (has_joints) {
    const Expected<RobotModel> arm = parse_urdf(kArm, "arm.urdf");
    PCAVR_REQUIRE(arm.has_value());
    intake.set_joints(Ros2ToolJoints(*arm, *arm->link_index("base_link"), *arm->link_index("tip")));
  }
  std::map<std::pair<Ros2Sample::Kind, std::uint64_t>, double> last;
  double now = 100.0;
  for (bytes.remove_prefix(1); bytes.size() > 2; now += 0.001) {
    const std::size_t topic = static_cast<std::uint8_t>(bytes[0]) % topics;
    const auto size = std::min<std::size_t>(static_cast<std::uint8_t>(bytes[1]), bytes.size() - 2);
    const auto* const begin = reinterpret_cast<const std::uint8_t*>(bytes.data()) + 2;
    intake.on_message(topic, std::span(begin, size), now);
    require_sound(samples, last);
    bytes.remove_prefix(2 + size);
  }
}

}  // namespace pcavr::fuzz
