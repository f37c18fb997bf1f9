// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/evaluation/contact_task.hpp"

#include <gtest/gtest.h>

#include "run_samples.hpp"
#include "shapes.hpp"

namespace pcavr {
namespace {

/// The tip on a line from 0 to 1 s, 100 poses a second.
Trajectory a_line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  Trajectory tip;
  for (int i = 0; i <= 100; ++i) {
    tip.append(at(0.01 * i), Pose::from_translation(from + 0.01 * i * (to - from)));
  }
  return tip;
}

/// A contact from 0.5 to 1 s, with its peak at the end.
ContactPeak a_contact() {
  return {.begin = at(0.5), .end = at(1.0), .peak = at(1.0), .measured = 10.0};
}

PhaseTimeline at_rest() { return timeline({{0.0, Phase::free}, {0.5, Phase::static_contact}}); }

/// Two blocks, 40 mm apart along x: a body with a slot, 100 mm high.
TriangleMesh a_slot() {
  TriangleMesh left = a_box({0.03F, 0.1F, 0.1F});
  TriangleMesh right = left;
  for (Eigen::Vector3f& vertex : left.vertices) vertex.x() -= 0.035F;
  for (Eigen::Vector3f& vertex : right.vertices) vertex.x() += 0.035F;
  return merged(left, right);
}

class ContactTasks : public testing::Test {
 protected:
  [[nodiscard]] ContactTask task(const Trajectory& tip, const TriangleMesh& mesh,
                                 const PhaseTimeline& phases) const {
    return task_of(a_contact(), {tip, phases, &T_base_object_, &mesh});
  }
  // The object's origin is at (0.5, 0, 0.05) in base.
  Trajectory T_base_object_ = [] {
    Trajectory object;
    object.append(at(0.0), Pose::from_translation({0.5, 0.0, 0.05}));
    return object;
  }();
};

TEST_F(ContactTasks, APressComesFromAboveAndMovesNothing) {
  const Trajectory tip = a_line({0.5, 0.0, 0.13}, {0.502, 0.0, 0.108});
  EXPECT_EQ(task(tip, a_box({0.1F, 0.1F, 0.1F}), at_rest()), ContactTask::press);
  const PhaseTimeline sliding = timeline({{0.0, Phase::free}, {0.7, Phase::sliding}});
  EXPECT_EQ(task(tip, a_box({0.1F, 0.1F, 0.1F}), sliding), ContactTask::push);
}

// The hull's test directions are 7 degrees apart: a wide face is none of their supports.
TEST_F(ContactTasks, APressOnAWideFlatFaceIsNoSlotting) {
  const TriangleMesh wide = a_box({0.25F, 0.22F, 0.1F});
  for (const double x : {0.5, 0.45, 0.41, 0.56}) {
    const Trajectory tip = a_line({x, 0.0, 0.13}, {x, 0.0, 0.108});
    EXPECT_EQ(task(tip, wide, at_rest()), ContactTask::press) << x;
  }
}

TEST_F(ContactTasks, APressDeepIntoASoftBodyIsNoSlotting) {
  const Trajectory tip = a_line({0.5, 0.0, 0.13}, {0.5, 0.0, 0.07});
  EXPECT_EQ(task(tip, a_box({0.1F, 0.1F, 0.1F}), at_rest()), ContactTask::press);
}

TEST_F(ContactTasks, APushComesFromTheSide) {
  const Trajectory tip = a_line({0.4, 0.0, 0.05}, {0.442, 0.0, 0.05});
  EXPECT_EQ(task(tip, a_box({0.1F, 0.1F, 0.1F}), at_rest()), ContactTask::push);
}

TEST_F(ContactTasks, SlottingIsInAHoleWhateverTheDirection) {
  const Trajectory down = a_line({0.5, 0.0, 0.15}, {0.5, 0.0, 0.06});
  const Trajectory aside = a_line({0.49, 0.0, 0.06}, {0.51, 0.0, 0.06});
  EXPECT_EQ(task(down, a_slot(), at_rest()), ContactTask::slotting);
  EXPECT_EQ(task(aside, a_slot(), at_rest()), ContactTask::slotting);
  const Trajectory on_top = a_line({0.535, 0.0, 0.13}, {0.535, 0.0, 0.109});
  EXPECT_EQ(task(on_top, a_slot(), at_rest()), ContactTask::press);
}

TEST_F(ContactTasks, AreUnknownWithoutTheTool) {
  EXPECT_EQ(task({}, a_box({0.1F, 0.1F, 0.1F}), at_rest()), ContactTask::unknown);
}

TEST_F(ContactTasks, WithoutTheObjectsPoseAreByDirection) {
  const Trajectory tip = a_line({0.5, 0.0, 0.15}, {0.5, 0.0, 0.06});
  const PhaseTimeline phases = at_rest();
  EXPECT_EQ(task_of(a_contact(), {.T_base_tool = tip, .phases = phases}), ContactTask::press);
}

}  // namespace
}  // namespace pcavr
