// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/perception/marker/tag_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/base/core/solvers.hpp"

#include "perception/marker/body_pose_problem.hpp"
#include "perception/marker/planar_pose.hpp"

namespace pcavr {
namespace {

/// More views only cost time: their errors are correlated.
constexpr std::size_t kMaxViews = 24;
/// Views whose tags give initial guesses, and rank them.
constexpr std::size_t kInitialViews = 6;
/// Initial guesses that are refined over all views.
constexpr std::size_t kRefinedGuesses = 4;
/// Errors of corners (blur, shading, lens) recur in similar views: more views than this add no
/// information.
constexpr double kIndependentViews = 8.0;
/// Residuals of two stds and less: no other pose fits better than by chance.
constexpr double kGoodCost = 4.0;
constexpr int kMaxPairIterations = 30;  // bounds the time; ends at convergence

/// One view, with the camera's pose among the unknowns.
struct PairView {
  BodyPoseProblem problem;  ///< tags: the first, the second
  Pose T_camera_first;
};

using Views = std::vector<PairView>;

void place_second(const Pose& T_first_second, SeenTag& second) {
  second.T_body_marker = T_first_second;
  second.corners_body = tag_corners(second.size);
  for (Eigen::Vector3d& corner : second.corners_body) corner = T_first_second * corner;
}

SeenTag seen_tag(const TagDetection& detection, double size, const BodyPoseOptions& options) {
  const double own = detection.corner_std > 0.0 ? detection.corner_std : options.corner_std;
  return {Pose(), size, tag_corners(size), detection.corners, std::hypot(own, options.model_std)};
}

std::vector<Pose> poses_of(const SeenTag& tag, const CameraModel& camera) {
  std::array<Eigen::Vector2d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = camera.normalise(tag.pixels[i]);
  std::vector<Pose> poses;
  for (const Pose& T_camera_marker : planar_poses(corners, tag.size)) {
    poses.push_back(T_camera_marker);
  }
  return poses;
}

Views evenly_spaced(const Views& views, std::size_t count) {
  Views chosen;
  const std::size_t used = std::min(views.size(), count);
  for (std::size_t i = 0; i < used; ++i) chosen.push_back(views[i * views.size() / used]);
  return chosen;
}

/// Sets the camera's pose in each view for this guess; returns the total cost.
double fit_cameras(const Pose& T_first_second, Views& views) {
  double cost = 0.0;
  for (PairView& view : views) {
    place_second(T_first_second, view.problem.tags[1]);
    double best = std::numeric_limits<double>::infinity();
    for (const SeenTag& tag : view.problem.tags) {
      for (const Pose& T_camera_tag : poses_of(tag, view.problem.camera)) {
        const auto refined =
            refine_body_pose(view.problem, T_camera_tag * tag.T_body_marker.inverse());
        if (!refined || refined->cost >= best) continue;
        best = refined->cost;
        view.T_camera_first = refined->T_camera_body;
      }
    }
    cost += best;
  }
  return cost;
}

double cost_of(const Pose& T_first_second, Views& views) {
  double cost = 0.0;
  for (PairView& view : views) {
    place_second(T_first_second, view.problem.tags[1]);
    for (const SeenTag& tag : view.problem.tags) {
      cost += tag_cost(view.problem, tag, view.T_camera_first);
    }
  }
  return cost;
}

/// Normal equations of one view: of its camera, of the pair, and between them.
struct ViewEquations {
  Matrix6d camera = Matrix6d::Zero();
  Matrix6d mixed = Matrix6d::Zero();  ///< camera x pair
  Matrix6d pair = Matrix6d::Zero();
  Vector6d camera_gradient = Vector6d::Zero();
  Vector6d pair_gradient = Vector6d::Zero();
};

using PointJacobian = Eigen::Matrix<double, 3, 6>;

PointJacobian point_jacobian(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) {
  PointJacobian jacobian;
  jacobian << R, -R * skew(p);
  return jacobian;
}

ViewEquations equations_of(const PairView& view, const Pose& T_first_second) {
  ViewEquations equations;
  const Eigen::Matrix3d R_camera_first = view.T_camera_first.rotation_matrix();
  const Eigen::Matrix3d R_camera_second = R_camera_first * T_first_second.rotation_matrix();
  for (std::size_t t = 0; t < 2; ++t) {
    const SeenTag& tag = view.problem.tags[t];
    const std::array<Eigen::Vector3d, 4> corners_tag = tag_corners(tag.size);
    for (std::size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d p_camera = view.T_camera_first * tag.corners_body[i];
      const Eigen::Vector2d residual =
          (view.problem.camera.project(p_camera) - tag.pixels[i]) / tag.corner_std;
      const double weight = huber_weight(residual.norm());
      const Eigen::Matrix<double, 2, 3> lens =
          projection_jacobian(view.problem.camera, p_camera) / tag.corner_std;
      const Eigen::Matrix<double, 2, 6> J =
          lens * point_jacobian(R_camera_first, tag.corners_body[i]);
      equations.camera += weight * J.transpose() * J;
      equations.camera_gradient += weight * J.transpose() * residual;
      if (t == 0) continue;
      const Eigen::Matrix<double, 2, 6> K = lens * point_jacobian(R_camera_second, corners_tag[i]);
      equations.mixed += weight * J.transpose() * K;
      equations.pair += weight * K.transpose() * K;
      equations.pair_gradient += weight * K.transpose() * residual;
    }
  }
  return equations;
}

/// One damped Gauss-Newton step over all views, by the Schur complement of the cameras.
struct PairStep {
  Pose T_first_second;
  Views views;
  Matrix6d information = Matrix6d::Zero();  ///< of the pair, at the start
};

PairStep step_from(const Pose& T_first_second, const Views& views, double damping) {
  PairStep step{T_first_second, views};
  std::vector<ViewEquations> all;
  Matrix6d left = Matrix6d::Zero();
  Vector6d right = Vector6d::Zero();
  for (const PairView& view : views) {
    ViewEquations& one = all.emplace_back(equations_of(view, T_first_second));
    one.camera.diagonal() *= 1.0 + damping;
    const Matrix6d reduced = one.mixed.transpose() * one.camera.ldlt().solve(one.mixed);
    step.information += one.pair - reduced;
    one.pair.diagonal() *= 1.0 + damping;
    left += one.pair - reduced;
    right +=
        one.pair_gradient - one.mixed.transpose() * one.camera.ldlt().solve(one.camera_gradient);
  }
  const Vector6d change = -left.ldlt().solve(right);
  step.T_first_second = T_first_second * Pose::exp(change);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Vector6d camera_change =
        -all[i].camera.ldlt().solve(all[i].camera_gradient + all[i].mixed * change);
    step.views[i].T_camera_first = views[i].T_camera_first * Pose::exp(camera_change);
  }
  return step;
}

struct Solution {
  Pose T_first_second;
  Views views;
  double cost = std::numeric_limits<double>::infinity();
};

/// Levenberg-Marquardt over the pair and all cameras.
Solution refine(const Pose& guess, Views views) {
  Solution best{guess, std::move(views)};
  best.cost = fit_cameras(guess, best.views);
  double damping = 1e-4;
  for (int i = 0; i < kMaxPairIterations && std::isfinite(best.cost) && damping < 1e8; ++i) {
    PairStep step = step_from(best.T_first_second, best.views, damping);
    const double cost = cost_of(step.T_first_second, step.views);
    const double gain = best.cost - cost;
    if (!(gain >= 0.0)) {
      damping *= 10.0;
      continue;
    }
    damping *= 0.1;
    best = {step.T_first_second, std::move(step.views), cost};
    if (gain < 1e-9 * (1.0 + cost)) break;
  }
  return best;
}

/// The poses by the two tags' own in some views, the best ones in these views.
std::vector<Pose> ranked_guesses(const Views& views) {
  Views some = evenly_spaced(views, kInitialViews);
  std::vector<std::pair<double, Pose>> ranked;
  for (const PairView& view : evenly_spaced(views, kInitialViews)) {
    for (const Pose& T_camera_first : poses_of(view.problem.tags[0], view.problem.camera)) {
      for (const Pose& T_camera_second : poses_of(view.problem.tags[1], view.problem.camera)) {
        const Pose guess = T_camera_first.inverse() * T_camera_second;
        ranked.emplace_back(fit_cameras(guess, some), guess);
      }
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Pose> guesses;
  for (const auto& [cost, guess] : ranked) {
    if (guesses.size() < kRefinedGuesses) guesses.push_back(guess);
  }
  return guesses;
}

double corner_rms_of(const Solution& solution) {
  double sum = 0.0;
  for (const PairView& view : solution.views) {
    for (const SeenTag& tag : view.problem.tags) {
      const double rms = corner_rms(view.problem, tag, view.T_camera_first);
      sum += rms * rms;
    }
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(solution.views.size())));
}

}  // namespace

std::optional<TagPairPose> solve_tag_pair(const std::vector<TagPairView>& pairs, double first_size,
                                          double second_size, const Pose& T_first_second_stated,
                                          const CameraModel& camera,
                                          const BodyPoseOptions& options) {
  Views all;
  for (const TagPairView& pair : pairs) {
    all.push_back(
        {{camera,
          {seen_tag(pair.first, first_size, options), seen_tag(pair.second, second_size, options)}},
         Pose()});
  }
  const Views views = evenly_spaced(all, kMaxViews);
  if (views.empty()) return std::nullopt;
  const double count = static_cast<double>(views.size());
  const double freedoms = std::max(1.0, 16.0 * count - 6.0 * count - 6.0);
  std::vector<Solution> solutions{refine(T_first_second_stated, views)};
  if (solutions.front().cost > kGoodCost * freedoms) {
    for (const Pose& guess : ranked_guesses(views)) solutions.push_back(refine(guess, views));
  }
  const auto best =
      std::min_element(solutions.begin(), solutions.end(),
                       [](const Solution& a, const Solution& b) { return a.cost < b.cost; });
  if (!std::isfinite(best->cost)) return std::nullopt;
  const double scale = std::max(1.0, best->cost / freedoms);
  // The first one began at the stated pose.
  const bool is_stated_as_good = solutions.front().cost - best->cost < options.min_cost_gap * scale;
  const Solution& chosen = is_stated_as_good ? solutions.front() : *best;
  const Matrix6d information = step_from(chosen.T_first_second, chosen.views, 0.0).information;
  const Matrix6d covariance = information.ldlt().solve(Matrix6d::Identity()) * scale *
                              std::max(1.0, count / kIndependentViews);
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
  return TagPairPose{chosen.T_first_second, covariance, corner_rms_of(chosen), views.size()};
}

}  // namespace pcavr
