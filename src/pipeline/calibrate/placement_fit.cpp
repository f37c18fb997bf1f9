// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "placement_fit.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/physics/identification/jackknife.hpp"

namespace pcavr {
namespace {

using PlacementInformation = Eigen::Matrix<double, 7, 7>;

/// Huber's threshold in standard deviations, 95 % efficient [Huber 1981].
constexpr double kHuberOfTouch = 1.345;
/// [m] The rounding of a distance: residuals below it are alike.
constexpr double kMinGap = 1e-5;
/// Residuals beyond this many stds are not those of touches.
constexpr double kMaxGapStds = 4.0;

MeshPlacement moved(const MeshPlacement& placement, const PlacementStep& step) {
  const Vector6d twist = step.head<6>();
  return {placement.T_tracked_object * Pose::exp(twist), placement.scale + step[kObjectScale]};
}

double median_size(const std::vector<Gap>& gaps) {
  std::vector<double> sizes;
  for (const Gap& gap : gaps) sizes.push_back(std::abs(gap.value));
  return median(std::move(sizes));
}

double std_of(const std::vector<Gap>& gaps) {
  return std::max(kMinGap, kStdOverMad * median_size(gaps));
}

/// [m] rms of gaps that are not larger than is usual: a contact that is elsewhere counts as one at
/// the limit.
double usual_rms(std::vector<Gap> gaps) {
  const double limit = kMaxGapStds * std_of(gaps);
  for (Gap& gap : gaps) gap.value = std::clamp(gap.value, -limit, limit);
  return rms_of(gaps);
}

/// Sum of the weighted squares of the slopes; 1 on the diagonal of parameters that are kept.
PlacementInformation information_of(const std::vector<Gap>& gaps, const ObjectParameterSet& free,
                                    PlacementStep& right) {
  const double threshold = kHuberOfTouch * std_of(gaps);
  PlacementInformation information = PlacementInformation::Zero();
  right.setZero();
  for (const Gap& gap : gaps) {
    const double weight = std::min(1.0, threshold / std::max(std::abs(gap.value), kMinGap));
    PlacementStep slope = gap.slope;
    for (std::size_t i = 0; i < kObjectParameters; ++i) {
      if (!free[i]) slope[static_cast<Eigen::Index>(i)] = 0.0;
    }
    information += weight * slope * slope.transpose();
    right -= weight * gap.value * slope;
  }
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (!free[i]) information(at, at) = 1.0;
  }
  return information;
}

}  // namespace

std::optional<Gap> gap_of(const ContactPoint& point, const MeshPlacement& placement,
                          const BodySurface& surface, double tip_radius) {
  const Eigen::Vector3d p = placement.T_tracked_object.inverse() * point.p_tracked;
  const Touch touch = surface.touch({}, p / placement.scale, 0.0);
  if (!std::isfinite(touch.gap)) return std::nullopt;
  const Eigen::Vector3d outward = -touch.inward_base;
  Gap gap{.value = placement.scale * touch.gap - tip_radius};
  gap.slope.head<3>() = -outward;
  gap.slope.segment<3>(3) = -p.cross(outward);
  gap.slope[kObjectScale] = touch.gap - outward.dot(p) / placement.scale;
  return gap;
}

std::vector<Gap> gaps_of(const PlacementProblem& problem, const MeshPlacement& placement) {
  std::vector<Gap> gaps;
  for (const ContactPoint& point : problem.object.points) {
    if (point.contact == problem.without) continue;
    const auto gap = gap_of(point, placement, problem.surface, problem.object.tip_radius);
    if (gap) gaps.push_back(*gap);
  }
  return gaps;
}

double rms_of(const std::vector<Gap>& gaps) {
  double squares = 0.0;
  for (const Gap& gap : gaps) squares += gap.value * gap.value;
  return gaps.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(gaps.size()));
}

MeshPlacement fitted(const PlacementProblem& problem, const ObjectParameterSet& free,
                     MeshPlacement placement) {
  constexpr int kRounds = 40;
  constexpr double kDamping = 1e-6, kMaxStep = 0.02, kMinStep = 1e-6;
  for (int round = 0; round < kRounds; ++round) {
    PlacementStep right;
    PlacementInformation information = information_of(gaps_of(problem, placement), free, right);
    information.diagonal() *= 1.0 + kDamping;
    information.diagonal().array() += 1e-12;
    PlacementStep step = information.ldlt().solve(right);
    if (!step.allFinite()) break;
    const double size = std::max(step.head<3>().norm(), 0.1 * step.segment<3>(3).norm());
    if (size > kMaxStep) step *= kMaxStep / size;
    placement = moved(placement, step);
    placement.scale = std::clamp(placement.scale, 0.1, 10.0);
    if (step.norm() < kMinStep) break;
  }
  return placement;
}

double variance_of(const PlacementProblem& problem, const ObjectParameterSet& free,
                   const MeshPlacement& placement) {
  const std::vector<Gap> gaps = gaps_of(problem, placement);
  const auto fitted = static_cast<double>(std::count(free.begin(), free.end(), true));
  const double freedoms = std::max(1.0, static_cast<double>(problem.object.contacts) - fitted);
  return std::pow(std::max(kMinGap, usual_rms(gaps)), 2) * static_cast<double>(gaps.size()) /
         freedoms;
}

ObjectStds expected_stds(const PlacementProblem& problem, const ObjectParameterSet& free,
                         const MeshPlacement& placement, double variance) {
  PlacementStep unused;
  const PlacementInformation information =
      information_of(gaps_of(problem, placement), free, unused);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd{information});
  ObjectStds stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    for (Eigen::Index k = 0; k < 7; ++k) {
      stds[i] += variance * std::pow(solver.eigenvectors()(at, k), 2) /
                 std::max(solver.eigenvalues()[k], 1e-15);
    }
    stds[i] = free[i] ? std::sqrt(stds[i]) : 0.0;
  }
  return stds;
}

std::vector<MeshPlacement> without_each(const PlacementProblem& problem,
                                        const ObjectParameterSet& free,
                                        const MeshPlacement& placement) {
  std::vector<MeshPlacement> placements;
  for (std::size_t contact = 0; contact < problem.object.contacts; ++contact) {
    placements.push_back(fitted({problem.object, problem.surface, contact}, free, placement));
  }
  return placements;
}

ObjectStds jackknife_stds(const MeshPlacement& placement,
                          const std::vector<MeshPlacement>& without) {
  std::vector<PlacementStep> steps;
  for (const MeshPlacement& other : without) {
    PlacementStep& step = steps.emplace_back();
    step << (placement.T_tracked_object.inverse() * other.T_tracked_object).log(),
        other.scale - placement.scale;
  }
  ObjectStds stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    std::vector<double> values;
    for (const PlacementStep& step : steps) values.push_back(step[static_cast<Eigen::Index>(i)]);
    stds[i] = jackknife_std(values);
  }
  return stds;
}

ObjectStds mean_stds(const ObjectStds& jackknife, const ObjectStds& expected) {
  ObjectStds stds{};
  for (std::size_t i = 0; i < kObjectParameters; ++i) {
    stds[i] = std::sqrt(0.5 * (jackknife[i] * jackknife[i] + expected[i] * expected[i]));
  }
  return stds;
}

double held_out_rms(const PlacementProblem& problem, const std::vector<MeshPlacement>& without) {
  std::vector<Gap> gaps;
  for (const ContactPoint& point : problem.object.points) {
    const auto gap =
        gap_of(point, without[point.contact], problem.surface, problem.object.tip_radius);
    if (gap) gaps.push_back(*gap);
  }
  return rms_of(gaps);
}

}  // namespace pcavr
