// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/board/board.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"

namespace pcavr {

/// A board's points in one image: indices of Board::points() and their places [px].
struct FoundPoints {
  std::vector<std::size_t> ids = {};
  std::vector<Eigen::Vector2d> pixels = {};
};

/// The tags of a board in one image.
struct FoundTags {
  std::vector<TagDetection> tags = {};  ///< of the board's family
  int twice = 0;                        ///< ids at two places of the image
  bool is_mirrored = false;             ///< they can be read in the mirrored image only
};
[[nodiscard]] FoundTags find_tags(const GrayImage& image, const Board& board);

/// Where the tags are on a board, by the program that made it.
struct BoardLayout {
  bool is_from_top = true;      ///< ids run row by row from the top, else from the bottom [Kalibr]
  bool is_first_white = false;  ///< ChArUco: the square at the upper left has a marker
  int quarters = 0;             ///< of a turn of each tag on the board
};

/// The layout that most tags of all images fit.
[[nodiscard]] BoardLayout choose_layout(const std::vector<FoundTags>& images, const Board& board);

/// Corners of a tag grid, or the inner corners of a ChArUco board between two markers that fit.
[[nodiscard]] FoundPoints points_of_tags(const GrayImage& image, const FoundTags& found,
                                         const Board& board, const BoardLayout& layout);

/// Inner corners of a chessboard, or a grid's dots.
struct FoundGrid {
  FoundPoints points = {};
  int turns = 1;            ///< as BoardView has them
  bool is_another = false;  ///< the image shows a second board
};
[[nodiscard]] std::optional<FoundGrid> find_grid(const GrayImage& image, const Board& board);

}  // namespace pcavr
