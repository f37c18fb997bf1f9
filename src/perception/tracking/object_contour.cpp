// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/tracking/object_contour.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcavr::tracking {
namespace {

/// Maximum number of scan lines in each direction; each may cross the contour twice.
constexpr int kMaxLines = 16;
/// Search range around the predicted contour [px].
constexpr int kSearchRange = 10;
/// Distance of the parallel lines from which the contour's direction is computed [px].
constexpr int kLineOffset = 2;
/// Standard deviations within which a reading lies on the body; beyond twice as many, it is behind.
constexpr double kContourGate = 4.0;
/// A face seen more obliquely than this is not extrapolated beyond the contour.
constexpr double kMinFaceCosine = 0.3;
/// Lines that cross the contour more obliquely than this localise it poorly.
constexpr double kMinCrossingCosine = 0.4;
constexpr int kBisections = 5;  // of one pixel: 0.03 px

/// The body in one frame.
class ContourView {
 public:
  ContourView(const SurfaceQuery& surface_object, const CameraModel& camera,
              const DepthImage& depth, const DepthNoise& noise, const Pose& T_camera_object)
      : surface_(surface_object),
        camera_(camera),
        depth_(depth),
        noise_(noise),
        R_object_camera_(T_camera_object.inverse().rotation_matrix()),
        p_object_camera_(T_camera_object.inverse().translation()) {}

  struct Point {
    Eigen::Vector3d p_object;
    Eigen::Vector3d normal_object;
    double depth = 0.0;
  };
  [[nodiscard]] Eigen::Vector3d ray_object(const Eigen::Vector2d& pixel) const {
    return R_object_camera_ * camera_.unproject(pixel, 1.0);
  }
  [[nodiscard]] std::optional<Point> cast(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray = ray_object(pixel);
    const auto hit = surface_.cast(p_object_camera_.cast<float>(), ray.cast<float>());
    if (!hit) return std::nullopt;
    const double z = static_cast<double>(hit->distance) / ray.norm();
    return Point{p_object_camera_ + z * ray, hit->normal.cast<double>(), z};
  }

  /// Class of a depth reading relative to the face at the contour, extrapolated to its pixel.
  enum class Reading { body, behind, no_depth, in_front, uncertain };
  [[nodiscard]] Reading classify(const Eigen::Vector2d& pixel, const Point& contour) const {
    const int x = static_cast<int>(pixel.x());
    const int y = static_cast<int>(pixel.y());
    if (!depth_.contains(x, y)) return Reading::uncertain;
    const auto measured = static_cast<double>(depth_(x, y));
    if (!(measured > 0.0)) return Reading::no_depth;
    const Eigen::Vector3d ray = ray_object(pixel);
    const double slope = contour.normal_object.dot(ray);
    double expected = contour.depth;
    if (-slope > kMinFaceCosine * ray.norm()) {
      expected = contour.normal_object.dot(contour.p_object - p_object_camera_) / slope;
    }
    const double gate = kContourGate * noise_.depth_std(contour.depth);
    if (measured < expected - gate) return Reading::in_front;
    if (measured < expected + gate) return Reading::body;
    return measured > expected + 2.0 * gate ? Reading::behind : Reading::uncertain;
  }

 private:
  const SurfaceQuery& surface_;
  const CameraModel& camera_;
  const DepthImage& depth_;
  const DepthNoise& noise_;
  Eigen::Matrix3d R_object_camera_;
  Eigen::Vector3d p_object_camera_;
};

/// A scan line from a pixel that shows the body toward one that does not, along a row or column.
struct Line {
  Eigen::Vector2d start;
  Eigen::Vector2d step;  ///< one pixel
  [[nodiscard]] Eigen::Vector2d at(double t) const { return start + t * step; }
};

struct Crossing {
  double t = 0.0;
  ContourView::Point point;
};

/// Crossing of the predicted contour with the line, by bisection between `inside` and `outside`
/// pixels from its start; nothing unless the body is hit at one and not at the other.
std::optional<Crossing> find_crossing(const ContourView& view, const Line& line, double inside,
                                      double outside) {
  std::optional<ContourView::Point> point = view.cast(line.at(inside));
  if (!point || view.cast(line.at(outside))) return std::nullopt;
  const int bisections = kBisections + static_cast<int>(std::ceil(std::log2(outside - inside)));
  for (int i = 0; i < bisections; ++i) {
    const double middle = 0.5 * (inside + outside);
    const auto hit = view.cast(line.at(middle));
    if (hit) point = hit;
    (hit ? inside : outside) = middle;
  }
  return Crossing{0.5 * (inside + outside), *point};
}

/// Outward normal of the predicted contour at a crossing, from the crossings of parallel lines.
std::optional<Eigen::Vector2d> contour_normal(const ContourView& view, const Line& line, double t) {
  const Eigen::Vector2d offset = kLineOffset * Eigen::Vector2d(-line.step.y(), line.step.x());
  const auto before = find_crossing(view, {line.start - offset, line.step}, t - 4.0, t + 4.0);
  const auto after = find_crossing(view, {line.start + offset, line.step}, t - 4.0, t + 4.0);
  if (!before || !after) return std::nullopt;
  const Eigen::Vector2d tangent = 2.0 * offset + (after->t - before->t) * line.step;
  Eigen::Vector2d normal = Eigen::Vector2d(tangent.y(), -tangent.x()).normalized();
  if (normal.dot(line.step) < 0.0) normal = -normal;
  if (normal.dot(line.step) < kMinCrossingCosine) return std::nullopt;
  return normal;
}

/// Depth edge along the line, halfway between two pixels: the end of the readings on the body;
/// nothing unless the background or no depth follows.
std::optional<double> find_depth_edge(const ContourView& view, const Line& line,
                                      const Crossing& predicted) {
  const int first = static_cast<int>(std::floor(predicted.t)) - kSearchRange;
  const int last = first + 2 * kSearchRange;
  int on_body = 0;
  for (int t = first; t + 2 <= last; ++t) {
    const ContourView::Reading current = view.classify(line.at(t), predicted.point);
    if (current == ContourView::Reading::body) {
      ++on_body;
      continue;
    }
    if (on_body == 0 || current == ContourView::Reading::in_front) return std::nullopt;
    const ContourView::Reading next = view.classify(line.at(t + 1), predicted.point);
    if (next == ContourView::Reading::body) continue;  // a single missing pixel within the body
    const ContourView::Reading beyond = view.classify(line.at(t + 2), predicted.point);
    const auto is_background = [](ContourView::Reading reading) {
      return reading == ContourView::Reading::behind || reading == ContourView::Reading::no_depth;
    };
    if (on_body < 2 || !is_background(next) || !is_background(beyond)) return std::nullopt;
    return t - 0.5;
  }
  return std::nullopt;
}

std::optional<ContourMatch> match_crossing(const ContourView& view, const Line& line, int pixels) {
  const auto predicted = find_crossing(view, line, 0.0, pixels);
  if (!predicted) return std::nullopt;
  const auto normal = contour_normal(view, line, predicted->t);
  if (!normal) return std::nullopt;
  const auto edge = find_depth_edge(view, line, *predicted);
  if (!edge) return std::nullopt;
  return ContourMatch{predicted->point.p_object, *normal,
                      (*edge - predicted->t) * normal->dot(line.step)};
}

/// Matches the contour at both ends of the body on one row or column of the image.
void scan(const ContourView& view, const Line& line, int count, int stride,
          std::vector<ContourMatch>& matches) {
  int first = -1;
  int last = -1;
  for (int t = 0; t < count; t += stride) {
    if (!view.cast(line.at(t))) continue;
    if (first < 0) first = t;
    last = t;
  }
  if (first < 0) return;
  const auto forward = match_crossing(view, {line.at(last), line.step}, stride);
  const auto backward = match_crossing(view, {line.at(first), -line.step}, stride);
  if (forward) matches.push_back(*forward);
  if (backward) matches.push_back(*backward);
}

}  // namespace

std::vector<ContourMatch> match_contour(const SurfaceQuery& surface_object,
                                        const CameraModel& camera, const DepthImage& depth,
                                        const DepthNoise& noise, const Pose& T_camera_object) {
  std::vector<ContourMatch> matches;
  const PixelRectangle area =
      visible_rectangle(surface_object.bounds(), camera, T_camera_object.inverse());
  if (area.empty()) return matches;
  const ContourView view(surface_object, camera, depth, noise, T_camera_object);
  const int width = area.x_end - area.x_begin;
  const int height = area.y_end - area.y_begin;
  const int row_stride = std::max(1, height / kMaxLines);
  const int column_stride = std::max(1, width / kMaxLines);
  for (int y = area.y_begin + row_stride / 2; y < area.y_end; y += row_stride) {
    scan(view, {Eigen::Vector2d(area.x_begin, y), Eigen::Vector2d::UnitX()}, width, column_stride,
         matches);
  }
  for (int x = area.x_begin + column_stride / 2; x < area.x_end; x += column_stride) {
    scan(view, {Eigen::Vector2d(x, area.y_begin), Eigen::Vector2d::UnitY()}, height, row_stride,
         matches);
  }
  return matches;
}

}  // namespace pcavr::tracking
