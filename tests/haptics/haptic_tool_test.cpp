// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/haptics/haptic_tool.hpp"

#include <gtest/gtest.h>

#include "haptics/scanned_bumps.hpp"
#include "support/heap_counter.hpp"

namespace pcavr {
namespace {

constexpr double kCycle = 0.001;  // [s]

/// A closed path of a hand from 1 cm above the bumps into them and back: at most 20 m/s^2.
class ClosedPath {
 public:
  static constexpr int kSteps = 400;

  explicit ClosedPath(Random& random)
      : start_(random.uniform(0.08, 0.22), random.uniform(0.08, 0.22), 0.0) {
    for (Eigen::Vector3d& wave : waves_) {
      wave = {random.uniform(-0.006, 0.006), random.uniform(-0.006, 0.006),
              random.uniform(-0.003, 0.003)};
    }
    dip_ = random.uniform(0.008, 0.016);
    start_.z() = test::ScannedBumps::smooth_height(start_.x(), start_.y()) + 0.01;
  }

  [[nodiscard]] Eigen::Vector3d operator()(int step) const {
    const double turn = 2.0 * M_PI * step / kSteps;
    Eigen::Vector3d p = start_ - Eigen::Vector3d(0.0, 0.0, 0.5 * dip_ * (1.0 - std::cos(turn)));
    for (int i = 0; i < 4; ++i) p += std::sin((i + 1) * turn) / (i + 1) * waves_[i];
    return p;
  }

 private:
  Eigen::Vector3d start_;
  Eigen::Vector3d waves_[4];
  double dip_ = 0.0;
};

struct Work {
  double least = 0.0;  ///< [J] that a closed path took, the worst of all
  double sum = 0.0;    ///< [J]
  long touched = 0;
};

Work over_closed_paths(HapticTool& tool, int paths) {
  Random random(11);
  Work work;
  for (int path = 0; path < paths; ++path) {
    const ClosedPath hand(random);
    if (!tool.reset(hand(0))) continue;
    Eigen::Vector3d tip = hand(0);
    (void)tool.step(tip, kCycle);
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    double taken = 0.0;
    bool has_touched = false;
    for (int i = 1; i <= ClosedPath::kSteps; ++i) {
      const Eigen::Vector3d next = hand(i);
      taken -= force.dot(next - tip);  // the device holds its force until the next cycle
      tip = next;
      const HapticState state = tool.step(tip, kCycle);
      force = state.force;
      has_touched |= state.is_in_contact;
    }
    work.least = std::min(work.least, taken);
    work.sum += taken;
    work.touched += has_touched ? 1 : 0;
  }
  return work;
}

/// The least force over what a hand's acceleration adds in a cycle, a few times a path.
constexpr double kRounding = 1e-7;  // [J]

TEST(HapticTool, GivesNoMoreWorkThanItTookOverThousandsOfClosedPaths) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  for (const double friction : {0.0, 0.5}) {
    for (const Compliance law : {Compliance{1000.0, 0.0, 1.0}, Compliance{3000.0, 2.0, 1.0},
                                 Compliance{40'000.0, 0.0, 1.5}}) {
      ForceOptions options;
      options.compliance = law;
      HapticTool tool(bumps.mesh(), {0.001, friction}, options);
      const Work work = over_closed_paths(tool, 500);
      EXPECT_GT(work.touched, 250);
      EXPECT_GE(work.least, -kRounding) << friction << ' ' << law.stiffness;
      EXPECT_GT(work.sum, 0.0);
    }
  }
}

TEST(HapticTool, DoesTheSameAgainWithoutTheHeap) {
  const test::ScannedBumps bumps(200, 0.0003, 2);
  HapticTool first(bumps.mesh(), {}, {});
  HapticTool second(bumps.mesh(), {}, {});
  const test::PressAndSlide hand(4);
  ASSERT_TRUE(first.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  ASSERT_TRUE(second.reset(hand(1.85) + Eigen::Vector3d(0.0, 0.0, 0.01)));
  const long before = heap_allocations;
  bool is_same = true;
  long contacts = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d tip = hand(1.85 + i * kCycle);
    const HapticState a = first.step(tip, kCycle);
    const HapticState b = second.step(tip, kCycle);
    is_same &= a.proxy == b.proxy && a.force == b.force;
    contacts += a.is_in_contact ? 1 : 0;
  }
  EXPECT_EQ(heap_allocations, before);
  EXPECT_TRUE(is_same);
  EXPECT_GT(contacts, 2000);
}

}  // namespace
}  // namespace pcavr
