// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/parallel.hpp"
#include "pcavr/base/geometry/image.hpp"
#include "pcavr/perception/board/board.hpp"

namespace pcavr {

/// What one picture shows of a board.
struct BoardView {
  std::string name = {};                     ///< as messages name it: "view 7"
  std::string file = {};                     ///< empty: the picture is none
  int number = 0;                            ///< that ends the file's name, or its index
  std::vector<std::size_t> ids = {};         ///< indices of Board::points()
  std::vector<Eigen::Vector2d> pixels = {};  ///< where they are [px]
  /// Of a board that looks alike when it is turned, without a larger dot or an odd number of
  /// squares: how many orientations can't be distinguished, 1, 2 or 4.
  int turns = 1;
};

struct BoardViews {
  int width = 0, height = 0;            ///< [px] of all pictures
  std::vector<BoardView> views = {};    ///< by number; pictures without the board are left out
  std::vector<std::string> notes = {};  ///< for the user: pictures that were left out, and why
};

/// Finds the board in each picture (PNG or JPEG) of a folder, which may be named by what its files'
/// names begin with ("rig/color" for rig/color_0.png, rig/color_1.png): ChArUco boards and tag
/// grids by their tags, in either order of rows and either colour of the first square, whichever
/// fits; chessboards and dot grids by OpenCV. Pictures that are mirrored, show two boards or none
/// are left out by name; an Error where all are, or where sizes differ. Thread-safe.
[[nodiscard]] Expected<BoardViews> read_board_views(const std::string& pictures, const Board& board,
                                                    Parallelism parallelism = {});

/// The same for pictures in memory, whose indices are their numbers: "picture 7" in messages.
[[nodiscard]] Expected<BoardViews> find_board_views(std::span<const GrayImage> pictures,
                                                    const Board& board,
                                                    Parallelism parallelism = {});

}  // namespace pcavr
