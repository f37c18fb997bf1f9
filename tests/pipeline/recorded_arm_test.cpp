// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/robot/recorded_arm.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/scene/scene_text.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

/// A post that turns about base z, with a bar of 0.4 m along x at a height of 0.5 m.
constexpr char kUrdf[] =
    "<robot name='post'><link name='foot'/><link name='bar'><visual><origin xyz='0.2 0 0'/>"
    "<geometry><box size='0.4 0.04 0.04'/></geometry></visual></link>"
    "<joint name='turn' type='revolute'><parent link='foot'/><child link='bar'/>"
    "<origin xyz='0 0 0.5'/><axis xyz='0 0 1'/>"
    "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint></robot>";

class RecordedArmTest : public testing::Test {
 protected:
  Expected<std::optional<RecordedArm>> read(const std::string& joints,
                                            const std::optional<std::string>& tip = {}) {
    EXPECT_TRUE(write_file(folder_.path() / "arm.urdf", kUrdf));
    EXPECT_TRUE(write_file(folder_.path() / "joints.csv", joints));
    recording_.folder = folder_.path();
    recording_.manifest.robot = RobotEntry{
        .urdf = "arm.urdf", .T_base_robot = Pose::from_translation({1.0, 0.0, 0.0}), .tip = tip};
    recording_.joints.resize(2);
    return read_recorded_arm(recording_, {});
  }

  TemporaryFolder folder_;
  Recording recording_;
};

TEST_F(RecordedArmTest, JointsAreInterpolatedWithinTheLog) {
  const auto arm = read("t,q_turn\n1.0,0.0\n1.1,0.2\n3.0,0.4\n");
  ASSERT_TRUE(arm) << arm.error().to_string();
  ASSERT_TRUE(arm->has_value());
  const Duration max_gap(500'000'000);
  EXPECT_NEAR((*arm)->position_at(Stamp::from_seconds(1.05), max_gap).value()[0], 0.1, 1e-9);
  EXPECT_NEAR((*arm)->position_at(Stamp::from_seconds(1.0), max_gap).value()[0], 0.0, 1e-9);
  EXPECT_FALSE((*arm)->position_at(Stamp::from_seconds(0.9), max_gap));
  EXPECT_FALSE((*arm)->position_at(Stamp::from_seconds(2.0), max_gap));  // a gap
  EXPECT_FALSE((*arm)->position_at(Stamp::from_seconds(3.1), max_gap));
}

TEST_F(RecordedArmTest, FaultsAreNamed) {
  const auto other = read("t,q_shoulder\n1.0,0.0\n1.1,0.2\n");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().to_string().find("shoulder"), std::string::npos);
  const auto tip = read("t,q_turn\n1.0,0.0\n1.1,0.2\n", "hand");
  ASSERT_FALSE(tip);
  EXPECT_NE(tip.error().to_string().find("hand"), std::string::npos);
}

TEST_F(RecordedArmTest, TheSceneManifestSurvivesARoundTrip) {
  const auto arm = read("t,q_turn\n1.0,0.0\n1.1,0.25\n");
  ASSERT_TRUE(arm);
  SceneManifest manifest;
  const SceneRobot robot = scene_robot_of(**arm);
  EXPECT_EQ(robot.tip, "bar");
  ASSERT_EQ(robot.links.size(), 1U);
  manifest.levels_of_detail = {kDisplayFile};
  manifest.voxel_size = 0.005;
  manifest.robot = SceneRobotEntry{.urdf = kRobotFile,
                                   .T_base_robot = robot.T_base_robot,
                                   .tip = robot.tip,
                                   .joints = robot.joints,
                                   .position = robot.position,
                                   .links = {{robot.links[0].name, link_file(0)}}};
  const auto same = parse_scene_manifest(format_scene_manifest(manifest), "scene.yaml");
  ASSERT_TRUE(same) << same.error().to_string();
  ASSERT_TRUE(same->robot.has_value());
  EXPECT_EQ(same->robot->joints, std::vector<std::string>{"turn"});
  EXPECT_EQ(same->robot->position, std::vector<double>{0.25});
  EXPECT_EQ(same->robot->links[0].mesh, "robot/link_0.glb");
  EXPECT_EQ(same->robot->T_base_robot.translation().x(), 1.0);
}

// A camera 1 m above the bar, looking down, over a floor: the bar's pixels alone, at both ends of
// its turn.
TEST_F(RecordedArmTest, ItsPixelsAreMaskedWhereItIsAtTheFramesStamp) {
  const auto arm = read("t,q_turn\n1.0,0.0\n2.0,1.570796327\n");
  ASSERT_TRUE(arm);
  PerceptionOptions options;
  options.masks.max_tool_gap = 2.0;
  ArmMask masks(&**arm, options);
  CameraModel camera;
  camera.width = 200;
  camera.height = 200;
  camera.fx = camera.fy = 200.0;
  camera.cx = camera.cy = 99.5;
  Eigen::Matrix3d R_base_camera;
  R_base_camera << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Pose T_base_camera(Eigen::Quaterniond(R_base_camera), {1.0, 0.0, 1.52});
  RgbdFrame frame;
  frame.depth = DepthImage(camera.width, camera.height);
  for (float& depth : frame.depth.pixels()) depth = 1.52F;
  const auto masked_at = [&](double t) {
    frame.depth_stamp = Stamp::from_seconds(t);
    MaskImage mask(camera.width, camera.height);
    masks.mark(frame, camera, T_base_camera, mask);
    return mask;
  };
  const MaskImage start = masked_at(1.0);
  EXPECT_EQ(start(150, 100), 1);  // 0.25 m along x
  EXPECT_EQ(start(100, 50), 0);
  EXPECT_EQ(start(50, 100), 0);
  const MaskImage end = masked_at(2.0);
  EXPECT_EQ(end(150, 100), 0);
  EXPECT_EQ(end(100, 50), 1);  // 0.25 m along y
  const MaskImage after = masked_at(5.0);
  EXPECT_EQ(after(100, 50), 0);
}

}  // namespace
}  // namespace pcavr
