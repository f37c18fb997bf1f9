// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "tracking/object_rim.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace pcavr::tracking {
namespace {

/// Lines across the body in each direction, at most; each may meet the outline twice.
constexpr int kLines = 16;
/// How far from the expected outline the real one is sought [px].
constexpr int kReach = 10;
/// Distance of the neighbours from which the outline's direction is taken [px].
constexpr int kAside = 2;
/// Deviations within which a reading lies on the body; twice as far behind, it is clearly not.
constexpr double kRimGate = 4.0;
/// A face seen more obliquely than this is not prolonged beyond the rim.
constexpr double kMinRimCosine = 0.3;
/// Lines that meet the outline more obliquely than this tell little of it.
constexpr double kMinCrossing = 0.4;
constexpr int kHalvings = 5;  // of one pixel: 0.03 px

/// The body in one frame.
class View {
 public:
  View(const SurfaceQuery& surface_object, const CameraModel& camera, const DepthImage& depth,
       const DepthNoise& noise, const Pose& T_camera_object)
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
  [[nodiscard]] std::optional<Point> look(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d ray = ray_object(pixel);
    const auto hit = surface_.cast(p_object_camera_.cast<float>(), ray.cast<float>());
    if (!hit) return std::nullopt;
    const double z = static_cast<double>(hit->distance) / ray.norm();
    return Point{p_object_camera_ + z * ray, hit->normal.cast<double>(), z};
  }

  /// What a pixel shows, compared with the face at the rim prolonged to it.
  enum class Reading { body, behind, nothing, before, doubtful };
  [[nodiscard]] Reading read(const Eigen::Vector2d& pixel, const Point& rim) const {
    const int x = static_cast<int>(pixel.x());
    const int y = static_cast<int>(pixel.y());
    if (!depth_.contains(x, y)) return Reading::doubtful;
    const auto measured = static_cast<double>(depth_(x, y));
    if (!(measured > 0.0)) return Reading::nothing;
    const Eigen::Vector3d ray = ray_object(pixel);
    const double slope = rim.normal_object.dot(ray);
    double expected = rim.depth;
    if (-slope > kMinRimCosine * ray.norm()) {
      expected = rim.normal_object.dot(rim.p_object - p_object_camera_) / slope;
    }
    const double gate = kRimGate * noise_.sigma(rim.depth);
    if (measured < expected - gate) return Reading::before;
    if (measured < expected + gate) return Reading::body;
    return measured > expected + 2.0 * gate ? Reading::behind : Reading::doubtful;
  }

 private:
  const SurfaceQuery& surface_;
  const CameraModel& camera_;
  const DepthImage& depth_;
  const DepthNoise& noise_;
  Eigen::Matrix3d R_object_camera_;
  Eigen::Vector3d p_object_camera_;
};

/// From a pixel that shows the body toward one that does not, along a row or column.
struct Line {
  Eigen::Vector2d start;
  Eigen::Vector2d step;  ///< one pixel
  [[nodiscard]] Eigen::Vector2d at(double t) const { return start + t * step; }
};

struct Crossing {
  double t = 0.0;
  View::Point rim;
};

/// Where the expected outline crosses the line between `inside` and `outside` pixels from its
/// start; nothing unless the body is seen at one and not at the other.
std::optional<Crossing> cross(const View& view, const Line& line, double inside, double outside) {
  std::optional<View::Point> rim = view.look(line.at(inside));
  if (!rim || view.look(line.at(outside))) return std::nullopt;
  const int halvings = kHalvings + static_cast<int>(std::ceil(std::log2(outside - inside)));
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    const auto seen = view.look(line.at(middle));
    if (seen) rim = seen;
    (seen ? inside : outside) = middle;
  }
  return Crossing{0.5 * (inside + outside), *rim};
}

/// Outward normal of the expected outline at a crossing, from the crossings of its neighbours.
std::optional<Eigen::Vector2d> outline_normal(const View& view, const Line& line, double t) {
  const Eigen::Vector2d aside = kAside * Eigen::Vector2d(-line.step.y(), line.step.x());
  const auto before = cross(view, {line.start - aside, line.step}, t - 4.0, t + 4.0);
  const auto after = cross(view, {line.start + aside, line.step}, t - 4.0, t + 4.0);
  if (!before || !after) return std::nullopt;
  const Eigen::Vector2d along = 2.0 * aside + (after->t - before->t) * line.step;
  Eigen::Vector2d normal = Eigen::Vector2d(along.y(), -along.x()).normalized();
  if (normal.dot(line.step) < 0.0) normal = -normal;
  if (normal.dot(line.step) < kMinCrossing) return std::nullopt;
  return normal;
}

/// Where readings on the body end along the line, halfway between two pixels; nothing unless they
/// begin on the body and end before something behind it.
std::optional<double> seen_end(const View& view, const Line& line, const Crossing& expected) {
  const int first = static_cast<int>(std::floor(expected.t)) - kReach;
  const int last = first + 2 * kReach;
  int on_body = 0;
  for (int t = first; t + 2 <= last; ++t) {
    const View::Reading here = view.read(line.at(t), expected.rim);
    if (here == View::Reading::body) {
      ++on_body;
      continue;
    }
    if (on_body == 0 || here == View::Reading::before) return std::nullopt;
    const View::Reading next = view.read(line.at(t + 1), expected.rim);
    if (next == View::Reading::body) continue;  // one pixel lost within the body
    const View::Reading beyond = view.read(line.at(t + 2), expected.rim);
    const auto is_clear = [](View::Reading reading) {
      return reading == View::Reading::behind || reading == View::Reading::nothing;
    };
    if (on_body < 2 || !is_clear(next) || !is_clear(beyond)) return std::nullopt;
    return t - 0.5;
  }
  return std::nullopt;
}

std::optional<RimSight> sight(const View& view, const Line& line, int pixels) {
  const auto expected = cross(view, line, 0.0, pixels);
  if (!expected) return std::nullopt;
  const auto normal = outline_normal(view, line, expected->t);
  if (!normal) return std::nullopt;
  const auto end = seen_end(view, line, *expected);
  if (!end) return std::nullopt;
  return RimSight{expected->rim.p_object, *normal, (*end - expected->t) * normal->dot(line.step)};
}

/// Goes along one row or column of the image and takes both ends of the body on it.
void scan(const View& view, const Line& line, int count, int stride,
          std::vector<RimSight>& sights) {
  int first = -1;
  int last = -1;
  for (int t = 0; t < count; t += stride) {
    if (!view.look(line.at(t))) continue;
    if (first < 0) first = t;
    last = t;
  }
  if (first < 0) return;
  const auto forward = sight(view, {line.at(last), line.step}, stride);
  const auto backward = sight(view, {line.at(first), -line.step}, stride);
  if (forward) sights.push_back(*forward);
  if (backward) sights.push_back(*backward);
}

}  // namespace

std::vector<RimSight> find_rim(const SurfaceQuery& surface_object, const CameraModel& camera,
                               const DepthImage& depth, const DepthNoise& noise,
                               const Pose& T_camera_object) {
  std::vector<RimSight> sights;
  const PixelRectangle area =
      visible_rectangle(surface_object.bounds(), camera, T_camera_object.inverse());
  if (area.empty()) return sights;
  const View view(surface_object, camera, depth, noise, T_camera_object);
  const int width = area.x_end - area.x_begin;
  const int height = area.y_end - area.y_begin;
  const int row_stride = std::max(1, height / kLines);
  const int column_stride = std::max(1, width / kLines);
  for (int y = area.y_begin + row_stride / 2; y < area.y_end; y += row_stride) {
    scan(view, {Eigen::Vector2d(area.x_begin, y), Eigen::Vector2d::UnitX()}, width, column_stride,
         sights);
  }
  for (int x = area.x_begin + column_stride / 2; x < area.x_end; x += column_stride) {
    scan(view, {Eigen::Vector2d(x, area.y_begin), Eigen::Vector2d::UnitY()}, height, row_stride,
         sights);
  }
  return sights;
}

}  // namespace pcavr::tracking
