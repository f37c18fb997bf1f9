// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "marker/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include "marker/edge_fit.hpp"

namespace pcavr {
namespace {

using Vector2d = Eigen::Vector2d;

/// How far from an edge pixels are used [px]: a blur of 0.5 to 1 px is over there.
constexpr double kWidestReach = 3.0;
constexpr double kNarrowestReach = 1.2;
/// The next row of cells begins one cell away, and its blur a little before.
constexpr double kReachInCells = 0.75;
/// Columns of pixels along an edge that are looked at, first to come near and then to be exact;
/// the error of long edges is no longer the noise's, so that more cost time and gain nothing.
constexpr int kCoarseStations = 16;
constexpr int kFineStations = 80;

/// Pixels, and the same without the lens's distortion [px].
class Straightener {
 public:
  explicit Straightener(const std::optional<CameraModel>& lens)
      : lens_(lens && lens->has_distortion() ? lens : std::nullopt) {}

  [[nodiscard]] Vector2d straighten(const Vector2d& pixel) const {
    if (!lens_) return pixel;
    const Vector2d p = lens_->normalise(pixel);
    return {lens_->fx * p.x() + lens_->cx, lens_->fy * p.y() + lens_->cy};
  }
  [[nodiscard]] Vector2d bend(const Vector2d& straight) const {
    if (!lens_) return straight;
    return lens_->project(
        {(straight.x() - lens_->cx) / lens_->fx, (straight.y() - lens_->cy) / lens_->fy, 1.0});
  }
  /// How far a straight edge may bow between its corners [px].
  [[nodiscard]] double bow(const Vector2d& a, const Vector2d& b) const {
    if (!lens_) return 0.0;
    return (bend(0.5 * (straighten(a) + straighten(b))) - 0.5 * (a + b)).norm();
  }

 private:
  std::optional<CameraModel> lens_;
};

struct Line {
  Vector2d middle;
  Vector2d direction;  ///< unit length
  double length = 0.0;

  [[nodiscard]] Vector2d normal() const { return {-direction.y(), direction.x()}; }
};

Line line_between(const Vector2d& a, const Vector2d& b) {
  return {0.5 * (a + b), (b - a).normalized(), (b - a).norm()};
}

/// The pixels within `reach` of the edge from a to b, except near its ends, where the next edges
/// show.
std::vector<EdgeSample> samples_near(const GrayImage& image, const Straightener& lens,
                                     const Vector2d& a, const Vector2d& b, double reach,
                                     int max_stations) {
  const Line seen = line_between(a, b);
  const Line straight = line_between(lens.straighten(a), lens.straighten(b));
  const double half_length = 0.5 * straight.length - reach - 1.0;
  std::vector<EdgeSample> samples;
  // Walk along the axis to which the edge is closer, and at each step across it.
  const int major = std::abs(seen.direction.x()) > std::abs(seen.direction.y()) ? 0 : 1;
  const int minor = 1 - major;
  const double width = (reach + lens.bow(a, b)) / std::abs(seen.direction(major));
  const int first = static_cast<int>(std::ceil(std::min(a(major), b(major))));
  const int last = static_cast<int>(std::floor(std::max(a(major), b(major))));
  const int stride = std::max(1, (last - first) / max_stations);
  for (int i = first; i <= last; i += stride) {
    const double t = (i - seen.middle(major)) / seen.direction(major);
    const double at = seen.middle(minor) + t * seen.direction(minor);
    for (int j = static_cast<int>(std::ceil(at - width)); j <= at + width; ++j) {
      const int x = major == 0 ? i : j;
      const int y = major == 0 ? j : i;
      if (!image.contains(x, y)) continue;
      const Vector2d d = lens.straighten({x, y}) - straight.middle;
      const EdgeSample sample{d.dot(straight.direction), d.dot(straight.normal()),
                              static_cast<double>(image(x, y))};
      if (std::abs(sample.along) > half_length || std::abs(sample.across) > reach) continue;
      samples.push_back(sample);
    }
  }
  return samples;
}

/// A line n . p = c in straightened pixels, and how sure it is.
struct FittedLine {
  Line guess;
  EdgeFit fit;

  [[nodiscard]] Vector2d n() const { return guess.normal() - fit.slope * guess.direction; }
  [[nodiscard]] double c() const { return n().dot(guess.middle) + fit.offset; }
  /// Variance of the offset at a point [px^2].
  [[nodiscard]] double variance_at(const Vector2d& point) const {
    const Vector2d arm(1.0, (point - guess.middle).dot(guess.direction));
    return arm.dot(fit.covariance * arm);
  }
};

/// Distance of the far side of the quadrilateral from the edge between corners i and i + 1.
double depth_behind(const std::array<Vector2d, 4>& corners, std::size_t i) {
  const Line edge = line_between(corners[i], corners[(i + 1) % 4]);
  const Vector2d far = 0.5 * (corners[(i + 2) % 4] + corners[(i + 3) % 4]);
  return std::abs((far - edge.middle).dot(edge.normal()));
}

struct Meeting {
  Vector2d point;
  double variance = 0.0;  ///< mean of both coordinates [px^2]
};

std::optional<Meeting> meet(const FittedLine& first, const FittedLine& second) {
  Eigen::Matrix2d normals;
  normals << first.n().transpose(), second.n().transpose();
  // Lines within 6 degrees of parallel meet nowhere in particular.
  if (std::abs(normals.determinant()) < 0.1) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();
  Meeting meeting;
  meeting.point = inverse * Vector2d(first.c(), second.c());
  const Vector2d variances(first.variance_at(meeting.point), second.variance_at(meeting.point));
  meeting.variance = 0.5 * (inverse * variances.asDiagonal() * inverse.transpose()).trace();
  return meeting;
}

std::optional<RefinedCorners> refine_once(const GrayImage& image,
                                          const std::array<Vector2d, 4>& corners, int cells,
                                          const Straightener& lens, int max_stations) {
  std::array<FittedLine, 4> lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[(i + 1) % 4];
    const double reach =
        std::clamp(kReachInCells * depth_behind(corners, i) / cells, kNarrowestReach, kWidestReach);
    const auto fit = fit_edge(samples_near(image, lens, a, b, reach, max_stations), reach);
    if (!fit) return std::nullopt;
    lines[i] = {line_between(lens.straighten(a), lens.straighten(b)), *fit};
  }
  RefinedCorners refined;
  double variance = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto meeting = meet(lines[(i + 3) % 4], lines[i]);
    if (!meeting) return std::nullopt;
    refined.corners[i] = lens.bend(meeting->point);
    variance += 0.25 * meeting->variance;
    // Written so that what is not a number fails.
    if (!((refined.corners[i] - corners[i]).norm() <= 2.0 * kWidestReach)) return std::nullopt;
  }
  refined.sigma = std::sqrt(variance);
  return refined;
}

}  // namespace

std::optional<RefinedCorners> refine_corners(const GrayImage& image,
                                             const std::array<Vector2d, 4>& corners, int cells,
                                             const std::optional<CameraModel>& lens) {
  const Straightener straightener(lens);
  const auto first = refine_once(image, corners, cells, straightener, kCoarseStations);
  if (!first) return std::nullopt;
  // Again from the better corners, so that the pixels used lie evenly about the edges.
  return refine_once(image, first->corners, cells, straightener, kFineStations);
}

}  // namespace pcavr
