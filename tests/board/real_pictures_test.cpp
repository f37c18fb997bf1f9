// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Recorded rigs of other projects.
#include <map>

#include <gtest/gtest.h>

#include "pcavr/perception/board/picture_rig.hpp"
#include "pcavr/recordings/bag_import/pose_list.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

std::vector<ArmPicture> paired(const std::filesystem::path& poses, const BoardViews& pictures) {
  const auto list = read_pose_list(poses);
  EXPECT_TRUE(list) << list.error().to_string();
  std::map<int, Pose> by_number;
  for (const ListedPose& pose : list->poses) by_number[pose.number] = pose.pose;
  std::vector<ArmPicture> views;
  for (const BoardView& view : pictures.views) views.push_back({view, by_number.at(view.number)});
  return views;
}

// Its authors: 2.90 +- 1.68 mm over the fitted views, with the nominal intrinsics.
TEST(RealPictures, PutTheKinectsDotsWithin2500MicrometresByTheArm) {
  PCAVR_NEEDS_SHARED_DATA("real/calib_kinect_10x10");
  const auto folder = shared_data("real/calib_kinect_10x10");
  const Board board = read_board("dots:10x10:25.4mm").value();
  const auto pictures = read_board_views((folder / "images").string(), board, Parallelism{2});
  ASSERT_TRUE(pictures) << pictures.error().to_string();
  ASSERT_EQ(pictures->views.size(), 15U);
  const auto found = calibrate_picture_rig(paired(folder / "poses", *pictures), pictures->width,
                                           pictures->height, board);
  ASSERT_TRUE(found) << found.error().to_string();
  std::printf("  dots on the board: %.2f +- %.2f mm fitted, %.2f +- %.2f mm left out\n",
              1e3 * found->fitted.mean, 1e3 * found->fitted.std, 1e3 * found->left_out.mean,
              1e3 * found->left_out.std);
  EXPECT_LE(found->fitted.mean, 2.5e-3);
  EXPECT_LE(found->left_out.mean, 3.2e-3);
  EXPECT_NE(found->hand_eye.notes.back().find("count as exact"), std::string::npos);
}

TEST(RealPictures, FindThatTheFrankasPosesAreCommandedOnes) {
  PCAVR_NEEDS_SHARED_DATA("real/franka_charuco");
  const auto folder = shared_data("real/franka_charuco");
  const Board board = read_board("charuco:5x5:80mm:60mm:DICT_6X6_250").value();
  const auto pictures = read_board_views((folder / "color").string(), board, Parallelism{2});
  ASSERT_TRUE(pictures) << pictures.error().to_string();
  ASSERT_EQ(pictures->views.size(), 6U);
  PictureRigOptions options;
  options.camera = CameraModel{.width = 1920,
                               .height = 1080,
                               .fx = 1363.7733154296875,
                               .fy = 1361.5714111328125,
                               .cx = 956.2984619140625,
                               .cy = 546.5812377929688};
  const auto found = calibrate_picture_rig(paired(folder / "T_base_flange_commanded", *pictures),
                                           pictures->width, pictures->height, board, options);
  ASSERT_TRUE(found) << found.error().to_string();
  // The recording's notes: the board's centre scatters by 7.8 mm rms, the pictures by 1 px.
  EXPECT_NEAR(found->hand_eye.cause.arm, 8e-3, 3e-3);
  EXPECT_LT(found->hand_eye.cause.camera, 2e-3);
  ASSERT_FALSE(found->hand_eye.notes.empty());
  EXPECT_NE(found->hand_eye.notes.front().find("commanded"), std::string::npos)
      << found->hand_eye.notes.front();
}

}  // namespace
}  // namespace pcavr
