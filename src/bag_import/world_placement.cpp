// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/bag_import/world_placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <Eigen/Dense>

#include "pcavr/core/check.hpp"
#include "pcavr/core/median.hpp"
#include "pcavr/geometry/convex_hull.hpp"

namespace pcavr {
namespace {

constexpr double kPushing = 0.5;      // of the large forces: less may be the tool in the air
constexpr double kMinSpeed = 0.002;   // [m/s] of the object: slower it may be at rest
constexpr double kHalfWindow = 0.03;  // [s] for speeds: some samples of any tracker
constexpr std::size_t kMinSamples = 20;
constexpr double kMinNoise = 5e-5;   // [m] of robots and motion capture together
constexpr double kMaxError = 0.005;  // [m] of place and gap: a finger is not thicker

using Parameters = Eigen::Vector4d;  // x, y [m], turn [rad], delay [s]

/// Before: a room, any turn, and the delay of loggers and networks.
Parameters prior_stds() { return {1.0, 1.0, 3.0, 0.05}; }

Duration duration_of(double seconds) {
  return Duration{static_cast<std::int64_t>(std::llround(1e9 * seconds))};
}

/// Positive outside; to the nearest point of a convex polygon.
double signed_distance(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector2d& point) {
  double inside = -std::numeric_limits<double>::infinity();
  double outside = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i].head<2>();
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()].head<2>() - a;
    const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
    inside = std::max(inside, normal.dot(point - a));
    const double along = std::clamp(edge.dot(point - a) / edge.squaredNorm(), 0.0, 1.0);
    outside = std::min(outside, (point - a - along * edge).norm());
  }
  return inside > 0.0 ? outside : inside;
}

/// An instant at which the tip pushes the object.
struct PushInstant {
  const Trajectory* T_base_tip;  ///< never null
  Stamp stamp;
  Pose T_world_object;
  Eigen::Vector2d direction_base;  ///< of the tip's motion, unit length
};

std::optional<Eigen::Vector3d> velocity(const Trajectory& poses, Stamp stamp) {
  const auto before = poses.at(stamp + duration_of(-kHalfWindow));
  const auto after = poses.at(stamp + duration_of(kHalfWindow));
  if (!before || !after) return std::nullopt;
  return (after->translation() - before->translation()) / (2.0 * kHalfWindow);
}

/// The force that 90 % of the samples do not exceed [N], horizontal.
double large_force(std::span<const WrenchSample> wrench) {
  std::vector<double> sizes;
  for (const WrenchSample& sample : wrench) sizes.push_back(sample.force.head<2>().norm());
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(9 * sizes.size() / 10);
  std::nth_element(sizes.begin(), at, sizes.end());
  return *at;
}

void add_instants(const PushSeries& push, std::vector<PushInstant>& instants) {
  if (push.wrench_base.empty()) return;
  const double threshold = kPushing * large_force(push.wrench_base);
  for (const WrenchSample& sample : push.wrench_base) {
    if (sample.force.head<2>().norm() < threshold) continue;
    const auto object = push.T_world_object.at(sample.stamp);
    const auto v_object = velocity(push.T_world_object, sample.stamp);
    const auto v_tip = velocity(push.T_base_tip, sample.stamp);
    if (!object || !v_object || !v_tip || v_object->head<2>().norm() < kMinSpeed) continue;
    const double speed = v_tip->head<2>().norm();
    if (speed < kMinSpeed) continue;
    instants.push_back({&push.T_base_tip, sample.stamp, *object, v_tip->head<2>() / speed});
  }
}

class WorldFit {
 public:
  WorldFit(std::span<const PushSeries> pushes, const PushedSides& sides) : sides_(sides) {
    for (const PushSeries& push : pushes) add_instants(push, instants_);
  }

  [[nodiscard]] std::size_t samples() const { return instants_.size(); }

  WorldPlacement run() {
    Parameters x = first_guess();
    double scale = 0.02;  // [m] of the guess
    for (int i = 0; i < 40; ++i) {
      x += step(x, scale);
      scale = std::max(0.7 * scale, 1.5 * std::max(spread_of(gaps(x)), kMinNoise));
    }
    return placement(x, scale);
  }

 private:
  static Pose world_of(const Parameters& x) {
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(x[2], Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(x[0], x[1], 0.0));
  }
  static double spread_of(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return kStdOverMad * median(std::move(values));
  }

  /// Between the tip's surface and the object's side [m]; as far as the fit's scale where the tip's
  /// pose is not known at the delayed time.
  [[nodiscard]] std::vector<double> gaps(const Parameters& x) const {
    const Pose T_base_world = world_of(x);
    std::vector<double> gaps;
    gaps.reserve(instants_.size());
    for (const PushInstant& instant : instants_) {
      const auto tip = instant.T_base_tip->at(instant.stamp + duration_of(x[3]));
      if (!tip) {
        gaps.push_back(0.0);
        continue;
      }
      const Pose T_object_tip = (T_base_world * instant.T_world_object).inverse() * *tip;
      const Eigen::Vector2d p_object_tip = T_object_tip.translation().head<2>();
      gaps.push_back(signed_distance(sides_.outline_object, p_object_tip) - sides_.tip_radius);
    }
    return gaps;
  }

  /// The object's centre is ahead of the tip, half its width away: a turn and a shift in closed
  /// form [Umeyama 1991].
  [[nodiscard]] Parameters first_guess() const {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& corner : sides_.outline_object) centre += corner;
    centre /= static_cast<double>(sides_.outline_object.size());
    const double reach =
        sides_.tip_radius - signed_distance(sides_.outline_object, centre.head<2>());
    Eigen::Matrix2Xd in_world(2, instants_.size()), in_base(2, instants_.size());
    for (Eigen::Index i = 0; i < in_world.cols(); ++i) {
      const PushInstant& instant = instants_[static_cast<std::size_t>(i)];
      const Pose tip = instant.T_base_tip->at(instant.stamp).value_or(Pose());
      in_world.col(i) = (instant.T_world_object * centre).head<2>();
      in_base.col(i) = tip.translation().head<2>() + reach * instant.direction_base;
    }
    const Eigen::Vector2d mean_world = in_world.rowwise().mean();
    const Eigen::Vector2d mean_base = in_base.rowwise().mean();
    const Eigen::Matrix2d product =
        (in_base.colwise() - mean_base) * (in_world.colwise() - mean_world).transpose();
    const double turn = std::atan2(product(1, 0) - product(0, 1), product.trace());
    const Eigen::Vector2d shift = mean_base - Eigen::Rotation2Dd(turn) * mean_world;
    return {shift.x(), shift.y(), turn, 0.0};
  }

  struct Normal {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
  };
  /// Derivatives by differences; shift and turn about the middle of the samples' motion would not
  /// change the solution.
  [[nodiscard]] Normal normal_equations(const Parameters& x, double scale) const {
    const Parameters steps(1e-5, 1e-5, 1e-5, 1e-4);
    const std::vector<double> at = gaps(x);
    std::array<std::vector<double>, 4> moved;
    for (int k = 0; k < 4; ++k) {
      Parameters next = x;
      next[k] += steps[k];
      moved[static_cast<std::size_t>(k)] = gaps(next);
    }
    Normal normal;
    for (std::size_t i = 0; i < at.size(); ++i) {
      Eigen::Vector4d gradient;
      for (int k = 0; k < 4; ++k) {
        gradient[k] = (moved[static_cast<std::size_t>(k)][i] - at[i]) / steps[k];
      }
      const double weight = 1.0 / (1.0 + std::pow(at[i] / scale, 2));
      normal.matrix += weight * gradient * gradient.transpose();
      normal.right -= weight * at[i] * gradient;
    }
    const Parameters prior = (scale * prior_stds().cwiseInverse()).array().square();
    normal.matrix.diagonal() += prior;
    normal.right[3] -= prior[3] * x[3];  // the others' first guess is as good as any
    return normal;
  }
  [[nodiscard]] Parameters step(const Parameters& x, double scale) const {
    const Normal normal = normal_equations(x, scale);
    return normal.matrix.ldlt().solve(normal.right);
  }

  /// Gaps that follow each other are alike: by how much they count less than independent ones.
  static double repetition(const std::vector<double>& gaps, double scale) {
    double product = 0.0, square = 0.0;
    for (std::size_t i = 0; i + 1 < gaps.size(); ++i) {
      const double a = std::clamp(gaps[i], -scale, scale);
      product += a * std::clamp(gaps[i + 1], -scale, scale);
      square += a * a;
    }
    const double correlation = square > 0.0 ? std::clamp(product / square, 0.0, 0.99) : 0.0;
    return (1.0 + correlation) / (1.0 - correlation);
  }

  [[nodiscard]] WorldPlacement placement(const Parameters& x, double scale) const {
    const std::vector<double> gaps = this->gaps(x);
    WorldPlacement found{.T_base_world = world_of(x), .tool_delay = x[3]};
    found.samples = gaps.size();
    found.residual = spread_of(gaps);
    const double variance =
        std::pow(std::max(found.residual, kMinNoise), 2) * repetition(gaps, scale);
    const Eigen::Matrix4d covariance =
        variance * normal_equations(x, scale).matrix.ldlt().solve(Eigen::Matrix4d::Identity());
    const Eigen::Matrix2d place = covariance.topLeftCorner<2, 2>();
    found.position_std =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(place).eigenvalues().maxCoeff());
    found.turn_std = std::sqrt(covariance(2, 2));
    found.delay_std = std::sqrt(covariance(3, 3));
    found.T_base_world = Pose(found.T_base_world.rotation(), Eigen::Vector3d(x[0], x[1], height()));
    return found;
  }

  /// Of the world frame in base [m], median.
  [[nodiscard]] double height() const {
    std::vector<double> heights;
    for (const PushInstant& instant : instants_) {
      const auto tip = instant.T_base_tip->at(instant.stamp);
      const Eigen::Vector3d middle(0.0, 0.0, sides_.middle_object);
      if (tip) {
        heights.push_back(tip->translation().z() - (instant.T_world_object * middle).z());
      }
    }
    return median(std::move(heights));
  }

  const PushedSides& sides_;
  std::vector<PushInstant> instants_;
};

}  // namespace

PushedSides PushedSides::of(const TriangleMesh& mesh_object, double tip_radius) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& vertex : mesh_object.vertices)
    points.push_back(vertex.cast<double>());
  return {.outline_object = convex_hull_xy(std::move(points)),
          .middle_object = bounds(mesh_object.vertices).center().cast<double>().z(),
          .tip_radius = tip_radius};
}

Expected<WorldPlacement> find_world(std::span<const PushSeries> pushes, const PushedSides& sides) {
  PCAVR_REQUIRE(sides.outline_object.size() >= 3, sides.outline_object.size());
  PCAVR_REQUIRE(sides.tip_radius >= 0.0, sides.tip_radius);
  WorldFit fit(pushes, sides);
  const Error unfit{.message = {},
                    .place = "--find-world",
                    .hint =
                        "take a run that pushes the object and turns it by some 30 degrees, or "
                        "give --T-base-world"};
  const auto error = [&](std::string message) {
    Error found = unfit;
    found.message = std::move(message);
    return found;
  };
  if (fit.samples() < kMinSamples) {
    return error("tip and object move together with force in " + std::to_string(fit.samples()) +
                 " samples only");
  }
  const WorldPlacement found = fit.run();
  const auto millimetres = [](double length) {
    return std::to_string(static_cast<int>(std::lround(1e3 * length))) + " mm";
  };
  if (!(found.residual <= kMaxError)) {
    return error("the tip does not follow the object's sides: they are " +
                 millimetres(found.residual) + " apart");
  }
  if (!(found.position_std <= kMaxError)) {
    return error("the world's place in base is known to " + millimetres(found.position_std) +
                 " only");
  }
  return found;
}

}  // namespace pcavr
