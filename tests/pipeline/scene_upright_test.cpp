// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/checks/scene_upright.hpp"

#include <gtest/gtest.h>

#include "pipeline/consistency_case.hpp"
#include "scene/scene_builder.hpp"

namespace pcavr {
namespace {

/// A box on a table, all of it turned in base, as by a wrong pose of the base tag.
Scene turned_scene(const Eigen::Quaterniond& R) {
  Scene scene = a_box_on_a_table();
  const Pose T(R, Eigen::Vector3d::Zero());
  scene.mesh_base = transformed(T, scene.mesh_base);
  for (SceneObject& object : scene.objects) object.T_base_object = T * object.T_base_object;
  scene.support_planes.clear();  // none is horizontal
  return scene;
}

Manifest one_base_tag(const Eigen::Quaterniond& q) {
  Manifest manifest;
  manifest.markers = {a_tag(0, 0.1, Pose(q, {0.3, 0.2, 0.0}))};
  return manifest;
}

TEST(CheckUpright, FindsNothingWhereAnObjectStandsOnAHorizontalPlane) {
  EXPECT_FALSE(check_upright(one_base_tag(Eigen::Quaterniond::Identity()), a_box_on_a_table()));
}

TEST(CheckUpright, RecognisesTheBaseTagsQuaternionThatBeginsWithW) {
  for (const double yaw : {0.0, 1.5707963, 0.7}) {
    const Eigen::Quaterniond q(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    const Eigen::Quaterniond misread(q.z(), q.w(), q.x(), q.y());  // w x y z in x y z w
    const auto found = check_upright(one_base_tag(misread), turned_scene(misread * q.conjugate()));
    ASSERT_TRUE(found) << yaw;
    EXPECT_EQ(found->severity, FindingSeverity::contradiction) << yaw;
    EXPECT_EQ(found->place, "markers[0].pose");
  }
}

TEST(CheckUpright, WarnsOfASlopeThatNothingExplains) {
  const Eigen::Quaterniond slope(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 1, 0).normalized()));
  const auto found = check_upright(one_base_tag(slope), turned_scene(slope));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->severity, FindingSeverity::warning);
  EXPECT_NE(found->message.find("inclined by 28.6 degrees"), std::string::npos) << found->message;
}

}  // namespace
}  // namespace pcavr
