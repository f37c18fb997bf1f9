// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Recorded rigs of other projects.
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "pcavr/base/core/random.hpp"
#include "pcavr/recordings/bag_import/pose_list.hpp"
#include "pcavr/robots/calibration/hand_eye.hpp"

#include "support/shared_data.hpp"

namespace pcavr {
namespace {

std::vector<HandEyeView> views_of(const std::filesystem::path& robot,
                                  const std::filesystem::path& camera) {
  const auto arm = read_pose_list(robot), board = read_pose_list(camera);
  EXPECT_TRUE(arm) << arm.error().to_string();
  EXPECT_TRUE(board) << board.error().to_string();
  std::map<int, Pose> boards;
  for (const ListedPose& pose : board->poses) boards[pose.number] = pose.pose;
  std::vector<HandEyeView> views;
  for (const ListedPose& pose : arm->poses) {
    const auto found = boards.find(pose.number);
    if (found == boards.end()) continue;
    views.push_back({"view " + std::to_string(pose.number), pose.pose, found->second});
  }
  return views;
}

/// The board of handeye_doosan has 7 x 5 squares of 30 mm, with the origin at a corner.
const Eigen::Vector3d kCentreOfDoosanBoard(0.105, 0.075, 0.0);

/// rms [m] of the board's centre in views that were not fitted, over random splits.
double unseen_rms(const std::vector<HandEyeView>& views, std::uint64_t first_seed, int splits,
                  std::size_t train_count) {
  double square = 0.0;
  for (int split = 0; split < splits; ++split) {
    Random random(first_seed + static_cast<std::uint64_t>(split));
    std::vector<HandEyeView> order = views;
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      std::swap(order[i], order[random.below(i + 1)]);
    }
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(train_count);
    const auto found = calibrate_hand_eye({order.begin(), middle}, {.splits = 0});
    EXPECT_TRUE(found) << found.error().to_string();
    if (!found) return 1.0;
    const double rms = board_rms(*found, {middle, order.end()}, kCentreOfDoosanBoard);
    square += rms * rms / splits;
  }
  return std::sqrt(square);
}

// Seeds 1000 to 1049 were seen while the method was chosen; these were not.
TEST(RealRigs, PutTheDoosansBoardWithin1400MicrometresOnUnseenPoses) {
  PCAVR_NEEDS_SHARED_DATA("real/handeye_doosan");
  const auto folder = shared_data("real/handeye_doosan");
  const std::vector<HandEyeView> views = views_of(folder / "poses", folder / "board_in_camera.csv");
  ASSERT_EQ(views.size(), 31U);
  const double rms = unseen_rms(views, 5000, 50, 20);
  std::printf("  board's centre on 11 unseen poses, 50 splits: %.3f mm rms\n", 1e3 * rms);
  EXPECT_LE(rms, 1.40e-3);
}

}  // namespace
}  // namespace pcavr
