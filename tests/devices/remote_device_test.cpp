// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/devices/remote_device.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]

RemoteSample sample_at(double clock, const Eigen::Vector3d& p_base_tip, bool is_engaged) {
  return {
      .p_base_tip = p_base_tip, .is_engaged = is_engaged, .sender_clock = clock, .arrival = clock};
}

TEST(RemoteDevice, IsAbsentBeforeTheFirstSample) {
  RemoteDevice device;
  const DeviceSample said = device.exchange(0.0, kCycle, {});
  EXPECT_FALSE(said.is_present);
  EXPECT_FALSE(said.is_engaged);
  EXPECT_TRUE(std::isnan(device.use().sender_clock));
}

TEST(RemoteDevice, ClosesItsClutchWhereTheToolIs) {
  RemoteDevice device;
  const DeviceFeedback feedback{.p_base_tool = {0.5, 0.1, 0.2}};
  ASSERT_TRUE(device.push(sample_at(0.0, {1.0, 2.0, 3.0}, true)));
  const DeviceSample said = device.exchange(0.0, kCycle, feedback);
  EXPECT_TRUE(said.is_engaged);
  EXPECT_LT((said.p_base_tip - feedback.p_base_tool).norm(), 1e-12);
}

}  // namespace
}  // namespace pcavr
