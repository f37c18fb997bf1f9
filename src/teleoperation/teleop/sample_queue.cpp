// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/sample_queue.hpp"

#include <cstddef>

namespace pcavr {
namespace {

// Largest number of samples of a series in a cycle: all that wait when a session begins would take
// milliseconds of one cycle.
constexpr std::size_t kMaxOldPassedOn = 32;

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

void SampleQueue::notify_change(double until, RobotSite& robot, double start) {
  notify_change(until, start, tool_, [&](const Tool& tool) {
    robot.add_tool(tool.t, tool.p_base_tip, tool.q_base_tool);
  });
  notify_change(until, start, wrench_,
                [&](const Wrench& wrench) { robot.add_wrench(wrench.t, wrench.force_base); });
  notify_change(until, start, tracked_,
                [&](const Tracked& tracked) { robot.add_tracked(tracked.object, tracked.pose); });
}

template <typename Sample, typename Receive>
void SampleQueue::notify_change(double until, double start, std::deque<Sample>& samples,
                                const Receive& receive) {
  std::size_t old = 0;
  for (; !samples.empty() && samples.front().due <= until; samples.pop_front()) {
    if (samples.front().due < start && old++ == kMaxOldPassedOn) return;
    receive(samples.front());
  }
}

}  // namespace pcavr
