// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "perception/board/board_search.hpp"

namespace pcavr {
namespace {

/// Part of a tag's side by which its corners may be off the board's homography: a lens bends more
/// than any detector errs, and a wrong layout is off by a side or more.
constexpr double kMaxCornerError = 0.15;
constexpr std::size_t kMinMirrored = 3;  ///< tags that a mirrored image shows, and this one none
/// A square's corner may be searched up to this part of the way to the nearest edge of a marker.
constexpr double kSearchShare = 0.7;
constexpr int kMinWindow = 2, kMaxWindow = 15;  // [px]
constexpr double kNeighbour = 0.8;  ///< pitches from a corner to the middle of a square at it

using Corners = std::array<Eigen::Vector2d, 4>;

/// Column and row, from the lower left, of the tag's square or place.
std::optional<std::array<int, 2>> place_of_tag(int id, const Board& board,
                                               const BoardLayout& layout) {
  if (board.kind == BoardKind::tags) {
    if (id >= board.columns * board.rows) return std::nullopt;
    const int row = id / board.columns;
    return std::array{id % board.columns, layout.is_from_top ? board.rows - 1 - row : row};
  }
  int count = 0;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = 0; column < board.columns; ++column) {
      if (((row + column) % 2 == 0) != layout.is_first_white) continue;
      if (count++ == id) return std::array{column, board.rows - 1 - row};
    }
  }
  return std::nullopt;
}

/// The tag's corners on the board [m], in the order of TagDetection::corners.
std::optional<Corners> corners_on_board(int id, const Board& board, const BoardLayout& layout) {
  const auto place = place_of_tag(id, board, layout);
  if (!place) return std::nullopt;
  const double inset =
      board.kind == BoardKind::charuco ? 0.5 * (board.pitch - board.tag_side) : 0.0;
  const Eigen::Vector2d low =
      board.pitch * Eigen::Vector2d((*place)[0], (*place)[1]) + Eigen::Vector2d(inset, inset);
  const Corners upright{low, low + Eigen::Vector2d(board.tag_side, 0.0),
                        low + Eigen::Vector2d(board.tag_side, board.tag_side),
                        low + Eigen::Vector2d(0.0, board.tag_side)};
  Corners turned;
  for (std::size_t i = 0; i < 4; ++i) {
    turned[i] = upright[(i + static_cast<std::size_t>(layout.quarters)) % 4];
  }
  return turned;
}

struct PlacedTag {
  const TagDetection* tag = nullptr;
  Corners on_board;
};

cv::Point2d to_cv(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

/// The homography from board [m] to image by the corners of some tags.
cv::Mat homography_of(const std::vector<PlacedTag>& tags) {
  std::vector<cv::Point2d> board, image;
  for (const PlacedTag& placed : tags) {
    for (std::size_t i = 0; i < 4; ++i) {
      board.push_back(to_cv(placed.on_board[i]));
      image.push_back(to_cv(placed.tag->corners[i]));
    }
  }
  return cv::findHomography(board, image, 0);
}

/// The tags whose corners fit one homography.
std::vector<PlacedTag> fitting_tags(const FoundTags& found, const Board& board,
                                    const BoardLayout& layout) {
  std::vector<PlacedTag> placed;
  std::vector<cv::Point2d> on_board, image;
  for (const TagDetection& tag : found.tags) {
    const std::optional<Corners> corners = corners_on_board(tag.id.id, board, layout);
    if (!corners) continue;
    placed.push_back({&tag, *corners});
    for (std::size_t i = 0; i < 4; ++i) {
      on_board.push_back(to_cv((*corners)[i]));
      image.push_back(to_cv(tag.corners[i]));
    }
  }
  if (placed.empty()) return placed;
  std::vector<unsigned char> fits;
  const cv::Mat H =
      cv::findHomography(image, on_board, cv::RANSAC, kMaxCornerError * board.tag_side, fits);
  if (H.empty()) return {};
  std::vector<PlacedTag> kept;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const auto* of_tag = fits.data() + 4 * i;
    if (std::all_of(of_tag, of_tag + 4, [](unsigned char fit) { return fit != 0; })) {
      kept.push_back(placed[i]);
    }
  }
  return kept;
}

std::vector<BoardLayout> layouts_of(const Board& board) {
  if (board.kind == BoardKind::charuco) return {{true, false, 0}, {true, true, 0}};
  std::vector<BoardLayout> layouts;
  for (const bool is_from_top : {true, false}) {
    for (int quarters = 0; quarters < 4; ++quarters) {
      layouts.push_back({is_from_top, false, quarters});
    }
  }
  return layouts;
}

Eigen::Vector2d mapped(const cv::Mat& H, const Eigen::Vector3d& p) {
  std::vector<cv::Point2d> out;
  cv::perspectiveTransform(std::vector<cv::Point2d>{{p.x(), p.y()}}, out, H);
  return {out[0].x, out[0].y};
}

/// The corner of four squares near a place, or nothing where there is none.
std::optional<Eigen::Vector2d> refined_corner(const cv::Mat& image, const Eigen::Vector2d& start,
                                              double reach) {
  const int window = std::clamp(static_cast<int>(reach), kMinWindow, kMaxWindow);
  const int margin = window + 2;
  if (start.x() < margin || start.y() < margin || start.x() >= image.cols - margin ||
      start.y() >= image.rows - margin) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> point{
      cv::Point2f(static_cast<float>(start.x()), static_cast<float>(start.y()))};
  cv::cornerSubPix(image, point, {window, window}, {-1, -1},
                   {cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 60, 1e-3});
  const Eigen::Vector2d found(point[0].x, point[0].y);
  if ((found - start).norm() > window) return std::nullopt;
  return found;
}

FoundPoints square_corners(const GrayImage& image, const std::vector<PlacedTag>& tags,
                           const Board& board) {
  const cv::Mat view(image.height(), image.width(), CV_8UC1,
                     const_cast<std::uint8_t*>(image.pixels().data()));
  const std::vector<Eigen::Vector3d> points = board.points();
  FoundPoints found;
  for (std::size_t id = 0; id < points.size(); ++id) {
    std::vector<PlacedTag> near;
    for (const PlacedTag& placed : tags) {
      const Eigen::Vector2d middle = 0.5 * (placed.on_board[0] + placed.on_board[2]);
      if ((middle - points[id].head<2>()).norm() < kNeighbour * board.pitch) near.push_back(placed);
    }
    if (near.size() < 2) continue;
    const cv::Mat H = homography_of(near);
    if (H.empty()) continue;
    const Eigen::Vector2d start = mapped(H, points[id]);
    const double gap = 0.5 * (board.pitch - board.tag_side);
    double reach = 1e9;
    for (const auto& step : {Eigen::Vector3d(gap, 0.0, 0.0), Eigen::Vector3d(0.0, gap, 0.0)}) {
      reach = std::min(reach, kSearchShare * (mapped(H, points[id] + step) - start).norm());
    }
    const auto corner = refined_corner(view, start, reach);
    if (!corner) continue;
    found.ids.push_back(id);
    found.pixels.push_back(*corner);
  }
  return found;
}

GrayImage mirrored_image(const GrayImage& image) {
  GrayImage result(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    std::reverse_copy(image.row(y).begin(), image.row(y).end(), result.row(y).begin());
  }
  return result;
}

}  // namespace

FoundTags find_tags(const GrayImage& image, const Board& board) {
  FoundTags found;
  auto detector = TagDetector::create({board.family});
  found.tags = detector->detect(image);
  found.twice = static_cast<int>(detector->seen_twice().size());
  if (found.tags.empty() && found.twice == 0) {
    auto other = TagDetector::create({board.family});
    found.is_mirrored = other->detect(mirrored_image(image)).size() >= kMinMirrored;
  }
  return found;
}

BoardLayout choose_layout(const std::vector<FoundTags>& images, const Board& board) {
  BoardLayout best;
  std::size_t most = 0;
  for (const BoardLayout& layout : layouts_of(board)) {
    std::size_t fitting = 0;
    for (const FoundTags& found : images) fitting += fitting_tags(found, board, layout).size();
    if (fitting <= most) continue;
    most = fitting;
    best = layout;
  }
  return best;
}

FoundPoints points_of_tags(const GrayImage& image, const FoundTags& found, const Board& board,
                           const BoardLayout& layout) {
  const std::vector<PlacedTag> tags = fitting_tags(found, board, layout);
  if (board.kind == BoardKind::charuco) return square_corners(image, tags, board);
  FoundPoints points;
  for (const PlacedTag& placed : tags) {
    const auto place = place_of_tag(placed.tag->id.id, board, layout);
    const auto tag = static_cast<std::size_t>((*place)[1] * board.columns + (*place)[0]);
    for (std::size_t i = 0; i < 4; ++i) {
      points.ids.push_back(4 * tag + (i + static_cast<std::size_t>(layout.quarters)) % 4);
      points.pixels.push_back(placed.tag->corners[i]);
    }
  }
  return points;
}

}  // namespace pcavr
