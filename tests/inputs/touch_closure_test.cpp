// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/touch_closure.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kBodyHalfEdge = 0.05;  // [m]
constexpr double kToolRadius = 0.005;   // [m]
constexpr double kSpeed = 0.02;         // [m/s] of approach and retreat
constexpr double kHeight = 0.03;        // [m] of the tip over the surface between presses
constexpr double kDepth = 0.002;        // [m]
constexpr double kMaxTestDelay = 1.0;   // [s]

/// Presses on a box from above: at each of these times the tip begins to descend, rests at the
/// lowest point for half a second, and returns. Force stamps are late by `delay`; the CAD model is
/// too low by `too_low`.
class Presses {
 public:
  Presses(const std::vector<double>& begins, double delay, double too_low) {
    const double travel = (kHeight + kDepth) / kSpeed;
    const double end = begins.back() + 2.0 * travel + 3.0;
    for (double t = 0.0; t < end; t += 0.004) {
      double down = 0.0;
      for (const double begin : begins) {
        const double descended = std::clamp(t - begin, 0.0, travel);
        const double risen = std::clamp(t - begin - travel - 0.5, 0.0, travel);
        down += kSpeed * (descended - risen);
      }
      t_.push_back(t);
      tip_.push_back({0.0, 0.0, kBodyHalfEdge + too_low + kToolRadius + kHeight - down});
    }
    for (const double begin : begins) {
      Contact& contact = found_.contacts.emplace_back();
      contact.kind = ContactKind::press;
      const double touched = begin + kHeight / kSpeed;
      const double left = begin + travel + 0.5 + kDepth / kSpeed;
      contact.peak_force = 10.0;
      for (double t = touched - 0.2; t < left + 0.2; t += 0.004) {
        contact.t.push_back(t + delay);
        const double depth = kSpeed * std::min(t - touched, left - t);
        contact.force.push_back(10.0 * std::clamp(depth / kDepth, 0.0, 1.0));
      }
      contact.begin = touched + delay;
      contact.end = left + delay;
    }
    series_.bodies = {{.name = "box", .model = &model_, .T_base_object = {}}};
    series_.tool_radius = kToolRadius;
    series_.t_tool = t_;
    series_.p_base_tip = tip_;
    surfaces_.emplace_back(model_);
  }

  [[nodiscard]] TouchClosure closure() const {
    return touch_closure(found_, series_, PathView(t_, tip_), BodyPoses(series_.bodies, surfaces_),
                         kMaxTestDelay);
  }

 private:
  CadModel model_ = box_model("box", Eigen::Vector3d::Constant(kBodyHalfEdge));
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> tip_;
  Segmentation found_;
  InputSeries series_;
  std::vector<BodySurface> surfaces_;
};

TEST(TouchClosure, FindsADelayOfTenthsOfASecondOfEitherSign) {
  for (const double delay : {-0.5, -0.4, -0.3, 0.3, 0.4, 0.5}) {
    const TouchClosure found = Presses({1.0, 8.0}, delay, 0.0).closure();
    ASSERT_TRUE(found.delay.is_known) << delay;
    EXPECT_TRUE(found.is_decisive) << delay;
    EXPECT_FALSE(found.fits_as_written) << delay;
    EXPECT_NEAR(found.delay.offset, delay, 3.0 * found.delay.std) << delay;
    EXPECT_LT(found.delay.std, 0.05) << delay;
  }
}

TEST(TouchClosure, FindsNoneWhereverTheModelHasItsSurface) {
  for (const double too_low : {-0.02, -0.01, 0.0, 0.01, 0.02}) {
    const TouchClosure found = Presses({1.0, 5.5, 10.0, 14.5}, 0.0, too_low).closure();
    EXPECT_TRUE(found.fits_as_written) << too_low;
    EXPECT_FALSE(found.is_decisive) << too_low;
  }
}

TEST(TouchClosure, IsNotKnownWhereTheTipNeverLeaves) {
  // Shifted beyond the range: the tip rests above the box.
  const TouchClosure found = Presses({1.0}, 3.5, 0.0).closure();
  EXPECT_FALSE(found.delay.is_known);
  EXPECT_FALSE(found.is_decisive);
}

TEST(TouchClosure, IsNotThatOfAContactThatTheRecordingCuts) {
  // The tip touches as the recording begins: that it approached was not recorded.
  const TouchClosure found = Presses({-1.45}, 0.0, 0.0).closure();
  EXPECT_FALSE(found.delay.is_known);
  EXPECT_FALSE(found.is_decisive);
}

}  // namespace
}  // namespace pcavr
