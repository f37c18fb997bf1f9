// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pcavr/base/core/median.hpp"

#include "perception/board/board_search.hpp"

namespace pcavr {
namespace {

constexpr double kDotReach = 0.45;    ///< pitches about a dot's centre that are its own
constexpr double kMinLarger = 1.5;    ///< the first dot's ink over that of the others
constexpr float kMinDotArea = 12.0F;  ///< [px^2] smaller ones have no centre to a tenth of a pixel
constexpr float kMinDotDistance = 4.0F;   ///< [px]
constexpr double kCornerWindow = 0.25;    ///< half, in pitches: no edge of another corner is in it
constexpr double kMaxCornerWindow = 8.0;  ///< [px] half: a lens bends longer edges

/// A grid of places in an image, row by row.
struct Grid {
  int columns = 0, rows = 0;
  std::vector<cv::Point2f> places = {};
  [[nodiscard]] const cv::Point2f& at(int column, int row) const {
    return places[static_cast<std::size_t>(row * columns + column)];
  }
};

Grid quarter_turned(const Grid& grid) {
  Grid turned{grid.rows, grid.columns};
  for (int row = 0; row < turned.rows; ++row) {
    for (int column = 0; column < turned.columns; ++column) {
      turned.places.push_back(grid.at(row, grid.rows - 1 - column));
    }
  }
  return turned;
}

/// With rows up where columns run to the right, as a board is seen from its front.
Grid seen_from_front(Grid grid) {
  const cv::Point2f x = grid.at(grid.columns - 1, 0) - grid.at(0, 0);
  const cv::Point2f y = grid.at(0, grid.rows - 1) - grid.at(0, 0);
  if (x.cross(y) < 0.0F) return grid;
  Grid reversed{grid.columns, grid.rows};
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      reversed.places.push_back(grid.at(column, row));
    }
  }
  return reversed;
}

/// Mean grey value in a disc.
double mean_grey(const cv::Mat& image, const cv::Point2f& centre, double radius) {
  double sum = 0.0, count = 0.0;
  const auto reach = static_cast<int>(std::ceil(radius));
  const auto middle_x = static_cast<int>(std::lround(centre.x));
  const auto middle_y = static_cast<int>(std::lround(centre.y));
  for (int y = middle_y - reach; y <= middle_y + reach; ++y) {
    for (int x = middle_x - reach; x <= middle_x + reach; ++x) {
      if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) continue;
      if (std::hypot(x - static_cast<double>(centre.x), y - static_cast<double>(centre.y)) >
          radius) {
        continue;
      }
      sum += image.at<unsigned char>(y, x);
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

/// Darkness of the first dot, or of the square inside the first corner.
double first_ink(const cv::Mat& image, const Grid& grid, BoardKind kind) {
  const cv::Point2f x = grid.at(1, 0) - grid.at(0, 0), y = grid.at(0, 1) - grid.at(0, 0);
  const double pitch = std::min(std::hypot(x.x, x.y), std::hypot(y.x, y.y));
  if (kind == BoardKind::dots) return 255.0 - mean_grey(image, grid.at(0, 0), kDotReach * pitch);
  const cv::Point2f middle =
      0.25F * (grid.at(0, 0) + grid.at(1, 0) + grid.at(0, 1) + grid.at(1, 1));
  return 255.0 - mean_grey(image, middle, 0.25 * pitch);
}

/// Turns of the grid which have the board's numbers of columns and rows.
std::vector<Grid> orientations(const Grid& grid, const Board& board) {
  std::vector<Grid> all;
  Grid turned = grid;
  for (int quarter = 0; quarter < 4; ++quarter) {
    if (turned.columns == board.columns && turned.rows == board.rows) all.push_back(turned);
    turned = quarter_turned(turned);
  }
  return all;
}

/// Keeps the orientations whose first dot is the largest, or whose first square is black.
std::vector<Grid> marked_first(const cv::Mat& image, std::vector<Grid> all, BoardKind kind) {
  std::vector<double> ink;
  for (const Grid& grid : all) ink.push_back(first_ink(image, grid, kind));
  const auto [low, high] = std::minmax_element(ink.begin(), ink.end());
  if (kind == BoardKind::dots) {
    const double background =
        255.0 -
        mean_grey(image,
                  0.25F * (all[0].at(0, 0) + all[0].at(1, 0) + all[0].at(0, 1) + all[0].at(1, 1)),
                  1.0);
    const double others = median(ink) - background;
    if (all.size() == 2 ? *high - background < kMinLarger * (*low - background)
                        : *high - background < kMinLarger * others) {
      return all;
    }
    return {all[static_cast<std::size_t>(high - ink.begin())]};
  }
  const double limit = 0.5 * (*low + *high);
  if (*high - *low < 0.2 * *high) return all;
  std::vector<Grid> kept;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (ink[i] >= limit) kept.push_back(std::move(all[i]));
  }
  return kept;
}

std::optional<Grid> search_dots(const cv::Mat& image, const Board& board) {
  cv::SimpleBlobDetector::Params params;
  params.minArea = kMinDotArea;
  params.maxArea = static_cast<float>(image.cols) * static_cast<float>(image.rows) /
                   static_cast<float>(board.columns * board.rows);
  params.minDistBetweenBlobs = kMinDotDistance;
  const cv::Ptr<cv::FeatureDetector> blobs = cv::SimpleBlobDetector::create(params);
  const cv::Size size(board.columns, board.rows);
  Grid grid{board.columns, board.rows};
  for (const int flags :
       {cv::CALIB_CB_SYMMETRIC_GRID + 0, cv::CALIB_CB_SYMMETRIC_GRID + cv::CALIB_CB_CLUSTERING}) {
    if (cv::findCirclesGrid(image, size, grid.places, flags, blobs)) return grid;
  }
  return std::nullopt;
}

/// Corners where the gradients around them meet: the search itself is up to 0.4 px off.
void refine_corners(const cv::Mat& image, Grid& grid) {
  const double pitch =
      std::min(cv::norm(grid.at(1, 0) - grid.at(0, 0)), cv::norm(grid.at(0, 1) - grid.at(0, 0)));
  const auto half = static_cast<int>(std::clamp(kCornerWindow * pitch, 2.0, kMaxCornerWindow));
  cv::cornerSubPix(image, grid.places, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 30, 1e-3});
}

std::optional<Grid> search_squares(const cv::Mat& image, const Board& board, bool is_exhaustive) {
  Grid grid{board.columns, board.rows};
  int flags = cv::CALIB_CB_NORMALIZE_IMAGE + cv::CALIB_CB_ACCURACY;
  if (is_exhaustive) flags += cv::CALIB_CB_EXHAUSTIVE;
  if (!cv::findChessboardCornersSB(image, {board.columns, board.rows}, grid.places, flags)) {
    return std::nullopt;
  }
  refine_corners(image, grid);
  return grid;
}

std::optional<Grid> search(const cv::Mat& image, const Board& board, bool is_exhaustive) {
  return board.kind == BoardKind::dots ? search_dots(image, board)
                                       : search_squares(image, board, is_exhaustive);
}

/// The image with the grid, and half a pitch about it, painted over.
cv::Mat without(const cv::Mat& image, const Grid& grid) {
  cv::Mat covered = image.clone();
  std::vector<cv::Point2f> hull;
  cv::convexHull(grid.places, hull);
  cv::Point2f middle(0.0F, 0.0F);
  for (const cv::Point2f& p : hull) middle += p * (1.0F / static_cast<float>(hull.size()));
  const float factor = 1.0F + 2.4F / static_cast<float>(std::min(grid.columns, grid.rows));
  std::vector<cv::Point> polygon;
  for (const cv::Point2f& p : hull) polygon.emplace_back(middle + factor * (p - middle));
  cv::fillConvexPoly(covered, polygon, cv::mean(image));
  return covered;
}

}  // namespace

std::optional<FoundGrid> find_grid(const GrayImage& image, const Board& board) {
  const cv::Mat view(image.height(), image.width(), CV_8UC1,
                     const_cast<std::uint8_t*>(image.pixels().data()));
  const std::optional<Grid> grid = search(view, board, true);
  if (!grid) return std::nullopt;
  const std::vector<Grid> turned =
      marked_first(view, orientations(seen_from_front(*grid), board), board.kind);
  FoundGrid found{.turns = static_cast<int>(turned.size())};
  for (std::size_t id = 0; id < turned[0].places.size(); ++id) {
    found.points.ids.push_back(id);
    found.points.pixels.emplace_back(turned[0].places[id].x, turned[0].places[id].y);
  }
  found.is_another = search(without(view, *grid), board, false).has_value();
  return found;
}

}  // namespace pcavr
