// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/sample_queue.hpp"

namespace pcavr {

void SampleQueue::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                           const Eigen::Quaterniond& q_base_tool) {
  tool_.push_back({due(t), t, p_base_tip, q_base_tool});
}

void SampleQueue::add_wrench(double t, const Eigen::Vector3d& force_base) {
  wrench_.push_back({due(t), t, force_base});
}

void SampleQueue::add_tracked(std::size_t object, const TrackedPose& pose) {
  tracked_.push_back({due(pose.t + tracking_latency_), object, pose});
}

void SampleQueue::pass_on(double until, RobotSite& robot) {
  for (; !tool_.empty() && tool_.front().due <= until; tool_.pop_front()) {
    const Tool& tool = tool_.front();
    robot.add_tool(tool.t, tool.p_base_tip, tool.q_base_tool);
  }
  for (; !wrench_.empty() && wrench_.front().due <= until; wrench_.pop_front()) {
    robot.add_wrench(wrench_.front().t, wrench_.front().force_base);
  }
  for (; !tracked_.empty() && tracked_.front().due <= until; tracked_.pop_front()) {
    robot.add_tracked(tracked_.front().object, tracked_.front().pose);
  }
}

}  // namespace pcavr
