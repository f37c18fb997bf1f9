// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/pose_list.hpp"

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class PoseLists : public ::testing::Test {
 protected:
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = folder_.path() / name;
    EXPECT_TRUE(write_file(file, text));
    return file.string();
  }
  [[nodiscard]] std::string error_of(const std::string& text) const {
    const auto list = read_pose_list(write("poses.csv", text));
    return list ? "no error" : list.error().to_string().substr(folder_.path().string().size() + 1);
  }
  TemporaryFolder folder_;
};

TEST_F(PoseLists, ReadsNamesThatAllEndAlikeAndStampsBeforeZero) {
  const auto list = read_pose_list(
      write("a.csv",
            "\"t_tool\",\"x_tool\",\"y_tool\",\"z_tool\",\"qx_tool\",\"qy_tool\",\"qz_tool\","
            "\"qw_tool\"\n\"-16.5\",\"1\",\"2\",\"3\",\"0\",\"0\",\"0\",\"1\"\n"));
  ASSERT_TRUE(list) << list.error().to_string();
  ASSERT_EQ(list->poses.size(), 1U);
  EXPECT_DOUBLE_EQ(list->poses[0].stamp->seconds(), -16.5);
  EXPECT_EQ(list->poses[0].pose.translation(), Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST_F(PoseLists, ReadsNumberedRotationVectorsWithUnits) {
  const auto list = read_pose_list(
      write("a.csv", "index,rx_deg,ry_deg,rz_deg,tx_mm,ty_mm,tz_mm\n4,0,0,90,100,200,300\n"));
  ASSERT_TRUE(list) << list.error().to_string();
  EXPECT_EQ(list->poses[0].number, 4);
  EXPECT_FALSE(list->has_stamps());
  EXPECT_NEAR(list->poses[0].pose.translation().z(), 0.3, 1e-12);
  EXPECT_NEAR(list->poses[0].pose.rotation().z(), std::sqrt(0.5), 1e-12);
}

TEST_F(PoseLists, ReadsTablesWithoutAHeaderByTheirColumns) {
  const auto tum = read_pose_list(write("a.txt", "# t x y z qx qy qz qw\n1.5 1 2 3 0 0 0 1\n"));
  ASSERT_TRUE(tum) << tum.error().to_string();
  EXPECT_DOUBLE_EQ(tum->poses[0].stamp->seconds(), 1.5);
  const auto counted = read_pose_list(write("b.csv", "7,1,2,3,0,0,0,1\n8,1,2,3,0,0,0,1\n"));
  ASSERT_TRUE(counted) << counted.error().to_string();
  EXPECT_FALSE(counted->has_stamps());
  EXPECT_EQ(counted->poses[1].number, 8);
}

TEST_F(PoseLists, ReadsAFolderOfMatricesInMillimetresAndOfYaml) {
  const std::string matrix = "1 0 0 447\n0 -1 0 0\n0 0 -1 395\n0 0 0 1\n";
  (void)write("robot_2.txt", matrix);
  (void)write("robot_10.txt", matrix);
  (void)write("notes.txt", "none");
  const auto list = read_pose_list(folder_.path());
  ASSERT_TRUE(list) << list.error().to_string();
  ASSERT_EQ(list->poses.size(), 2U);
  EXPECT_EQ(list->poses[1].number, 10);
  EXPECT_NEAR(list->poses[0].pose.translation().x(), 0.447, 1e-12);
  EXPECT_NE(list->format.find("mm"), std::string::npos);
  ASSERT_EQ(list->notes.size(), 1U);
  (void)write("mount_3.yaml", "x: 1\ny: 2\nz: 3\nqx: 0\nqy: 0\nqz: 0\nqw: 1\n");
  const auto yaml = read_pose_list(folder_.path() / "mount");
  ASSERT_TRUE(yaml) << yaml.error().to_string();
  EXPECT_EQ(yaml->poses[0].number, 3);
}

TEST_F(PoseLists, BadInputIsOneLineWithFileLineAndHint) {
  EXPECT_EQ(error_of("t,x,y,z,qx,qy,qz,qw\n1,1,2,3,0,0,0,1\n2,1,2\n"),
            "poses.csv:3: has 3 columns, the header 8; the file may have been cut while it was "
            "written; --skip-bad leaves such rows out");
  EXPECT_NE(error_of("t,x,y,z,qx,qy,qz,qw\n1,1,2,3,0,0,1,1\n").find("poses.csv:2: the quaternion"),
            std::string::npos);
  EXPECT_NE(error_of("x,y,z,rx,ry,rz\n1,2,3,0,0,90\n").find("more than a turn"), std::string::npos);
  EXPECT_NE(error_of("0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1\n").find("mirrors"), std::string::npos);
  EXPECT_NE(error_of("a,b\n1,2\n").find("no columns of a pose: a, b"), std::string::npos);
  EXPECT_NE(error_of("t,x,y,z,qx,qy,qz,qw\n").find("has no poses"), std::string::npos);
}

}  // namespace
}  // namespace pcavr
