// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/sample_queue.hpp"

#include <algorithm>
#include <future>

#include <gtest/gtest.h>

#include "teleoperation/teleop/message.hpp"
#include "teleoperation/teleop/robot_site.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kSamplesThatWait =
    2000;                                 // samples of two seconds before a session's first command
constexpr double kStampInterval = 0.001;  // [s]

class SampleQueueTest : public testing::Test {
 protected:
  SampleQueueTest() {
    queue_.set_arrival(kStampInterval * kSamplesThatWait);
    for (std::size_t i = 0; i < kSamplesThatWait; ++i) {
      queue_.add_wrench(kStampInterval * static_cast<double>(i), Eigen::Vector3d::Zero());
    }
  }
  [[nodiscard]] std::size_t received() const {
    return site_.streaming_bytes() / bytes_of_wrench_sample();
  }

  TeleopInput world_;
  TeleopOptions options_;
  RobotSite site_{world_, options_, {}, 0.0};
  SampleQueue queue_{0.03};
};

TEST_F(SampleQueueTest, PassesOnInSharesWhatIsOlderThanTheStart) {
  const double start = kStampInterval * (kSamplesThatWait - 100);
  std::size_t most = 0, cycles = 0;
  for (std::size_t before = 0; received() < kSamplesThatWait - 100 && cycles < 200; ++cycles) {
    queue_.notify_change(start - 1e-6, site_, start);
    most = std::max(most, received() - before);
    before = received();
  }
  EXPECT_EQ(received(), kSamplesThatWait - 100);
  EXPECT_EQ(most, 32U);
}

TEST_F(SampleQueueTest, PassesOnAllThatIsNotOlder) {
  queue_.notify_change(10.0, site_, 0.0);
  EXPECT_EQ(received(), kSamplesThatWait);
}

TEST_F(SampleQueueTest, KeepsWhatIsNotDue) {
  queue_.notify_change(0.0995, site_);
  EXPECT_EQ(received(), 100U);
}

}  // namespace
}  // namespace pcavr
