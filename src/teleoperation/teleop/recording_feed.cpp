// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/recording_feed.hpp"

#include <optional>

namespace pcavr {

RecordingFeed::RecordingFeed(const TeleopInput& input, double tracking_latency)
    : input_(input), tracking_latency_(tracking_latency), next_tracked_(input.objects.size(), 0) {}

void RecordingFeed::notify_change(double now, RobotSite& robot) {
  // Series by series: the site takes any interleaving, and uses none of them before it advances.
  for (; next_tool_ < input_.t_tool.size() && input_.t_tool[next_tool_] <= now; ++next_tool_) {
    std::optional<Eigen::Quaterniond> orientation;
    if (!input_.q_base_tool.empty()) orientation = input_.q_base_tool[next_tool_];
    robot.add_tool(input_.t_tool[next_tool_], input_.p_base_tip[next_tool_], orientation);
  }
  for (; next_force_ < input_.t_force.size() && input_.t_force[next_force_] <= now; ++next_force_) {
    robot.add_wrench(input_.t_force[next_force_], input_.force_base[next_force_]);
  }
  for (std::size_t i = 0; i < next_tracked_.size(); ++i) {
    const std::vector<TrackedPose>& tracked = input_.objects[i].tracked;
    std::size_t& next = next_tracked_[i];
    for (; next < tracked.size() && tracked[next].t + tracking_latency_ <= now; ++next) {
      robot.add_tracked(i, tracked[next]);
    }
  }
}

}  // namespace pcavr
