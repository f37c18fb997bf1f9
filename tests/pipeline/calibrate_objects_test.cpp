// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Where a mesh is in a tracker's frame, from contacts whose truth is known.
#include "pcavr/pipeline/calibrate_objects.hpp"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"

#include "support/meshes.hpp"

namespace pcavr {
namespace {

constexpr double kTip = 0.01;                  // [m]
const Eigen::Vector3d kHalf(0.1, 0.07, 0.05);  // [m] of the box
constexpr double kContactStd = 0.4e-3;         // [m] common to a contact's points

struct BoxRig {
  Pose T_tracked_object = {};
  double scale = 1.0;
  int contacts = 16;
  int sides = 4;                          ///< of the box that are touched, of four
  double lowest = -0.03, highest = 0.03;  ///< [m] of the contacts

  [[nodiscard]] TouchedObject object(std::uint64_t seed) const {
    Random random(seed);
    TouchedObject made{
        .name = "box",
        .model = make_cad_model(test::box_mesh((2.0 * kHalf).cast<float>()), "box", "box").value()};
    made.tip_radius = kTip;
    for (int contact = 0; contact < contacts; ++contact) {
      const int side = contact % sides;
      const int axis = side % 2;
      const double sign = side < 2 ? 1.0 : -1.0;
      const double error = kContactStd * random.normal();
      Eigen::Vector3d p;
      p[axis] = sign * (scale * kHalf[axis] + kTip + error);
      const double along = random.uniform(-0.8, 0.8) * kHalf[1 - axis];
      p.z() = random.uniform(lowest, highest);
      for (int i = 0; i < 8; ++i) {
        p[1 - axis] = along + 1e-3 * i;
        made.points.push_back({static_cast<std::size_t>(contact), T_tracked_object * p});
      }
    }
    made.contacts = static_cast<std::size_t>(contacts);
    return made;
  }
};

Pose a_pose(double degrees, const Eigen::Vector3d& p) {
  return Pose(
      Eigen::Quaterniond(Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitZ())), p);
}

TEST(CalibrateObjects, FindsATurnedAndShiftedFrameWithStdsThatHold) {
  constexpr int kRigs = 60;
  const BoxRig rig{.T_tracked_object = a_pose(-40.0, {0.012, -0.020, 0.0})};
  int within = 0;
  double largest = 0.0;
  for (std::uint64_t seed = 1; seed <= kRigs; ++seed) {
    const auto found = calibrate_object(rig.object(seed));
    ASSERT_TRUE(found) << found.error().to_string();
    ASSERT_TRUE(found->is_observable[0] && found->is_observable[1] && found->is_observable[5]);
    EXPECT_FALSE(found->is_observable[2]);  // no contact is above or below
    const Vector6d off = (found->T_tracked_object.inverse() * rig.T_tracked_object).log();
    for (const std::size_t i : {0, 1, 5}) {
      const double stds = std::abs(off[static_cast<Eigen::Index>(i)]) / found->stds[i];
      within += stds < 1.0 ? 1 : 0;
      largest = std::max(largest, stds);
    }
  }
  const double share = within / (3.0 * kRigs);
  std::printf("  within one std: %.1f %%, largest %.1f stds\n", 100.0 * share, largest);
  EXPECT_NEAR(share, 0.68, 0.08);
  EXPECT_LT(largest, 5.0);
}

TEST(CalibrateObjects, FindsAMeshOfAnotherSize) {
  const BoxRig rig{.T_tracked_object = a_pose(5.0, {0.004, 0.003, 0.0}), .scale = 1.05};
  const auto found = calibrate_object(rig.object(1));
  ASSERT_TRUE(found);
  ASSERT_TRUE(found->is_observable[6]);
  EXPECT_NEAR(found->scale, 1.05, 4.0 * found->stds[6]);
  EXPECT_NEAR(found->mesh_unit, 1.05, 4.0 * found->stds[6]);
  EXPECT_LT(found->held_out_rms, 1e-3);
}

TEST(CalibrateObjects, SaysWhatOneSideDoesNotShow) {
  const BoxRig rig{.T_tracked_object = a_pose(3.0, {0.005, 0.002, 0.0}), .sides = 1};
  const auto found = calibrate_object(rig.object(2));
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_TRUE(found->is_observable[0]);
  EXPECT_TRUE(found->is_observable[5]);
  EXPECT_FALSE(found->is_observable[1]);  // along the face
  EXPECT_FALSE(found->is_observable[6]);
  EXPECT_NE(parameter_names(*found, false).find("y, z"), std::string::npos);
  EXPECT_NEAR(found->T_tracked_object.translation().z(), 0.0, 1e-6);
}

TEST(CalibrateObjects, NeedsSeveralContacts) {
  const auto found = calibrate_object(BoxRig{.contacts = 3}.object(1));
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().message.find("touched in 3 contacts"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
