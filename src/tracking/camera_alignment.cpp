// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_alignment.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace pcavr::tracking {
namespace {

// Neighbouring cells share the sensor's quantisation, lens errors and the model's own noise: so
// many of them carry the information of one independent cell. Held against exact poses in
// the tests, where errors stay within the standard deviations that follow.
constexpr double kCellsPerSample = 30.0;
constexpr double kFeaturesPerSample = 12.0;

// Positions of corners found by optical flow scatter by a fifth of a pixel where the picture is
// sharp; more where the estimate from the residuals says so.
constexpr double kMinFeatureSigma = 0.2;  // [px]

constexpr int kRowsPerChunk = 15;

struct Normals {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double squares = 0.0;
  int in_view = 0;
  int matched = 0;
  int cells = 0;

  void add(const Normals& other) {
    H += other.H;
    g += other.g;
    squares += other.squares;
    in_view += other.in_view;
    matched += other.matched;
    cells += other.cells;
  }
};

/// Sums in single precision over a chunk of rows.
struct ChunkSums {
  Eigen::Matrix<float, 6, 6> H = Eigen::Matrix<float, 6, 6>::Zero();
  Eigen::Matrix<float, 6, 1> g = Eigen::Matrix<float, 6, 1>::Zero();

  /// A distance along `normal` that a point `p` of the frame is off; both in the frame's axes.
  void add(float distance, float weight, const Eigen::Vector3f& p, const Eigen::Vector3f& normal) {
    if (weight <= 0.0F) return;
    Eigen::Matrix<float, 6, 1> J;
    J.head<3>() = normal;
    J.tail<3>() = p.cross(normal);
    const Eigen::Matrix<float, 6, 1> weighted = weight * J;
    H.noalias() += weighted * J.transpose();
    g += distance * weighted;
  }
};

struct SurfaceStep {
  int stride = 1;     ///< every n-th cell in both directions
  float gate = 0.1F;  ///< matches further off the plane are not looked at [m]
};

/// Tukey's biweight, cut off at `limit` standard deviations.
template <typename Scalar>
Scalar tukey(Scalar scaled, Scalar limit) {
  const Scalar ratio = scaled / limit;
  if (ratio >= Scalar(1) || ratio <= Scalar(-1)) return Scalar(0);
  const Scalar keep = Scalar(1) - ratio * ratio;
  return keep * keep;
}

void accumulate_rows(const AlignmentInput& input, const CellProjector& to_model,
                     const SurfaceStep& step, int first, int last, Normals& sums) {
  const CellGrid& grid = *input.grid;
  const int width = grid.width();
  const Eigen::Vector2f size(static_cast<float>(width), static_cast<float>(grid.height()));
  const Eigen::Matrix3f R_frame_model = to_model.rotation().transpose();
  ChunkSums chunk;
  for (int y = first; y < last; ++y) {
    if (y % step.stride != 0) continue;
    for (int x = 0; x < width; x += step.stride) {
      const auto cell = static_cast<std::size_t>(y * width + x);
      const float w = (*input.frame)[cell];
      if (w <= 0.0F) continue;
      ++sums.cells;
      const Eigen::Vector3f p(grid.rays[cell].x() / w, grid.rays[cell].y() / w, 1.0F / w);
      const Eigen::Vector3f q = to_model.move(p);
      if (q.z() <= 0.0F) continue;
      const Eigen::Vector2f at = to_model.cell(q);
      // Before the cast: beside the camera a cell is out of an int's range.
      const Eigen::Vector2f rounded = at + Eigen::Vector2f::Constant(0.5F);
      const bool is_inside =
          at.x() >= 0.0F && at.y() >= 0.0F && rounded.x() < size.x() && rounded.y() < size.y();
      if (!is_inside) continue;
      const auto there = static_cast<std::size_t>(static_cast<int>(rounded.y()) * width +
                                                  static_cast<int>(rounded.x()));
      const Eigen::Vector3f& normal = input.model->normals[there];
      if (normal.isZero()) continue;
      ++sums.in_view;
      const float r = normal.dot(q - input.model->points[there]);
      const auto sigma = static_cast<float>(input.noise.sigma(p.z()));
      if (std::abs(r) < 3.0F * sigma) {
        ++sums.matched;
        sums.squares += double{r} * double{r};
      }
      chunk.add(r, tukey(r, step.gate + 3.0F * sigma) / (sigma * sigma), p, R_frame_model * normal);
    }
  }
  sums.H += chunk.H.cast<double>();
  sums.g += chunk.g.cast<double>();
}

Normals surface_normals(const AlignmentInput& input, const Pose& T_model_frame,
                        const SurfaceStep& step, Parallelism parallelism) {
  const auto rows = static_cast<std::size_t>(input.grid->height());
  std::vector<Normals> chunks((rows + kRowsPerChunk - 1) / kRowsPerChunk);
  const CellProjector to_model(*input.grid, T_model_frame);
  parallel_for(parallelism, rows, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    accumulate_rows(input, to_model, step, static_cast<int>(begin), static_cast<int>(end),
                    chunks[begin / kRowsPerChunk]);
  });
  Normals total;
  for (const Normals& chunk : chunks) total.add(chunk);
  return total;
}

/// Offsets in the image [px], by feature; infinite behind the camera.
std::vector<Eigen::Vector2d> feature_residuals(const AlignmentInput& input,
                                               const Pose& T_model_frame) {
  const Pose T_color_model = (T_model_frame * input.T_depth_color).inverse();
  std::vector<Eigen::Vector2d> residuals;
  residuals.reserve(input.features->size());
  for (const FeatureMatch& match : *input.features) {
    const Eigen::Vector3d p = T_color_model * match.p_model;
    const Eigen::Vector2d offset =
        input.focal_length * (match.lens * (p.hnormalized() - match.ray));
    const bool is_in_front = p.z() > 0.0 && offset.allFinite();
    residuals.push_back(is_in_front ? offset : Eigen::Vector2d::Constant(HUGE_VAL));
  }
  return residuals;
}

/// Standard deviation of one coordinate, from the median length (that of a Rayleigh distribution
/// is 1.1774 sigma).
double feature_sigma(const std::vector<Eigen::Vector2d>& residuals) {
  if (residuals.empty()) return kMinFeatureSigma;
  std::vector<double> lengths;
  lengths.reserve(residuals.size());
  for (const Eigen::Vector2d& r : residuals) lengths.push_back(r.norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return std::max(kMinFeatureSigma, *middle / 1.1774);
}

Normals feature_normals(const AlignmentInput& input, const Pose& T_model_frame, double sigma,
                        double limit) {
  const Pose T_frame_model = T_model_frame.inverse();
  const Pose T_color_frame = input.T_depth_color.inverse();
  const Eigen::Matrix3d R_color_frame = T_color_frame.rotation_matrix();
  Normals sums;
  for (const FeatureMatch& match : *input.features) {
    const Eigen::Vector3d p_frame = T_frame_model * match.p_model;
    const Eigen::Vector3d p = T_color_frame * p_frame;
    if (p.z() <= 0.0) continue;
    ++sums.in_view;
    const Eigen::Vector2d r = input.focal_length * (match.lens * (p.hnormalized() - match.ray));
    const double scaled = r.norm() / sigma;
    if (!(scaled < limit)) continue;  // nor what is not a number, beside the camera
    ++sums.matched;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()),  //
        0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
    Eigen::Matrix<double, 3, 6> motion;  // of p_frame under T * exp(twist)
    motion << -Eigen::Matrix3d::Identity(), skew(p_frame);
    if (input.has_distortion) projection = (match.lens * projection).eval();
    const Eigen::Matrix<double, 2, 6> J = input.focal_length * projection * R_color_frame * motion;
    const double weight = tukey(scaled, limit) / (sigma * sigma);
    sums.H.noalias() += weight * J.transpose() * J;
    sums.g.noalias() += weight * J.transpose() * r;
    sums.squares += weight * r.squaredNorm();
  }
  return sums;
}

/// A Gauss-Newton step, damped a little so that directions nothing speaks about stay put.
Vector6d solve_step(const Matrix6d& H, const Vector6d& g) {
  Matrix6d damped = H;
  damped.diagonal() *= 1.0 + 1e-6;
  damped.diagonal().array() += 1e-9;
  return -damped.ldlt().solve(g);
}

constexpr double kFeatureLimit = 4.0;  // Tukey's cut-off [sigma]

/// Tells the landmarks that agree with the pose from those that don't.
void sort_landmarks(const AlignmentInput& input, Alignment& alignment) {
  const std::vector<Eigen::Vector2d> residuals = feature_residuals(input, alignment.T_model_frame);
  const double limit = kFeatureLimit * feature_sigma(residuals);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::size_t landmark = (*input.features)[i].landmark;
    (residuals[i].norm() < limit ? alignment.agreeing : alignment.straying).push_back(landmark);
  }
}

}  // namespace

bool Alignment::is_sound() const {
  constexpr double kMinSupport = 0.6;
  constexpr int kMinSurface = 300;  // cells: 1.5 % of the image
  constexpr int kMinFeatures = 12;
  constexpr double kMaxPositionSigma = 0.01;  // [m]
  constexpr double kMaxRotationSigma = 0.01;  // [rad]
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()(0) < 1.0) return false;  // 1 m or 1 rad: no information
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  if (covariance.topLeftCorner<3, 3>().trace() > kMaxPositionSigma * kMaxPositionSigma ||
      covariance.bottomRightCorner<3, 3>().trace() > kMaxRotationSigma * kMaxRotationSigma) {
    return false;
  }
  const bool has_surface = surface_in_view >= kMinSurface;
  const bool has_features = features_matched >= kMinFeatures;
  if (!has_surface && !has_features) return false;
  return !has_surface || surface_matched >= kMinSupport * surface_in_view;
}

Pose align_features(const AlignmentInput& input, const Pose& start, double coarsest_pixels) {
  Pose T_model_frame = start;
  if (input.features->size() < 6) return T_model_frame;
  for (double scale = coarsest_pixels; scale > 2.0 * kMinFeatureSigma; scale *= 0.6) {
    const Normals sums = feature_normals(input, T_model_frame, scale, kFeatureLimit);
    T_model_frame = T_model_frame * Pose::exp(solve_step(sums.H, sums.g));
  }
  return T_model_frame;
}

Alignment align(const AlignmentInput& input, const Pose& start, Parallelism parallelism) {
  // Coarse and wide first, then every cell within the noise.
  constexpr SurfaceStep kSteps[] = {{4, 0.08F}, {4, 0.04F}, {2, 0.02F}, {2, 0.01F},
                                    {1, 0.0F},  {1, 0.0F},  {1, 0.0F}};
  Alignment result;
  result.T_model_frame = start;
  result.features = static_cast<int>(input.features->size());
  for (const SurfaceStep& step : kSteps) {
    const Normals surface = surface_normals(input, result.T_model_frame, step, parallelism);
    const double sigma = feature_sigma(feature_residuals(input, result.T_model_frame));
    const Normals features = feature_normals(input, result.T_model_frame, sigma, kFeatureLimit);
    const double cells_weight = step.stride * step.stride / kCellsPerSample;
    const Matrix6d H = cells_weight * surface.H + features.H / kFeaturesPerSample;
    const Vector6d g = cells_weight * surface.g + features.g / kFeaturesPerSample;
    const Vector6d twist = solve_step(H, g);
    if (!twist.allFinite()) return result;
    result.T_model_frame = result.T_model_frame * Pose::exp(twist);
    result.information = H;
    result.surface_in_view = surface.in_view;
    result.surface_matched = surface.matched;
    result.surface_rms = std::sqrt(surface.squares / std::max(1, surface.matched));
    result.overlap = surface.in_view / std::max(1.0, static_cast<double>(surface.cells));
    result.features_matched = features.matched;
    if (step.stride == 1 && twist.norm() < 1e-5) break;
  }
  sort_landmarks(input, result);
  return result;
}

}  // namespace pcavr::tracking
