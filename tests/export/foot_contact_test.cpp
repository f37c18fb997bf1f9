// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/foot_contact.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/gravity.hpp"

namespace pcavr::detail {
namespace {

TEST(FootContact, BearsTheLoadInTheRecordedPose) {
  ExportedBody body;
  body.inertia.mass = 1.5;
  body.T_base_object =
      Pose(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Eigen::Vector3d(1.0, 1.0, 0.0).normalized())),
           {0.3, -0.1, 0.2});
  const SupportFoot foot{
      .centre_object = {0.02, 0.01, 0.0}, .radius = 2e-3, .friction = 0.3, .load = 0.125};
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const double load = 0.125 * 1.5 * kStandardGravity;
  for (const FootContact& contact :
       {stiff_foot_contact(body, foot, up), foot_contact(body, foot, up, 2e3)}) {
    const Eigen::Vector3d moved_base =
        body.T_base_object * contact.centre_object - body.T_base_object * foot.centre_object;
    EXPECT_NEAR(moved_base.x(), 0.0, 1e-12);
    EXPECT_NEAR(moved_base.y(), 0.0, 1e-12);
    EXPECT_NEAR(-moved_base.z() * contact.stiffness, load, 1e-9 * load);
  }
}

}  // namespace
}  // namespace pcavr::detail
