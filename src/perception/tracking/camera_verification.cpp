// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_verification.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/imgproc.hpp>

namespace pcavr::tracking {
namespace {

// A cell is 4 % deeper than its neighbour on a plane that is seen at 80 degrees.
constexpr float kDepthTolerance = 0.02F;  // of the depth, half a cell
constexpr float kDepthStds = 6.0F;

// Less texture than this is noise.
constexpr double kMinTexture = 2.0;  // standard deviation [grey levels]
constexpr int kMinCells = 300;       // 1.5 % of the image

const cv::Size kSmallest(3, 3);  // detail [cells]: colour may be a cell off from depth
const cv::Size kLargest(27, 27);

/// A cell of one view on the other one's surface.
struct Sight {
  std::size_t cell = 0;
  Eigen::Vector3f p;    ///< in the other view's depth camera [m]
  float behind = 0.0F;  ///< the other view's surface [m]; negative: that view looked through it
};

std::optional<std::size_t> cell_at(const CellGrid& grid, const Eigen::Vector2f& at) {
  const Eigen::Vector2f rounded = at + Eigen::Vector2f::Constant(0.5F);
  const bool is_inside = rounded.x() >= 0.0F && rounded.y() >= 0.0F &&
                         rounded.x() < static_cast<float>(grid.width()) &&
                         rounded.y() < static_cast<float>(grid.height());
  if (!is_inside) return std::nullopt;
  return static_cast<std::size_t>(static_cast<int>(rounded.y()) * grid.width() +
                                  static_cast<int>(rounded.x()));
}

/// The cells of `from` that fall onto a cell of `to`.
template <typename Visitor>
void for_each_sight(const CellGrid& grid, const InverseDepth& from, const InverseDepth& to,
                    const Pose& T_to_from, const Visitor& visit) {
  const CellProjector projector(grid, T_to_from);
  for (std::size_t cell = 0; cell < from.size(); ++cell) {
    const float w = from[cell];
    if (w <= 0.0F) continue;
    const Eigen::Vector3f p =
        projector.transform({grid.rays[cell].x() / w, grid.rays[cell].y() / w, 1.0F / w});
    if (p.z() <= 0.0F) continue;
    const auto at = cell_at(grid, projector.cell(p));
    if (at && to[*at] > 0.0F) visit(Sight{cell, p, p.z() - 1.0F / to[*at]});
  }
}

float tolerance(const DepthNoise& noise, float z) {
  return kDepthStds * static_cast<float>(noise.depth_std(double{z})) + kDepthTolerance * z;
}

/// Bilinear; nothing at the border.
std::optional<double> value_at(const cv::Mat& image, const Eigen::Vector2d& at) {
  const bool is_inside =
      at.x() >= 0.0 && at.y() >= 0.0 && at.x() < image.cols - 1.0 && at.y() < image.rows - 1.0;
  if (!is_inside) return std::nullopt;
  const int x = static_cast<int>(at.x());
  const int y = static_cast<int>(at.y());
  const double u = at.x() - x;
  const double v = at.y() - y;
  const auto* above = image.ptr<float>(y);
  const auto* below = image.ptr<float>(y + 1);
  return (1.0 - v) * ((1.0 - u) * double{above[x]} + u * double{above[x + 1]}) +
         v * ((1.0 - u) * double{below[x]} + u * double{below[x + 1]});
}

/// Pearson's coefficient of pairs.
class Correlation {
 public:
  void add(double a, double b) {
    ++count_;
    sum_ += Eigen::Vector2d(a, b);
    squares_ += Eigen::Vector3d(a * a, b * b, a * b);
  }
  [[nodiscard]] std::optional<double> value() const {
    if (count_ < kMinCells) return std::nullopt;
    const Eigen::Vector2d mean = sum_ / count_;
    const double var_a = squares_.x() / count_ - mean.x() * mean.x();
    const double var_b = squares_.y() / count_ - mean.y() * mean.y();
    if (std::min(var_a, var_b) < kMinTexture * kMinTexture) return std::nullopt;
    return (squares_.z() / count_ - mean.x() * mean.y()) / std::sqrt(var_a * var_b);
  }

 private:
  int count_ = 0;
  Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
  Eigen::Vector3d squares_ = Eigen::Vector3d::Zero();
};

/// Share of the cells of `from` that `to` looked through.
double share_looked_through(const CellGrid& grid, const DepthNoise& noise, const InverseDepth& from,
                            const InverseDepth& to, const Pose& T_to_from) {
  int common = 0;
  int looked_through = 0;
  for_each_sight(grid, from, to, T_to_from, [&](const Sight& sight) {
    ++common;
    if (sight.behind < -tolerance(noise, sight.p.z())) ++looked_through;
  });
  return common < kMinCells ? 0.0 : static_cast<double>(looked_through) / common;
}

}  // namespace

bool Evidence::is_plausible(const CameraTrackerOptions& options) const {
  return correlation ? *correlation - contradicted >= options.min_correlation
                     : contradicted <= options.max_contradicted;
}

cv::Mat cell_texture(const CellGrid& grid, const cv::Mat& gray) {
  const cv::Rect whole_cells(0, 0, grid.width() * grid.pixels, grid.height() * grid.pixels);
  cv::Mat cells;
  cv::resize(gray(whole_cells), cells, {grid.width(), grid.height()}, 0.0, 0.0, cv::INTER_AREA);
  cells.convertTo(cells, CV_32F);
  cv::Mat fine;
  cv::Mat coarse;
  cv::blur(cells, fine, kSmallest);
  cv::blur(cells, coarse, kLargest);
  return fine - coarse;
}

Evidence compare_views(const CellGrid& grid, const DepthNoise& noise, const View& model,
                       const View& frame, const Pose& T_model_frame) {
  const CellProjector to_frame_color(grid, frame.T_depth_color.inverse());
  const CellProjector to_model_color(grid, model.T_depth_color.inverse());
  Correlation texture;
  const auto compare_texture = [&](const Sight& sight) {
    if (std::abs(sight.behind) > tolerance(noise, sight.p.z())) return;
    const float w = (*frame.inverse_depth)[sight.cell];
    const Eigen::Vector2f& ray = grid.rays[sight.cell];
    const Eigen::Vector3f in_frame = to_frame_color.transform({ray.x() / w, ray.y() / w, 1.0F / w});
    const Eigen::Vector3f in_model = to_model_color.transform(sight.p);
    if (in_frame.z() <= 0.0F || in_model.z() <= 0.0F) return;
    const auto a = value_at(model.texture, to_model_color.cell(in_model).cast<double>());
    const auto b = value_at(frame.texture, to_frame_color.cell(in_frame).cast<double>());
    if (a && b) texture.add(*a, *b);
  };
  for_each_sight(grid, *frame.inverse_depth, *model.inverse_depth, T_model_frame, compare_texture);
  Evidence evidence;
  evidence.correlation = texture.value();
  evidence.contradicted = std::max(
      share_looked_through(grid, noise, *frame.inverse_depth, *model.inverse_depth, T_model_frame),
      share_looked_through(grid, noise, *model.inverse_depth, *frame.inverse_depth,
                           T_model_frame.inverse()));
  return evidence;
}

}  // namespace pcavr::tracking
