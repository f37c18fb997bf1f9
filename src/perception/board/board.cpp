// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/board/board.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/perception/marker/tag_detector.hpp"
#include "pcavr/recordings/recording/text_rows.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace {

constexpr int kMaxSide = 100;       ///< squares, tags or dots along a side
constexpr double kMaxLength = 2.0;  ///< [m] of a square: larger ones are in another unit
constexpr char kForms[] =
    "write chessboard:9x6:25mm (inner corners), charuco:5x7:30mm:22mm:DICT_4X4_50 (squares), "
    "tags:6x6:88mm:26.4mm:tag36h11 (side, gap) or dots:10x10:25.4mm, or give Kalibr's file of a "
    "target";

Error board_error(const std::string& message) {
  return {.message = message, .place = "--board", .hint = kForms};
}

std::vector<std::string> parts_of(const std::string& text) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// [m]
std::optional<double> length_of(std::string_view text) {
  double unit = 1.0;
  for (const auto& [name, factor] :
       {std::pair<std::string_view, double>{"mm", 1e-3}, {"cm", 1e-2}, {"m", 1.0}}) {
    if (!text.ends_with(name)) continue;
    unit = factor;
    text.remove_suffix(name.size());
    break;
  }
  const std::optional<double> number = parse_number(text);
  if (!number || !(*number > 0.0) || *number * unit > kMaxLength) return std::nullopt;
  return *number * unit;
}

std::optional<int> side_of(std::string_view text) {
  const std::optional<double> number = parse_number(text);
  if (!number || *number < 1.0 || *number > kMaxSide || *number != std::floor(*number)) {
    return std::nullopt;
  }
  return static_cast<int>(*number);
}

bool is_family(const std::string& name) {
  const std::vector<std::string>& names = tag_families();
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::optional<BoardKind> kind_of(const std::string& name) {
  if (name == "chessboard" || name == "checkerboard") return BoardKind::chessboard;
  if (name == "charuco") return BoardKind::charuco;
  if (name == "tags" || name == "aprilgrid") return BoardKind::tags;
  if (name == "dots") return BoardKind::dots;
  return std::nullopt;
}

/// Refuses what no detector could find.
Expected<Board> checked(const Board& board) {
  const int min_side = board.kind == BoardKind::tags ? 1 : board.kind == BoardKind::dots ? 2 : 3;
  if (board.columns < min_side || board.rows < min_side) {
    return board_error(fmt::format("a board of {} x {} is too small: {} along each side are needed",
                                   board.columns, board.rows, min_side));
  }
  if (board.kind == BoardKind::charuco && board.tag_side >= board.pitch) {
    return board_error("the markers of a ChArUco board are smaller than its squares");
  }
  const bool has_tags = board.kind == BoardKind::charuco || board.kind == BoardKind::tags;
  if (has_tags && !is_family(board.family)) {
    return board_error("'" + board.family + "' is no family of tags that is known");
  }
  return board;
}

Expected<Board> parse_board(const std::string& text) {
  const std::vector<std::string> parts = parts_of(text);
  const std::optional<BoardKind> kind = kind_of(parts[0]);
  if (!kind) return board_error("'" + text + "' is no board");
  const bool has_tags = *kind == BoardKind::charuco || *kind == BoardKind::tags;
  if (parts.size() != (has_tags ? 5U : 3U)) {
    return board_error(fmt::format("'{}' has {} parts; {} has {}", text, parts.size(), parts[0],
                                   has_tags ? 5 : 3));
  }
  const std::size_t cross = parts[1].find('x');
  const std::string_view size = parts[1];
  const std::optional<int> columns = side_of(size.substr(0, cross));
  const std::optional<int> rows =
      cross == std::string::npos ? std::nullopt : side_of(size.substr(cross + 1));
  if (!columns || !rows) return board_error("'" + parts[1] + "' is not COLUMNSxROWS");
  Board board{.kind = *kind, .columns = *columns, .rows = *rows, .source = text};
  const std::optional<double> first = length_of(parts[2]);
  if (!first) return board_error("'" + parts[2] + "' is no length of a board");
  board.pitch = *first;
  if (has_tags) {
    const std::optional<double> second = length_of(parts[3]);
    if (!second) return board_error("'" + parts[3] + "' is no length of a board");
    board.tag_side = *kind == BoardKind::tags ? *first : *second;
    if (*kind == BoardKind::tags) board.pitch = *first + *second;
    board.family = parts[4];
  }
  return checked(board);
}

/// Kalibr's targets [https://github.com/ethz-asl/kalibr/wiki/calibration-targets].
Expected<Board> read_kalibr_target(const std::string& text, const std::string& file) {
  Expected<Board> board = parse_yaml<Board>(text, file, [&](const YamlValue& root) {
    const std::string type = root.at("target_type").text();
    Board target{.source = file};
    if (type == "aprilgrid") {
      target.kind = BoardKind::tags;
      target.columns = root.at("tagCols").integer(1, kMaxSide);
      target.rows = root.at("tagRows").integer(1, kMaxSide);
      target.tag_side = root.at("tagSize").positive_number();
      target.pitch = target.tag_side * (1.0 + root.at("tagSpacing").positive_number());
      target.family = "tag36h11";
    } else if (type == "checkerboard") {
      target.columns = root.at("targetCols").integer(3, kMaxSide);
      target.rows = root.at("targetRows").integer(3, kMaxSide);
      target.pitch = root.at("colSpacingMeters").positive_number();
      if (std::abs(root.at("rowSpacingMeters").positive_number() - target.pitch) > 1e-9) {
        root.at("rowSpacingMeters").fail("differs from colSpacingMeters", "use square squares");
      }
    } else {
      root.at("target_type").fail("is '" + type + "'", "known are aprilgrid and checkerboard");
    }
    return target;
  });
  if (!board) return board;
  return checked(*board);
}

}  // namespace

std::vector<Eigen::Vector3d> Board::points() const {
  std::vector<Eigen::Vector3d> found;
  if (kind == BoardKind::tags) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const Eigen::Vector3d corner(pitch * column, pitch * row, 0.0);
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
          found.push_back(corner + tag_side * Eigen::Vector3d(x, y, 0.0));
        }
      }
    }
    return found;
  }
  const int first = kind == BoardKind::charuco ? 1 : 0;
  for (int row = first; row < rows; ++row) {
    for (int column = first; column < columns; ++column) {
      found.emplace_back(pitch * column, pitch * row, 0.0);
    }
  }
  return found;
}

Eigen::Vector3d Board::centre() const {
  const std::vector<Eigen::Vector3d> all = points();
  return 0.5 * (all.front() + (kind == BoardKind::tags ? all[all.size() - 2] : all.back()));
}

Pose Board::turned(int quarters) const {
  const Eigen::AngleAxisd turn(0.5 * std::numbers::pi * quarters, Eigen::Vector3d::UnitZ());
  return Pose::from_translation(centre()) *
         Pose(Eigen::Quaterniond(turn), Eigen::Vector3d::Zero()) *
         Pose::from_translation(-centre());
}

Expected<Board> read_board(const std::string& text_or_file) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(text_or_file, code)) return parse_board(text_or_file);
  const Expected<std::string> text = read_file(text_or_file);
  if (!text) return text.error();
  return read_kalibr_target(*text, text_or_file);
}

std::string describe(const Board& board) {
  switch (board.kind) {
    case BoardKind::chessboard:
      return fmt::format("chessboard with {} x {} inner corners, squares of {:.4g} mm",
                         board.columns, board.rows, 1e3 * board.pitch);
    case BoardKind::charuco:
      return fmt::format("ChArUco board of {} x {} squares of {:.4g} mm, markers of {:.4g} mm, {}",
                         board.columns, board.rows, 1e3 * board.pitch, 1e3 * board.tag_side,
                         board.family);
    case BoardKind::tags:
      return fmt::format("grid of {} x {} tags of {:.4g} mm, {:.4g} mm apart, {}", board.columns,
                         board.rows, 1e3 * board.tag_side, 1e3 * (board.pitch - board.tag_side),
                         board.family);
    case BoardKind::dots:
      return fmt::format("grid of {} x {} dots, {:.4g} mm apart", board.columns, board.rows,
                         1e3 * board.pitch);
  }
  return {};
}

Board scaled(const Board& board, double factor) {
  Board result = board;
  result.pitch *= factor;
  result.tag_side *= factor;
  return result;
}

}  // namespace pcavr
