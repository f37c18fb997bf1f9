// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/board.hpp"

#include <gtest/gtest.h>

#include "pcavr/perception/board/board_views.hpp"

#include "board/drawn_board.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

const CameraModel kDrawnCamera{
    .width = 640, .height = 480, .fx = 600, .fy = 600, .cx = 320, .cy = 240};

TEST(ReadBoard, NamesThePartThatIsWrong) {
  for (const auto& [text, part] : {std::pair{"dots:10x10", "2 parts"},
                                   {"dots:10:25mm", "COLUMNSxROWS"},
                                   {"dots:10x10:0mm", "no length"},
                                   {"charuco:5x5:60mm:80mm:DICT_6X6_250", "smaller"},
                                   {"charuco:5x5:80mm:60mm:DICT_6X6", "no family"},
                                   {"cheese:5x5:80mm", "no board"}}) {
    const auto board = read_board(text);
    ASSERT_FALSE(board) << text;
    EXPECT_NE(board.error().to_string().find(part), std::string::npos) << board.error().to_string();
  }
}

TEST(ReadBoard, ReadsKalibrsTarget) {
  const TemporaryFolder folder;
  const std::string file = (folder.path() / "target.yaml").string();
  ASSERT_TRUE(write_file(
      file, "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\ntagSpacing: 0.3\n"));
  const auto board = read_board(file);
  ASSERT_TRUE(board) << board.error().to_string();
  EXPECT_EQ(board->points().size(), 120U);
  EXPECT_NEAR(board->pitch, 0.1144, 1e-12);
}

/// Largest distance [px] of found points from where the drawing has them.
double largest_error(const BoardView& view, const Board& board, const Pose& T_camera_board) {
  double largest = 0.0;
  const std::vector<Eigen::Vector3d> points = board.points();
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const Eigen::Vector2d expected = kDrawnCamera.project(T_camera_board * points[view.ids[i]]);
    largest = std::max(largest, (expected - view.pixels[i]).norm());
  }
  return largest;
}

TEST(ReadBoardViews, FindsEachKindOfBoardInDrawnPictures) {
  for (const char* text : {"chessboard:7x6:30mm", "charuco:6x5:40mm:30mm:DICT_5X5_100",
                           "tags:4x3:40mm:12mm:tag36h11", "dots:7x6:30mm"}) {
    const Board board = read_board(text).value();
    const BoardPaint paint(board);
    const TemporaryFolder folder;
    const Pose poses[] = {looking_at(board, 0.5, 0.2, -0.3),
                          looking_at(board, 0.6, -0.4, 0.1, 2.0)};
    for (int i = 0; i < 2; ++i) {
      write_picture(folder.path() / picture_name(i), draw_board(paint, kDrawnCamera, poses[i]));
    }
    const auto found = read_board_views(folder.path().string(), board);
    ASSERT_TRUE(found) << text << ": " << found.error().to_string();
    ASSERT_EQ(found->views.size(), 2U) << text;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(found->views[i].turns, 1) << text;
      EXPECT_GE(found->views[i].ids.size(), board.points().size() / 2) << text;
      EXPECT_LT(largest_error(found->views[i], board, poses[i]), 0.3) << text;
    }
  }
}

TEST(ReadBoardViews, NamesMirroredPicturesAndTwoBoards) {
  const Board board = read_board("tags:3x2:50mm:20mm:tag36h11").value();
  const BoardPaint paint(board);
  const TemporaryFolder folder;
  const ColorImage image = draw_board(paint, kDrawnCamera, looking_at(board, 0.9, 0.1, 0.1));
  ColorImage mirrored = image, twice = image;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      mirrored(x, y) = image(image.width() - 1 - x, y);
      twice(x, y) = image(x < 320 ? x + 160 : x - 160, y);
    }
  }
  write_picture(folder.path() / picture_name(0), mirrored);
  const auto none = read_board_views(folder.path().string(), board);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().to_string().find("mirrored"), std::string::npos);
  write_picture(folder.path() / picture_name(0), twice);
  const auto two = read_board_views(folder.path().string(), board);
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().to_string().find("two boards"), std::string::npos)
      << two.error().to_string();
  write_picture(folder.path() / picture_name(1), image);
  const auto one = read_board_views(folder.path().string(), board);
  ASSERT_TRUE(one) << one.error().to_string();
  EXPECT_EQ(one->views.size(), 1U);
  EXPECT_EQ(one->notes.size(), 1U);
}

}  // namespace
}  // namespace pcavr
