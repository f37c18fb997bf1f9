// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/pose.hpp"

namespace pcavr {

enum class BoardKind { chessboard, charuco, tags, dots };

/// A flat calibration board. Its frame: x right, y up, z out of the board towards the viewer, with
/// the origin at the lower left: the first inner corner of a chessboard (next to a black square),
/// the outer corner of a ChArUco board, that of the lower left tag of a tag grid, the centre of the
/// first dot of a dot grid (the larger one, if one is).
struct Board {
  BoardKind kind = BoardKind::chessboard;
  /// Of inner corners of a chessboard, as OpenCV and ROS count; of squares of a ChArUco board; of
  /// tags; of dots.
  int columns = 0, rows = 0;
  double pitch = 0.0;       ///< [m] from one square, tag or dot to the next
  double tag_side = 0.0;    ///< [m] of ChArUco boards and tag grids
  std::string family = {};  ///< of tags, as tag_families() names it
  std::string source = {};  ///< as it was given, for messages

  friend bool operator==(const Board&, const Board&) = default;

  /// The points [m] that a picture of it shows, z = 0: corners of squares, or of tags (four each,
  /// in the order of TagDetection::corners), or centres of dots; row by row from the lower left.
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  /// [m] The middle of its points.
  [[nodiscard]] Eigen::Vector3d centre() const;
  /// The board turned about its centre by quarters of a circle.
  [[nodiscard]] Pose turned(int quarters) const;
};

/// Reads a board from a text:
///     chessboard:COLUMNSxROWS:SQUARE               chessboard:9x6:25mm
///     charuco:COLUMNSxROWS:SQUARE:MARKER:FAMILY    charuco:5x5:80mm:60mm:DICT_6X6_250
///     tags:COLUMNSxROWS:SIDE:GAP:FAMILY            tags:6x6:88mm:26.4mm:tag36h11
///     dots:COLUMNSxROWS:SPACING                    dots:10x10:25.4mm
/// lengths in m without a unit, or cm, mm; or from Kalibr's YAML file of a target (aprilgrid,
/// checkerboard). Errors name the part that is wrong.
[[nodiscard]] Expected<Board> read_board(const std::string& text_or_file);

/// "dot grid of 10 x 10, 25.4 mm apart"
[[nodiscard]] std::string describe(const Board& board);

/// The same board at another scale: a print that is larger or smaller than stated.
[[nodiscard]] Board scaled(const Board& board, double factor);

}  // namespace pcavr
