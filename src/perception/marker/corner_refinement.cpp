// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "perception/marker/corner_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pcavr/base/core/solvers.hpp"

#include "perception/marker/edge_fit.hpp"

namespace pcavr {
namespace {

using Vector2d = Eigen::Vector2d;

/// Minimum distance from an edge within which pixels are used: one on either side [px].
constexpr double kMinReach = 1.2;
/// The next row of cells begins one cell away, and its blur a little before.
constexpr double kReachInCells = 0.75;
/// Maximum number of pixel columns along an edge in the coarse and the fine pass; the error of long
/// edges is systematic, so that more would only cost time.
constexpr int kMaxCoarseColumns = 16;
constexpr int kMaxFineColumns = 80;

/// Removes and applies lens distortion, in pixels [px].
class PixelUndistorter {
 public:
  explicit PixelUndistorter(const std::optional<CameraModel>& lens)
      : lens_(lens && lens->has_distortion() ? lens : std::nullopt) {}

  [[nodiscard]] Vector2d undistort(const Vector2d& pixel) const {
    if (!lens_) return pixel;
    const Vector2d p = lens_->normalise(pixel);
    return {lens_->fx * p.x() + lens_->cx, lens_->fy * p.y() + lens_->cy};
  }
  [[nodiscard]] Vector2d distort(const Vector2d& undistorted) const {
    if (!lens_) return undistorted;
    return lens_->project({(undistorted.x() - lens_->cx) / lens_->fx,
                           (undistorted.y() - lens_->cy) / lens_->fy, 1.0});
  }
  /// Sagitta of the distorted image of a straight edge between two corners [px].
  [[nodiscard]] double sagitta(const Vector2d& a, const Vector2d& b) const {
    if (!lens_) return 0.0;
    return (distort(0.5 * (undistort(a) + undistort(b))) - 0.5 * (a + b)).norm();
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

/// The pixels within `reach` of the edge from a to b, except near its ends, where the adjacent
/// edges are.
std::vector<EdgeSample> samples_near(const GrayImage& image, const PixelUndistorter& lens,
                                     const Vector2d& a, const Vector2d& b, double reach,
                                     int max_columns) {
  const Line distorted = line_between(a, b);
  const Line undistorted = line_between(lens.undistort(a), lens.undistort(b));
  const double half_length = 0.5 * undistorted.length - reach - 1.0;
  std::vector<EdgeSample> samples;
  // Step along the image axis closer to the edge, and scan across it at each step.
  const int major = std::abs(distorted.direction.x()) > std::abs(distorted.direction.y()) ? 0 : 1;
  const int minor = 1 - major;
  const double width = (reach + lens.sagitta(a, b)) / std::abs(distorted.direction(major));
  const int first = static_cast<int>(std::ceil(std::min(a(major), b(major))));
  const int last = static_cast<int>(std::floor(std::max(a(major), b(major))));
  const int stride = std::max(1, (last - first) / max_columns);
  for (int i = first; i <= last; i += stride) {
    const double t = (i - distorted.middle(major)) / distorted.direction(major);
    const double at = distorted.middle(minor) + t * distorted.direction(minor);
    for (int j = static_cast<int>(std::ceil(at - width)); j <= at + width; ++j) {
      const int x = major == 0 ? i : j;
      const int y = major == 0 ? j : i;
      if (!image.contains(x, y)) continue;
      const Vector2d d = lens.undistort({x, y}) - undistorted.middle;
      const EdgeSample sample{d.dot(undistorted.direction), d.dot(undistorted.normal()),
                              static_cast<double>(image(x, y))};
      if (std::abs(sample.along) > half_length || std::abs(sample.across) > reach) continue;
      samples.push_back(sample);
    }
  }
  return samples;
}

/// A line n . p = c in undistorted pixels, with its covariance.
struct FittedLine {
  Line initial;
  EdgeFit fit;

  [[nodiscard]] Vector2d n() const { return initial.normal() - fit.slope * initial.direction; }
  [[nodiscard]] double c() const { return n().dot(initial.middle) + fit.offset; }
  /// Variance of the offset at a point [px^2].
  [[nodiscard]] double variance_at(const Vector2d& point) const {
    const Vector2d arm(1.0, (point - initial.middle).dot(initial.direction));
    return arm.dot(fit.covariance * arm);
  }
};

/// Distance of the far side of the quadrilateral from the edge between corners i and i + 1.
double distance_to_far_side(const std::array<Vector2d, 4>& corners, std::size_t i) {
  const Line edge = line_between(corners[i], corners[(i + 1) % 4]);
  const Vector2d far = 0.5 * (corners[(i + 2) % 4] + corners[(i + 3) % 4]);
  return std::abs((far - edge.middle).dot(edge.normal()));
}

struct Intersection {
  Vector2d point;
  double variance = 0.0;  ///< mean of both coordinates [px^2]
};

std::optional<Intersection> intersect(const FittedLine& first, const FittedLine& second) {
  Eigen::Matrix2d normals;
  normals << first.n().transpose(), second.n().transpose();
  // Ill-conditioned: lines within 6 degrees of parallel.
  if (std::abs(normals.determinant()) < 0.1) return std::nullopt;
  const Eigen::Matrix2d inverse = normals.inverse();
  Intersection intersection;
  intersection.point = inverse * Vector2d(first.c(), second.c());
  const Vector2d variances(first.variance_at(intersection.point),
                           second.variance_at(intersection.point));
  intersection.variance = 0.5 * (inverse * variances.asDiagonal() * inverse.transpose()).trace();
  return intersection;
}

std::optional<RefinedCorners> refine_once(const GrayImage& image,
                                          const std::array<Vector2d, 4>& corners, int cells,
                                          const PixelUndistorter& lens, double max_reach,
                                          int max_columns) {
  std::array<FittedLine, 4> lines;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[(i + 1) % 4];
    const double reach =
        std::clamp(kReachInCells * distance_to_far_side(corners, i) / cells, kMinReach, max_reach);
    const auto fit = fit_edge(samples_near(image, lens, a, b, reach, max_columns), reach);
    if (!fit) return std::nullopt;
    lines[i] = {line_between(lens.undistort(a), lens.undistort(b)), *fit};
  }
  RefinedCorners refined;
  double variance = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto intersection = intersect(lines[(i + 3) % 4], lines[i]);
    if (!intersection) return std::nullopt;
    refined.corners[i] = lens.distort(intersection->point);
    variance += 0.25 * intersection->variance;
    // Negated so that NaN fails.
    if (!((refined.corners[i] - corners[i]).norm() <= 2.0 * max_reach)) return std::nullopt;
  }
  refined.corner_std = std::sqrt(variance);
  return refined;
}

}  // namespace

std::optional<RefinedCorners> refine_corners(const GrayImage& image,
                                             const std::array<Vector2d, 4>& corners, int cells,
                                             const TagDetectorOptions& options) {
  const PixelUndistorter undistorter(options.lens);
  const auto first =
      refine_once(image, corners, cells, undistorter, options.edge_reach, kMaxCoarseColumns);
  if (!first) return std::nullopt;
  // Second pass from the better corners, so that the pixels used lie symmetrically about the edges.
  return refine_once(image, first->corners, cells, undistorter, options.edge_reach,
                     kMaxFineColumns);
}

}  // namespace pcavr
