// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/clock_shift.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "teleop/plant_input.hpp"

namespace pcavr {
namespace {

constexpr double kHalfEdge = 0.05;    // [m]
constexpr double kTipRadius = 0.005;  // [m]
constexpr double kPushSpeed = 0.04;   // [m/s]

/// A tip rests 1 mm beside a box for 3 s, pushes it for 0.5 s, and leaves fast, which the sensor
/// feels.
class RestingTip : public testing::Test {
 protected:
  RestingTip() {
    for (int i = 0; i <= 800; ++i) {
      const double t = 0.01 * i;
      const double way = kPushSpeed * std::clamp(t - 3.0, 0.0, 0.5);
      t_.push_back(t);
      const double back = 0.3 * std::max(0.0, t - 3.5);
      tip_.push_back({-kHalfEdge - kTipRadius - 0.001 + way - back, 0.0, 0.0});
      const Eigen::Vector3d box(std::max(0.0, way - 0.001), 0.0, 0.0);
      tracked_.push_back({.t = t, .T_base_object = Pose::from_translation(box)});
    }
    series_.bodies = {{.name = "box", .model = &model_, .T_base_object = {}, .tracked = tracked_}};
    series_.tool_radius = kTipRadius;
    series_.t_tool = t_;
    series_.p_base_tip = tip_;
    series_.t_force = t_;
    surfaces_.emplace_back(model_);
  }

  [[nodiscard]] std::optional<InputFault> fault() {
    Segmentation found;
    found.contacts.resize(2);
    found.contacts[0].begin = 3.0, found.contacts[0].end = 3.5;
    found.contacts[1].begin = 3.6, found.contacts[1].end = 6.5;
    return clock_fault(series_, found, PathView(t_, tip_), BodyPoses(series_.bodies, surfaces_));
  }

 private:
  CadModel model_ = box_model("box", Eigen::Vector3d::Constant(kHalfEdge));
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> tip_;
  std::vector<TrackedPose> tracked_;
  InputSeries series_;
  std::vector<BodySurface> surfaces_;
};

TEST_F(RestingTip, IsNoContactThatTheForceMisses) { EXPECT_FALSE(fault().has_value()); }

}  // namespace
}  // namespace pcavr
