// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/world_placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/convex_hull.hpp"

namespace pcavr {
namespace {

constexpr double kPushing = 0.5;      // of the large forces: less may be the tool in the air
constexpr double kMinSpeed = 0.002;   // [m/s] of the object: slower it may be at rest
constexpr double kHalfWindow = 0.03;  // [s] for speeds: some samples of any tracker
constexpr std::size_t kMinSamples = 20;
constexpr double kMinNoise = 5e-5;   // [m] of robots and motion capture together
constexpr double kMaxError = 0.005;  // [m] of place and gap: a finger is not thicker

/// [s] By a compression that does not follow the assumed law of the force.
constexpr double kDelayBias = 0.005;
constexpr double kMinDelayStds = 3.0;  // of a delay that is taken off
constexpr double kNoDelay = 1e-6;      // [s] std
constexpr int kIterations = 40;
constexpr std::size_t kMaxSamplesOfStarts = 400;
/// Difference of -2 log likelihood to the best fit: others within it are possible, too [4 std].
constexpr double kPossible = 16.0;
/// Cosine of the force to the touched side's normal: friction of a tip turns it by less.
constexpr double kIntoSide = 0.7;

using Parameters = Eigen::Vector<double, 5>;  // x, y [m], turn [rad], delay [s], compression [m]
constexpr int kCount = Parameters::SizeAtCompileTime;

/// Stds before the fit: of a place in a room, any turn, the delay of loggers and networks, and the
/// length by which soft bodies and tips give way.
Parameters prior_stds() { return Parameters(1.0, 1.0, 3.0, 0.05, 0.005); }

/// Exponent of the compression over the force, for contacts of spheres [Hertz 1881]: between that
/// of a spring and that of a flat contact.
constexpr double kCompressionExponent = 2.0 / 3.0;

Duration duration_of(double seconds) {
  return Duration{static_cast<std::int64_t>(std::llround(1e9 * seconds))};
}

/// The side of a convex polygon that a point is at: its outward normal, and the distance, positive
/// outside.
struct NearSide {
  double distance = 0.0;  ///< [m] to the polygon's nearest point
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();
};

NearSide near_side(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector2d& point) {
  double inside = -std::numeric_limits<double>::infinity();
  double outside = std::numeric_limits<double>::infinity();
  NearSide near;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d a = outline[i].head<2>();
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()].head<2>() - a;
    const Eigen::Vector2d normal = Eigen::Vector2d(edge.y(), -edge.x()).normalized();
    if (normal.dot(point - a) > inside) {
      inside = normal.dot(point - a);
      near.normal = normal;
    }
    const double along = std::clamp(edge.dot(point - a) / edge.squaredNorm(), 0.0, 1.0);
    outside = std::min(outside, (point - a - along * edge).norm());
  }
  near.distance = inside > 0.0 ? outside : inside;
  return near;
}

/// An instant at which the tip pushes the object.
struct PushInstant {
  const Trajectory* T_base_tip;  ///< never null
  Stamp stamp;
  Pose T_world_object;
  Eigen::Vector2d direction_base;  ///< of the tip's motion, unit length
  Eigen::Vector2d force_base;      ///< its direction, unit length
  double compression;              ///< of that by the large force
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
    instants.push_back(
        {&push.T_base_tip, sample.stamp, *object, v_tip->head<2>() / speed,
         sample.force.head<2>().normalized(),
         std::pow(kPushing * sample.force.head<2>().norm() / threshold, kCompressionExponent)});
  }
}

/// Gauss-Newton with Cauchy weights from many starts: where along a side the tip touches is seen
/// only as the object turns, so that a fit may end far off, at a place that fits as well.
class WorldFit {
 public:
  WorldFit(std::span<const PushSeries> pushes, const PushedSides& sides) : sides_(sides) {
    for (const PushSeries& push : pushes) add_instants(push, all_);
    const std::size_t stride = 1 + all_.size() / kMaxSamplesOfStarts;
    for (std::size_t i = 0; i < all_.size(); i += stride) some_.push_back(all_[i]);
  }

  [[nodiscard]] std::size_t samples() const { return all_.size(); }

  WorldPlacement run() {
    instants_ = &some_;
    std::vector<Parameters> fits;
    for (const Parameters& start : starts()) fits.push_back(converged(start));
    const Eigen::Vector2d across = across_pushes();
    for (const Parameters& start : starts_along(across)) fits.push_back(converged(start, across));
    double scale = std::numeric_limits<double>::infinity();
    for (const Parameters& fit : fits) scale = std::min(scale, scale_of(fit));
    const auto best = std::min_element(fits.begin(), fits.end(),
                                       [&](const Parameters& one, const Parameters& other) {
                                         return cost_of(one, scale) < cost_of(other, scale);
                                       });
    const double most = cost_of(*best, scale) + kPossible * repetition(residuals(*best), scale);
    double apart = 0.0;
    for (const Parameters& fit : fits) {
      if (cost_of(fit, scale) > most) continue;
      apart = std::max(apart, (fit.head<2>() - best->head<2>()).norm());
    }
    instants_ = &all_;
    Parameters x = converged(*best);
    WorldPlacement found = placement(x, scale_of(x));
    if (std::abs(x[3]) < kMinDelayStds * found.delay_std) {
      prior_stds_[3] = kNoDelay;
      x[3] = 0.0;
      x = converged(x);
      const double delay_std = found.delay_std;
      found = placement(x, scale_of(x));
      found.tool_delay = 0.0;
      found.delay_std = delay_std;
    }
    found.position_std = std::hypot(found.position_std, 0.5 * apart);
    return found;
  }

 private:
  /// [m] Half the distance over which the sides extend from one corner.
  [[nodiscard]] double reach() const {
    double reach = 0.0;
    for (const Eigen::Vector3d& corner : sides_.outline_object) {
      reach = std::max(reach, 0.5 * (corner - sides_.outline_object.front()).head<2>().norm());
    }
    return reach;
  }

  /// The first guess, and places from which other parts of the sides would be touched.
  [[nodiscard]] std::vector<Parameters> starts() const {
    constexpr int kSteps = 3;  // to either side
    const Parameters first = first_guess();
    std::vector<Parameters> starts;
    for (int i = -kSteps; i <= kSteps; ++i) {
      for (int j = -kSteps; j <= kSteps; ++j) {
        Parameters start = first;
        start.head<2>() += reach() / kSteps * Eigen::Vector2d(i, j);
        starts.push_back(start);
      }
    }
    return starts;
  }

  /// Starts along `direction` only, more densely.
  [[nodiscard]] std::vector<Parameters> starts_along(const Eigen::Vector2d& direction) const {
    constexpr int kSteps = 10;  // to either side
    std::vector<Parameters> starts;
    for (int i = -kSteps; i <= kSteps; ++i) {
      Parameters start = first_guess();
      start.head<2>() += reach() * i / kSteps * direction;
      starts.push_back(start);
    }
    return starts;
  }

  /// The direction in base in which the pushes go the least: along the sides that they touch.
  [[nodiscard]] Eigen::Vector2d across_pushes() const {
    Eigen::Matrix2d pushed = Eigen::Matrix2d::Zero();
    for (const PushInstant& instant : *instants_) {
      pushed += instant.direction_base * instant.direction_base.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(pushed).eigenvectors().col(0);
  }

  /// The place does not move along `held`, a unit vector, or zero.
  [[nodiscard]] Parameters converged(Parameters x, const Eigen::Vector2d& held = {0.0, 0.0}) const {
    double scale = 0.02;  // [m] of the guess
    for (int i = 0; i < kIterations; ++i) {
      x += step(x, scale, held);
      scale = std::max(0.7 * scale, scale_of(x));
    }
    return x;
  }

  [[nodiscard]] double scale_of(const Parameters& x) const {
    return 1.5 * std::max(spread_of(residuals(x)), kMinNoise);
  }

  /// -2 log likelihood, for independent gaps; a force out of the touched side contradicts as a gap
  /// of three stds.
  [[nodiscard]] double cost_of(const Parameters& x, double scale) const {
    const Pose T_base_world = world_of(x);
    double cost = (x.array() / prior_stds_.array()).tail<2>().square().sum();
    for (const PushInstant& instant : *instants_) {
      const auto tip = instant.T_base_tip->at(instant.stamp + duration_of(x[3]));
      if (!tip) continue;
      const Pose T_base_object = T_base_world * instant.T_world_object;
      const Pose T_object_tip = T_base_object.inverse() * *tip;
      const NearSide side = near_side(sides_.outline_object, T_object_tip.translation().head<2>());
      const double gap = side.distance - sides_.tip_radius + instant.compression * x[4];
      cost += std::log1p(std::pow(gap / scale, 2));
      const Eigen::Vector3d inward_base =
          T_base_object.rotation() * Eigen::Vector3d(-side.normal.x(), -side.normal.y(), 0.0);
      if (inward_base.head<2>().dot(instant.force_base) < kIntoSide) cost += std::log1p(9.0);
    }
    return cost;
  }

  static Pose world_of(const Parameters& x) {
    return Pose(Eigen::Quaterniond(Eigen::AngleAxisd(x[2], Eigen::Vector3d::UnitZ())),
                Eigen::Vector3d(x[0], x[1], 0.0));
  }
  static double spread_of(std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return kStdOverMad * median(std::move(values));
  }

  /// Gaps between the tip's surface and the object's side, less the compression [m]; zero where the
  /// tip's pose is not known at the delayed time.
  [[nodiscard]] std::vector<double> residuals(const Parameters& x) const {
    const Pose T_base_world = world_of(x);
    std::vector<double> gaps;
    gaps.reserve(instants_->size());
    for (const PushInstant& instant : *instants_) {
      const auto tip = instant.T_base_tip->at(instant.stamp + duration_of(x[3]));
      if (!tip) {
        gaps.push_back(0.0);
        continue;
      }
      const Pose T_object_tip = (T_base_world * instant.T_world_object).inverse() * *tip;
      const Eigen::Vector2d p_object_tip = T_object_tip.translation().head<2>();
      gaps.push_back(near_side(sides_.outline_object, p_object_tip).distance - sides_.tip_radius +
                     instant.compression * x[4]);
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
        sides_.tip_radius - near_side(sides_.outline_object, centre.head<2>()).distance;
    Eigen::Matrix2Xd in_world(2, instants_->size()), in_base(2, instants_->size());
    for (Eigen::Index i = 0; i < in_world.cols(); ++i) {
      const PushInstant& instant = (*instants_)[static_cast<std::size_t>(i)];
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
    return Parameters(shift.x(), shift.y(), turn, 0.0, 0.0);
  }

  struct Normal {
    Eigen::Matrix<double, kCount, kCount> matrix = Eigen::Matrix<double, kCount, kCount>::Zero();
    Parameters right = Parameters::Zero();
  };
  /// Derivatives by differences; shift and turn about the middle of the samples' motion would not
  /// change the solution. The priors count as much as samples of the std `of_prior` [m].
  [[nodiscard]] Normal normal_equations(const Parameters& x, double scale, double of_prior) const {
    const Parameters steps(1e-5, 1e-5, 1e-5, 1e-4, 1e-5);
    const std::vector<double> at = residuals(x);
    std::array<std::vector<double>, kCount> moved;
    for (int k = 0; k < kCount; ++k) {
      Parameters next = x;
      next[k] += steps[k];
      moved[static_cast<std::size_t>(k)] = residuals(next);
    }
    Normal normal;
    for (std::size_t i = 0; i < at.size(); ++i) {
      Parameters gradient;
      for (int k = 0; k < kCount; ++k) {
        gradient[k] = (moved[static_cast<std::size_t>(k)][i] - at[i]) / steps[k];
      }
      const double weight = 1.0 / (1.0 + std::pow(at[i] / scale, 2));
      normal.matrix += weight * gradient * gradient.transpose();
      normal.right -= weight * at[i] * gradient;
    }
    const Parameters prior = (of_prior * prior_stds_.cwiseInverse()).array().square();
    normal.matrix.diagonal() += prior;
    // The first guess of place and turn is as good as any.
    normal.right.tail<2>() -= prior.tail<2>().cwiseProduct(x.tail<2>());
    return normal;
  }
  [[nodiscard]] Parameters step(const Parameters& x, double scale,
                                const Eigen::Vector2d& held) const {
    constexpr double kHeld = 1e6;  // times all samples
    Normal normal = normal_equations(x, scale, scale);
    const auto count = static_cast<double>(instants_->size());
    normal.matrix.topLeftCorner<2, 2>() += kHeld * count * held * held.transpose();
    return normal.matrix.ldlt().solve(normal.right);
  }

  /// Gaps that follow each other are alike: by how much they count less than independent ones. What
  /// is below the noise of any tracker says nothing of it.
  static double repetition(const std::vector<double>& gaps, double scale) {
    double product = 0.0, square = 0.0;
    for (std::size_t i = 0; i + 1 < gaps.size(); ++i) {
      square += kMinNoise * kMinNoise;
      const double a = std::clamp(gaps[i], -scale, scale);
      product += a * std::clamp(gaps[i + 1], -scale, scale);
      square += a * a;
    }
    const double correlation = square > 0.0 ? std::clamp(product / square, 0.0, 0.99) : 0.0;
    return (1.0 + correlation) / (1.0 - correlation);
  }

  [[nodiscard]] WorldPlacement placement(const Parameters& x, double scale) const {
    const std::vector<double> gaps = residuals(x);
    WorldPlacement found{.T_base_world = world_of(x), .tool_delay = x[3]};
    found.samples = gaps.size();
    found.residual = spread_of(gaps);
    const double variance =
        std::pow(std::max(found.residual, kMinNoise), 2) * repetition(gaps, scale);
    const Eigen::Matrix<double, kCount, kCount> covariance =
        variance * normal_equations(x, scale, std::sqrt(variance)).matrix.inverse();
    const Eigen::Matrix2d place = covariance.topLeftCorner<2, 2>();
    found.position_std =
        std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(place).eigenvalues().maxCoeff());
    found.turn_std = std::sqrt(covariance(2, 2));
    found.delay_std = std::hypot(std::sqrt(covariance(3, 3)), kDelayBias);
    found.T_base_world = Pose(found.T_base_world.rotation(), Eigen::Vector3d(x[0], x[1], height()));
    return found;
  }

  /// Height of the world frame in base, median [m].
  [[nodiscard]] double height() const {
    std::vector<double> heights;
    for (const PushInstant& instant : *instants_) {
      const auto tip = instant.T_base_tip->at(instant.stamp);
      const Eigen::Vector3d middle(0.0, 0.0, sides_.middle_object);
      if (tip) {
        heights.push_back(tip->translation().z() - (instant.T_world_object * middle).z());
      }
    }
    return median(std::move(heights));
  }

  const PushedSides& sides_;
  Parameters prior_stds_ = prior_stds();
  std::vector<PushInstant> all_, some_;
  const std::vector<PushInstant>* instants_ = &all_;  ///< those in use
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
