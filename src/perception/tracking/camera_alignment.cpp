// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "camera_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/base/core/solvers.hpp"

namespace pcavr::tracking {
namespace {

// Errors of neighbouring cells are correlated (the sensor's quantisation, lens errors, the model's
// noise): this many cells carry the information of one independent measurement. Tuned in the tests
// against exact poses, where errors stay within the resulting standard deviations.
constexpr double kCellsPerSample = 30.0;
constexpr double kFeaturesPerSample = 12.0;

// Corner positions from optical flow have a standard deviation of a fifth of a pixel in a sharp
// image; the estimate from the residuals may be larger.
constexpr double kMinFeatureStd = 0.2;  // [px]

constexpr int kRowsPerChunk = 15;  // eight chunks of a grid of 160 x 120 cells

/// Gauss-Newton normal equations, H * step = -g.
struct NormalEquations {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double sum_squares = 0.0;
  int in_view = 0;
  int matched = 0;
  int cells = 0;

  void add(const NormalEquations& other) {
    H += other.H;
    g += other.g;
    sum_squares += other.sum_squares;
    in_view += other.in_view;
    matched += other.matched;
    cells += other.cells;
  }
};

/// Sums in single precision over a chunk of rows.
struct ChunkSums {
  Eigen::Matrix<float, 6, 6> H = Eigen::Matrix<float, 6, 6>::Zero();
  Eigen::Matrix<float, 6, 1> g = Eigen::Matrix<float, 6, 1>::Zero();

  /// Adds the point-to-plane residual `distance` of a point `p` of the frame along `normal`, both
  /// in the frame's axes.
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
  float gate = 0.1F;  ///< matches further from the plane are outliers [m]
};

/// Weight of Tukey's biweight loss, zero beyond `cutoff`.
template <typename Scalar>
Scalar tukey_weight(Scalar residual, Scalar cutoff) {
  const Scalar ratio = residual / cutoff;
  if (ratio >= Scalar(1) || ratio <= Scalar(-1)) return Scalar(0);
  const Scalar root = Scalar(1) - ratio * ratio;
  return root * root;
}

void accumulate_rows(const AlignmentInput& input, const CellProjector& to_model,
                     const SurfaceStep& step, int first, int last, NormalEquations& sums) {
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
      const Eigen::Vector3f q = to_model.transform(p);
      if (q.z() <= 0.0F) continue;
      const Eigen::Vector2f at = to_model.cell(q);
      // Checked before the cast to int, which overflows for points near the plane z = 0.
      const Eigen::Vector2f rounded = at + Eigen::Vector2f::Constant(0.5F);
      const bool is_inside =
          at.x() >= 0.0F && at.y() >= 0.0F && rounded.x() < size.x() && rounded.y() < size.y();
      if (!is_inside) continue;
      const auto model_cell = static_cast<std::size_t>(static_cast<int>(rounded.y()) * width +
                                                       static_cast<int>(rounded.x()));
      const Eigen::Vector3f& normal = input.model->normals[model_cell];
      if (normal.isZero()) continue;
      ++sums.in_view;
      const float r = normal.dot(q - input.model->points[model_cell]);
      const auto depth_std = static_cast<float>(input.noise.depth_std(p.z()));
      if (std::abs(r) < 3.0F * depth_std) {
        ++sums.matched;
        sums.sum_squares += double{r} * double{r};
      }
      chunk.add(r, tukey_weight(r, step.gate + 3.0F * depth_std) / (depth_std * depth_std), p,
                R_frame_model * normal);
    }
  }
  sums.H += chunk.H.cast<double>();
  sums.g += chunk.g.cast<double>();
}

NormalEquations surface_equations(const AlignmentInput& input, const Pose& T_model_frame,
                                  const SurfaceStep& step, Parallelism parallelism) {
  const auto rows = static_cast<std::size_t>(input.grid->height());
  std::vector<NormalEquations> chunks((rows + kRowsPerChunk - 1) / kRowsPerChunk);
  const CellProjector to_model(*input.grid, T_model_frame);
  parallel_for(parallelism, rows, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    accumulate_rows(input, to_model, step, static_cast<int>(begin), static_cast<int>(end),
                    chunks[begin / kRowsPerChunk]);
  });
  NormalEquations total;
  for (const NormalEquations& chunk : chunks) total.add(chunk);
  return total;
}

/// Reprojection errors [px], by feature; infinite behind the camera.
std::vector<Eigen::Vector2d> feature_residuals(const AlignmentInput& input,
                                               const Pose& T_model_frame) {
  const Pose T_color_model = (T_model_frame * input.T_depth_color).inverse();
  std::vector<Eigen::Vector2d> residuals;
  residuals.reserve(input.features->size());
  for (const FeatureMatch& match : *input.features) {
    const Eigen::Vector3d p = T_color_model * match.p_model;
    const Eigen::Vector2d error =
        input.focal_length * (match.lens_jacobian * (p.hnormalized() - match.ray));
    const bool is_in_front = p.z() > 0.0 && error.allFinite();
    residuals.push_back(is_in_front ? error : Eigen::Vector2d::Constant(HUGE_VAL));
  }
  return residuals;
}

/// Robust standard deviation of one coordinate, from the median length (the median of a Rayleigh
/// distribution is 1.1774 sigma).
double estimate_feature_std(const std::vector<Eigen::Vector2d>& residuals) {
  if (residuals.empty()) return kMinFeatureStd;
  std::vector<double> lengths;
  lengths.reserve(residuals.size());
  for (const Eigen::Vector2d& r : residuals) lengths.push_back(r.norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return std::max(kMinFeatureStd, *middle / 1.1774);
}

NormalEquations feature_equations(const AlignmentInput& input, const Pose& T_model_frame,
                                  double feature_std, double cutoff) {
  const Pose T_frame_model = T_model_frame.inverse();
  const Pose T_color_frame = input.T_depth_color.inverse();
  const Eigen::Matrix3d R_color_frame = T_color_frame.rotation_matrix();
  NormalEquations sums;
  for (const FeatureMatch& match : *input.features) {
    const Eigen::Vector3d p_frame = T_frame_model * match.p_model;
    const Eigen::Vector3d p = T_color_frame * p_frame;
    if (p.z() <= 0.0) continue;
    ++sums.in_view;
    const Eigen::Vector2d r =
        input.focal_length * (match.lens_jacobian * (p.hnormalized() - match.ray));
    const double scaled = r.norm() / feature_std;
    if (!(scaled < cutoff)) continue;  // also NaN, for points near the plane z = 0
    ++sums.matched;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0 / p.z(), 0.0, -p.x() / (p.z() * p.z()),  //
        0.0, 1.0 / p.z(), -p.y() / (p.z() * p.z());
    Eigen::Matrix<double, 3, 6> motion;  // of p_frame under T * exp(twist)
    motion << -Eigen::Matrix3d::Identity(), skew(p_frame);
    if (input.has_distortion) projection = (match.lens_jacobian * projection).eval();
    const Eigen::Matrix<double, 2, 6> J = input.focal_length * projection * R_color_frame * motion;
    const double weight = tukey_weight(scaled, cutoff) / (feature_std * feature_std);
    sums.H.noalias() += weight * J.transpose() * J;
    sums.g.noalias() += weight * J.transpose() * r;
    sums.sum_squares += weight * r.squaredNorm();
  }
  return sums;
}

/// A Gauss-Newton step with slight (Levenberg-Marquardt) damping, so that unobservable directions
/// do not move.
Vector6d solve_step(const Matrix6d& H, const Vector6d& g) {
  Matrix6d damped = H;
  damped.diagonal() *= 1.0 + 1e-6;
  damped.diagonal().array() += 1e-9;
  return -damped.ldlt().solve(g);
}

constexpr double kFeatureCutoff = 4.0;  // of Tukey's biweight [std]

/// Separates the landmarks into inliers and outliers of the pose.
void classify_landmarks(const AlignmentInput& input, Alignment& alignment) {
  const std::vector<Eigen::Vector2d> residuals = feature_residuals(input, alignment.T_model_frame);
  const double threshold = kFeatureCutoff * estimate_feature_std(residuals);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::size_t landmark = (*input.features)[i].landmark;
    (residuals[i].norm() < threshold ? alignment.inliers : alignment.outliers).push_back(landmark);
  }
}

}  // namespace

bool Alignment::is_valid(const CameraTrackerOptions& options) const {
  constexpr int kMinSurfaceCells = 300;  // 1.5 % of the image
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information, Eigen::EigenvaluesOnly);
  if (eigen.eigenvalues()(0) < 1.0) return false;  // std above 1 m or 1 rad: degenerate
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity());
  if (covariance.topLeftCorner<3, 3>().trace() >
          options.max_position_std * options.max_position_std ||
      covariance.bottomRightCorner<3, 3>().trace() >
          options.max_rotation_std * options.max_rotation_std) {
    return false;
  }
  const bool has_surface = surface_in_view >= kMinSurfaceCells;
  const bool has_features = features_matched >= options.min_features;
  if (!has_surface && !has_features) return false;
  if (!evidence.is_plausible(options)) return false;
  return !has_surface || surface_matched >= options.min_inlier_ratio * surface_in_view;
}

Pose align_features(const AlignmentInput& input, const Pose& start, double initial_scale) {
  Pose T_model_frame = start;
  if (input.features->size() < 6) return T_model_frame;
  // Graduated non-convexity: the loss scale is reduced step by step.
  for (double scale = initial_scale; scale > 2.0 * kMinFeatureStd; scale *= 0.6) {
    const NormalEquations sums = feature_equations(input, T_model_frame, scale, kFeatureCutoff);
    T_model_frame = T_model_frame * Pose::exp(solve_step(sums.H, sums.g));
  }
  return T_model_frame;
}

Alignment align(const AlignmentInput& input, const Pose& start, Parallelism parallelism) {
  // Coarse to fine: few cells with a wide gate first, then every cell with a gate of the noise.
  constexpr SurfaceStep kSteps[] = {{4, 0.08F}, {4, 0.04F}, {2, 0.02F}, {2, 0.01F},
                                    {1, 0.0F},  {1, 0.0F},  {1, 0.0F}};
  Alignment result;
  result.T_model_frame = start;
  result.features = static_cast<int>(input.features->size());
  for (const SurfaceStep& step : kSteps) {
    const NormalEquations surface =
        surface_equations(input, result.T_model_frame, step, parallelism);
    const double feature_std = estimate_feature_std(feature_residuals(input, result.T_model_frame));
    const NormalEquations features =
        feature_equations(input, result.T_model_frame, feature_std, kFeatureCutoff);
    const double cells_weight = step.stride * step.stride / kCellsPerSample;
    const Matrix6d H = cells_weight * surface.H + features.H / kFeaturesPerSample;
    const Vector6d g = cells_weight * surface.g + features.g / kFeaturesPerSample;
    const Vector6d twist = solve_step(H, g);
    if (!twist.allFinite()) return result;
    result.T_model_frame = result.T_model_frame * Pose::exp(twist);
    result.information = H;
    result.surface_in_view = surface.in_view;
    result.surface_matched = surface.matched;
    result.surface_rms = std::sqrt(surface.sum_squares / std::max(1, surface.matched));
    result.overlap = surface.in_view / std::max(1.0, static_cast<double>(surface.cells));
    result.features_matched = features.matched;
    if (step.stride == 1 && twist.norm() < 1e-5) break;
  }
  classify_landmarks(input, result);
  return result;
}

}  // namespace pcavr::tracking
