// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "haptics/closed_paths.hpp"
#include "serve/a_world.hpp"
#include "serve/live_cycle.hpp"

namespace pcavr::test {

/// Returns the test's sample.
class ScriptedDevice final : public Device {
 public:
  explicit ScriptedDevice(DeviceSample& sample, DeviceFeedback* feedback = nullptr)
      : sample_(sample), feedback_(feedback) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "test"; }
  [[nodiscard]] DeviceSample exchange(double, double,
                                      const DeviceFeedback& feedback) noexcept override {
    if (feedback_ != nullptr) *feedback_ = feedback;
    return sample_;
  }

 private:
  DeviceSample& sample_;
  DeviceFeedback* feedback_;
};

class LiveCycleTest : public testing::Test {
 protected:
  const WorldSnapshot& run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      t_ += kCycle;
      cycle_.step(t_);
      cycle_.publish(1e-5, 0, t_);
    }
    return cycle_.newest();
  }
  /// Moves the hand at constant speed with the clutch closed.
  const WorldSnapshot& move(const Eigen::Vector3d& to, int cycles) {
    const Eigen::Vector3d from = sample_.p_base_tip;
    sample_.is_engaged = true;
    for (int i = 1; i <= cycles; ++i) {
      sample_.p_base_tip = from + (to - from) * (static_cast<double>(i) / cycles);
      run(1);
    }
    return cycle_.newest();
  }

  DeviceSample sample_{test::kToolStart, Eigen::Quaterniond::Identity(), false, true};
  LiveCycle cycle_{test::a_box_on_a_table(), std::make_unique<ScriptedDevice>(sample_),
                   test::options_with_tool_start()};
  double t_ = 0.0;
};

inline const Eigen::Vector3d kInTheBox{0.1, 0.0, 0.05};

}  // namespace pcavr::test
