// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "results/export/export_text.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace pcavr::detail {
namespace {

TEST(XmlText, EscapesMarkupAndLeavesOtherBytes) {
  EXPECT_EQ(xml_text("a & b < c > d \"e\""), "a &amp; b &lt; c &gt; d &quot;e&quot;");
  EXPECT_EQ(xml_text("&amp;"), "&amp;amp;");
  EXPECT_EQ(xml_text("\xC3\xA9t\xC3\xA9 'x' 1/2"), "\xC3\xA9t\xC3\xA9 'x' 1/2");
  EXPECT_EQ(xml_text(""), "");
}

TEST(RollPitchYaw, GivesTheRotationBack) {
  for (const double roll : {-2.0, 0.0, 0.4}) {
    for (const double pitch : {-std::numbers::pi / 2.0, -0.7, 0.0, std::numbers::pi / 2.0}) {
      for (const double yaw : {-3.0, 0.0, 1.1}) {
        const Eigen::Quaterniond rotation = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                                            Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                                            Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
        const Eigen::Vector3d rpy = roll_pitch_yaw(rotation);
        const Eigen::Quaterniond back = Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX());
        EXPECT_NEAR(rotation.angularDistance(back), 0.0, 1e-7) << roll << pitch << yaw;
      }
    }
  }
}

}  // namespace
}  // namespace pcavr::detail
