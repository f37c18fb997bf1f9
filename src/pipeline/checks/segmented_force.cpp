// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/checks/segmented_force.hpp"

#include "pcavr/recordings/recording/stream_clocks.hpp"

namespace pcavr {

SegmentedForce segment_force(const Recording& recording) {
  const Stamp start = start_of(recording);
  SegmentedForce segmented;
  for (const WrenchSample& sample : recording.wrench) {
    segmented.t.push_back(to_seconds(sample.stamp - start));
    segmented.force.push_back(sample.force);
  }
  std::vector<double> t_tool;
  std::vector<Eigen::Vector3d> p_base_tip;
  for (const TimedPose& pose : recording.tool.poses()) {
    t_tool.push_back(to_seconds(pose.stamp - start));
    p_base_tip.push_back(pose.pose.translation());
  }
  segmented.found = segment_contacts(segmented.t, segmented.force, t_tool, p_base_tip);
  return segmented;
}

}  // namespace pcavr
