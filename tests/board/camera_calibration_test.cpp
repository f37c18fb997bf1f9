// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/camera_calibration.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "board/projected_views.hpp"
#include "perception/board/lens_slope.hpp"

namespace pcavr {
namespace {

const CameraModel kLensCamera{.width = 1280,
                              .height = 720,
                              .fx = 910.0,
                              .fy = 905.0,
                              .cx = 651.0,
                              .cy = 348.0,
                              .distortion = {-0.12, 0.06, 0.001, -0.0015, 0.0}};

TEST(LensSlope, IsTheDifferenceOfTwoLenses) {
  constexpr double kStep = 1e-6;
  const Eigen::Vector2d p(0.31, -0.22);
  for (const LensModel model : {LensModel::plumb_bob, LensModel::rational, LensModel::fisheye}) {
    std::vector<double> coefficients(coefficient_count(model));
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      coefficients[i] = (i % 2 == 0 ? -0.02 : 0.03) / static_cast<double>(i + 1);
    }
    const LensDistortion lens(model, coefficients);
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      std::vector<double> moved = coefficients;
      moved[i] += kStep;
      const Eigen::Vector2d expected =
          (LensDistortion(model, moved).distort(p) - lens.distort(p)) / kStep;
      EXPECT_LT((lens_slope(lens, p, static_cast<int>(i)) - expected).norm(), 1e-6) << i;
    }
  }
}

TEST(CalibrateCamera, FindsTheCameraOfPointsWithoutNoise) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  Random random(3);
  const auto found = calibrate_camera(projected_views(board, kLensCamera, 12, 0.0, random), board);
  ASSERT_TRUE(found) << found.error().to_string();
  EXPECT_NEAR(found->camera.fx, kLensCamera.fx, 1e-3);
  EXPECT_NEAR(found->camera.cy, kLensCamera.cy, 1e-3);
  EXPECT_NEAR(found->camera.distortion.coefficients()[0], -0.12, 1e-5);
  EXPECT_LT(found->held_out_rms.value(), 1e-3);
}

TEST(CalibrateCamera, StatesStdsThatHold) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  int within = 0, all = 0;
  double largest = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const auto found =
        calibrate_camera(projected_views(board, kLensCamera, 15, 0.3, random), board);
    ASSERT_TRUE(found) << found.error().to_string();
    const double errors[] = {found->camera.fx - kLensCamera.fx, found->camera.fy - kLensCamera.fy,
                             found->camera.cx - kLensCamera.cx, found->camera.cy - kLensCamera.cy};
    for (std::size_t i = 0; i < 4; ++i) {
      const double stds = std::abs(errors[i]) / found->stds[i];
      within += stds < 1.0 ? 1 : 0;
      largest = std::max(largest, stds);
      ++all;
    }
  }
  std::printf("  within one std: %.0f %%, largest error %.2f std\n", 100.0 * within / all, largest);
  EXPECT_GE(100.0 * within / all, 58.0);
  EXPECT_LE(100.0 * within / all, 80.0);
  EXPECT_LT(largest, 5.0);
}

TEST(CalibrateCamera, StatesWhatParallelViewsDoNotShow) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  Random random(5);
  BoardViews views = projected_views(board, kLensCamera, 8, 0.3, random, 0.0);
  const auto found = calibrate_camera(views, board);
  ASSERT_FALSE(found);
  EXPECT_NE(found.error().to_string().find("tilt"), std::string::npos);
}

TEST(CalibrateCamera, NamesTheViewThatDoesNotFit) {
  const Board board = read_board("chessboard:9x6:30mm").value();
  Random random(6);
  BoardViews views = projected_views(board, kLensCamera, 12, 0.2, random);
  for (Eigen::Vector2d& pixel : views.views[4].pixels) {
    pixel += Eigen::Vector2d(4.0 * random.normal(), 4.0 * random.normal());
  }
  const auto found = calibrate_camera(views, board);
  ASSERT_TRUE(found) << found.error().to_string();
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(found->views[i].is_outlier, i == 4) << i;
  EXPECT_NEAR(found->camera.fx, kLensCamera.fx, 5.0 * found->stds[0]);
}

}  // namespace
}  // namespace pcavr
