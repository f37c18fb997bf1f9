// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pcavr/teleoperation/devices/device.hpp"

#include "devices/eventually.hpp"
#include "devices/jittered_hand.hpp"

namespace pcavr::test {

/// A world's feedback while the tool is in contact.
inline const DeviceFeedback kPushed{
    .p_base_tool = {0.5, 0.1, 0.2}, .force_base = {0.0, 0.0, 2.5}, .pulse = 1.0};

inline bool comes_to_be(Device& device, bool is_present, bool is_engaged) {
  return eventually([&] {
    const DeviceSample sample = device.exchange(0.0, kCycle, kPushed);
    return sample.is_present == is_present && sample.is_engaged == is_engaged;
  });
}

inline bool comes_to_stop(Device& device, bool is_stop_pressed = true) {
  return eventually(
      [&] { return device.exchange(0.0, kCycle, kPushed).is_stop_pressed == is_stop_pressed; });
}

/// Whether the tip, and the tool with it, eventually moves at `v` [m/s] in base.
inline bool comes_to_move_by(Device& device, const Eigen::Vector3d& v) {
  DeviceFeedback feedback = kPushed;
  Eigen::Vector3d before = feedback.p_base_tool;
  return eventually([&] {
    const DeviceSample sample = device.exchange(0.0, kCycle, feedback);
    feedback.p_base_tool = sample.p_base_tip;
    const Eigen::Vector3d moved = sample.p_base_tip - before;
    before = sample.p_base_tip;
    return sample.is_engaged && (moved / kCycle - v).norm() < 1e-9;
  });
}

}  // namespace pcavr::test
