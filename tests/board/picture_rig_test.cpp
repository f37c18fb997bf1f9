// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/picture_rig.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "board/projected_views.hpp"

namespace pcavr {
namespace {

const CameraModel kRigCamera{
    .width = 1280, .height = 720, .fx = 910.0, .fy = 910.0, .cx = 640.0, .cy = 360.0};

struct RigNoise {
  double pixel = 0.3;          // [px]
  double arm_position = 5e-4;  // [m]
  double arm_rotation = 5e-4;  // [rad]
};

/// A camera on an arm, or beside it, that looks at a board from random sides.
struct DrawnRig {
  Pose T_mount_camera, T_fixed_board;
  std::vector<ArmPicture> views = {};

  DrawnRig(std::uint64_t seed, const Board& board, CameraMount mount, int count,
           const RigNoise& noise, double scale = 1.0) {
    Random random(seed);
    const auto twist = [&](double position, double rotation) {
      Vector6d v;
      for (int i = 0; i < 3; ++i) v[i] = position * random.normal();
      for (int i = 3; i < 6; ++i) v[i] = rotation * random.normal();
      return Pose::exp(v);
    };
    T_mount_camera = twist(0.1, 0.7);
    T_fixed_board = Pose::from_translation({0.5, 0.1, 0.2}) * twist(0.1, 0.5);
    const Board real = scaled(board, scale);
    for (int number = 0; number < count; ++number) {
      const Eigen::Matrix3d facing = Eigen::DiagonalMatrix<double, 3>(1.0, -1.0, -1.0);
      const Eigen::Quaterniond turn =
          Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(random.uniform(-0.6, 0.6), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(random.uniform(-1.5, 1.5), Eigen::Vector3d::UnitZ()) *
          Eigen::Quaterniond(facing);
      const Pose T_camera_board =
          Pose(turn, {random.uniform(-0.05, 0.05), random.uniform(-0.03, 0.03),
                      random.uniform(0.4, 0.6)}) *
          Pose::from_translation(-real.centre());
      const Pose T_mount_fixed = T_mount_camera * T_camera_board * T_fixed_board.inverse();
      const Pose T_base_flange =
          mount == CameraMount::arm ? T_mount_fixed.inverse() : T_mount_fixed;
      ArmPicture view{projected_view(real, kRigCamera, T_camera_board, noise.pixel, random),
                      T_base_flange * twist(noise.arm_position, noise.arm_rotation)};
      view.board.name = "view " + std::to_string(number);
      views.push_back(std::move(view));
    }
  }
};

TEST(CalibratePictureRig, RecoversCameraAndBoardWithAGivenCameraAndWithoutOne) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  for (const CameraMount mount : {CameraMount::arm, CameraMount::base}) {
    const DrawnRig rig(3, board, mount, 12, {0.0, 0.0, 0.0});
    PictureRigOptions options{.hand_eye = {.mount = mount}};
    for (const bool is_given : {true, false}) {
      if (is_given) options.camera = kRigCamera;
      const auto found = calibrate_picture_rig(rig.views, 1280, 720, board, options);
      ASSERT_TRUE(found) << found.error().to_string();
      EXPECT_LT(translation_distance(found->hand_eye.camera.T_a_b, rig.T_mount_camera), 1e-5);
      EXPECT_LT(translation_distance(found->hand_eye.board.T_a_b, rig.T_fixed_board), 1e-5);
      EXPECT_LT(found->left_out.mean, 1e-5);
      options.camera.reset();
    }
  }
}

TEST(CalibratePictureRig, StatesStdsThatHoldAndSeparatesArmFromPixels) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  int within = 0, all = 0;
  double largest = 0.0, arm = 0.0, pixel = 0.0;
  constexpr int kRigs = 30;
  for (int seed = 1; seed <= kRigs; ++seed) {
    const CameraMount mount = seed % 2 == 0 ? CameraMount::arm : CameraMount::base;
    const DrawnRig rig(static_cast<std::uint64_t>(seed), board, mount, 14, {0.3, 1e-3, 1e-3});
    PictureRigOptions options{.hand_eye = {.mount = mount, .splits = 0}, .camera = kRigCamera};
    const auto found = calibrate_picture_rig(rig.views, 1280, 720, board, options);
    ASSERT_TRUE(found) << found.error().to_string();
    for (int axis = 0; axis < 3; ++axis) {
      const double error =
          found->hand_eye.camera.T_a_b.translation()[axis] - rig.T_mount_camera.translation()[axis];
      const double stds = std::abs(error) / found->hand_eye.camera.position_std[axis].value();
      within += stds < 1.0 ? 1 : 0;
      largest = std::max(largest, stds);
      ++all;
    }
    arm += found->arm_position_std / kRigs;
    pixel += found->pixel_noise / kRigs;
  }
  std::printf("  within one std: %.0f %%, largest %.2f; arm %.2f mm, pixel %.3f px\n",
              100.0 * within / all, largest, 1e3 * arm, pixel);
  EXPECT_GE(100.0 * within / all, 56.0);
  EXPECT_LE(100.0 * within / all, 80.0);
  EXPECT_LT(largest, 5.0);
  EXPECT_NEAR(arm, 1e-3, 2e-4);
  EXPECT_NEAR(pixel, 0.3, 0.02);
}

TEST(CalibratePictureRig, FindsTheSizeOfTheSquaresByTheArm) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  const DrawnRig rig(7, board, CameraMount::arm, 14, {0.2, 3e-4, 3e-4}, 1.08);
  PictureRigOptions options;
  options.camera = kRigCamera;
  const auto found = calibrate_picture_rig(rig.views, 1280, 720, board, options);
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_TRUE(found->hand_eye.is_board_scale_used);
  EXPECT_NEAR(found->hand_eye.board_scale, 1.08, 4.0 * found->hand_eye.board_scale_std);
  EXPECT_NE(found->hand_eye.notes.back().find("squares of 32.4"), std::string::npos)
      << found->hand_eye.notes.back();
}

TEST(CalibratePictureRig, NamesABoardThatIsUpsideDownInOneView) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  DrawnRig rig(8, board, CameraMount::arm, 12, {0.2, 3e-4, 3e-4});
  std::vector<std::size_t>& ids = rig.views[5].board.ids;
  for (std::size_t& id : ids) id = board.points().size() - 1 - id;
  PictureRigOptions options;
  options.camera = kRigCamera;
  const auto found = calibrate_picture_rig(rig.views, 1280, 720, board, options);
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_TRUE(found->hand_eye.residuals[5].is_outlier);
  EXPECT_NE(found->hand_eye.notes.back().find("view 5 the board is turned by 180"),
            std::string::npos)
      << found->hand_eye.notes.back();
  // A board that looks alike when it is turned has no wrong side.
  for (ArmPicture& view : rig.views) view.board.turns = 2;
  const auto resolved = calibrate_picture_rig(rig.views, 1280, 720, board, options);
  ASSERT_TRUE(resolved) << resolved.error().to_string();
  EXPECT_FALSE(resolved->hand_eye.residuals[5].is_outlier);
}

TEST(CalibratePictureRig, NamesParallelPosesAndMirroredPictures) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  DrawnRig rig(9, board, CameraMount::arm, 12, {0.2, 3e-4, 3e-4});
  PictureRigOptions options;
  options.camera = kRigCamera;
  std::vector<ArmPicture> parallel = rig.views;
  for (ArmPicture& view : parallel) {
    view.T_base_flange =
        Pose(rig.views[0].T_base_flange.rotation(), view.T_base_flange.translation());
  }
  const auto none = calibrate_picture_rig(parallel, 1280, 720, board, options);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().to_string().find("parallel"), std::string::npos);
  for (ArmPicture& view : rig.views) {
    for (std::size_t i = 0; i < view.board.ids.size(); ++i) {
      view.board.pixels[i].x() = 1279.0 - view.board.pixels[i].x();
      // As a search finds the mirrored grid: columns run the other way.
      const std::size_t row = view.board.ids[i] / 9, column = view.board.ids[i] % 9;
      view.board.ids[i] = 9 * row + 8 - column;
    }
  }
  const auto mirrored = calibrate_picture_rig(rig.views, 1280, 720, board, options);
  ASSERT_FALSE(mirrored);
  EXPECT_NE(mirrored.error().to_string().find("mirrored"), std::string::npos)
      << mirrored.error().to_string();
}

}  // namespace
}  // namespace pcavr
