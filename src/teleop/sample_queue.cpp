// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/sample_queue.hpp"

#include <algorithm>

namespace pcavr {
namespace {

// Of a series in a cycle, of those that wait at least this share: what has come before a session's
// first command would take milliseconds of one cycle.
constexpr std::size_t kMinPassedOn = 32;
constexpr std::size_t kPassedOnShare = 8;

}  // namespace

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
  pass_on(until, tool_,
          [&](const Tool& tool) { robot.add_tool(tool.t, tool.p_base_tip, tool.q_base_tool); });
  pass_on(until, wrench_,
          [&](const Wrench& wrench) { robot.add_wrench(wrench.t, wrench.force_base); });
  pass_on(until, tracked_,
          [&](const Tracked& tracked) { robot.add_tracked(tracked.object, tracked.pose); });
}

template <typename Sample, typename Receive>
void SampleQueue::pass_on(double until, std::deque<Sample>& samples, const Receive& receive) {
  const std::size_t most = std::max(kMinPassedOn, samples.size() / kPassedOnShare);
  for (std::size_t i = 0; i < most && !samples.empty() && samples.front().due <= until; ++i) {
    receive(samples.front());
    samples.pop_front();
  }
}

}  // namespace pcavr
