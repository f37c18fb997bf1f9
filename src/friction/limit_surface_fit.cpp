// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/friction/limit_surface_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "pcavr/core/median.hpp"

#include "quartic.hpp"

namespace pcavr {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

constexpr int kDirections = 90;  // of linear forms; 60 to 200 give the same surfaces
constexpr int kReweightings = 25;
constexpr int kSweeps = 200;           // of coordinate descent, each from the last solution
constexpr double kLeastAngle = 0.02;   // [rad] below which a sample no longer gains weight
constexpr double kLeastSpread = 0.02;  // of the thinnest direction over the thickest, to be excited

/// Evenly over half a sphere, by the golden angle.
Vectors half_sphere() {
  Vectors directions;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections;
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return directions;
}

/// A wrench in units of the scales, the unit twist conjugate to it, and how much they count.
struct Target {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  double weight = 1.0;
};
using Targets = std::vector<Target>;

/// H(u) = sum of c_k (l_k . u)^degree, with all c_k >= 0: convex for an even degree.
class PowerSum {
 public:
  PowerSum(int degree, const Vectors& forms)
      : degree_(degree), forms_(forms), weights_(Eigen::VectorXd::Ones(std::ssize(forms))) {
    weights_ /= static_cast<double>(forms.size());
  }

  /// Gradient of H over the degree; its product with u is H.
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& u) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < forms_.size(); ++k) sum += weight(k) * column(u, k);
    return sum;
  }
  [[nodiscard]] double weight(std::size_t k) const { return weights_[static_cast<int>(k)]; }

  /// The weights that bring normals to twists and levels to 1 in least squares.
  void solve(const Targets& targets, double level_weight) {
    const int n = static_cast<int>(forms_.size());
    Eigen::Matrix<double, Eigen::Dynamic, 4> rows(n, 4);
    Eigen::MatrixXd normal_matrix = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (const Target& target : targets) {
      for (int k = 0; k < n; ++k) {
        const Eigen::Vector3d c = column(target.u, static_cast<std::size_t>(k));
        rows.row(k).head<3>() = c - target.twist * target.twist.dot(c);
        rows(k, 3) = std::sqrt(level_weight) * target.u.dot(c);
      }
      // The lower half of rows * rows^T: a general product of so few columns takes three times as
      // long, and this is done 17000 times for a surface.
      for (int k = 0; k < n; ++k) {
        const auto part = rows.bottomRows(n - k);
        normal_matrix.col(k).tail(n - k) +=
            target.weight * (part.col(0) * rows(k, 0) + part.col(1) * rows(k, 1) +
                             part.col(2) * rows(k, 2) + part.col(3) * rows(k, 3));
      }
      right += target.weight * std::sqrt(level_weight) * rows.col(3);
    }
    normal_matrix.triangularView<Eigen::StrictlyUpper>() = normal_matrix.transpose();
    descend(normal_matrix, right);
  }

 private:
  [[nodiscard]] Eigen::Vector3d column(const Eigen::Vector3d& u, std::size_t k) const {
    const double product = forms_[k].dot(u);
    return (degree_ == 2 ? product : product * product * product) * forms_[k];
  }

  /// Non-negative least squares by coordinate descent; the cost never grows.
  void descend(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
    Eigen::VectorXd gradient = matrix * weights_ - right;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Eigen::Index k = 0; k < weights_.size(); ++k) {
        if (!(matrix(k, k) > 0.0)) continue;
        const double next = std::max(0.0, weights_[k] - gradient[k] / matrix(k, k));
        const double change = next - weights_[k];
        if (change == 0.0) continue;
        weights_[k] = next;
        gradient += change * matrix.col(k);
      }
    }
  }

  int degree_;
  const Vectors& forms_;
  Eigen::VectorXd weights_;
};

/// Least absolute angles, by least squares with weights from the last round.
void fit(const Targets& pushes, const Targets& prior, double level_weight, PowerSum& surface) {
  Targets targets;
  for (int round = 0; round < kReweightings; ++round) {
    targets = pushes;
    for (Target& target : targets) {
      const Eigen::Vector3d normal = surface.normal(target.u);
      const double angle = std::atan2(normal.cross(target.twist).norm(), normal.dot(target.twist));
      target.weight = kLeastAngle / std::max(angle, kLeastAngle) / normal.squaredNorm();
    }
    targets.insert(targets.end(), prior.begin(), prior.end());
    surface.solve(targets, level_weight);
  }
}

Targets scaled(std::span<const PushSample> samples, double force, double length) {
  Targets targets;
  const Eigen::Vector3d scale(force, force, force * length);
  for (const PushSample& sample : samples) {
    targets.push_back(
        {sample.wrench.cwiseQuotient(scale), sample.twist.cwiseProduct(scale).normalized(), 1.0});
  }
  return targets;
}

/// The same number of wrenches and twists over the whole of an ellipsoid.
Targets targets_on(const Eigen::Matrix3d& a, double total_weight, const Vectors& directions) {
  Targets targets;
  for (const Eigen::Vector3d& direction : directions) {
    Target target;
    target.u = direction / std::sqrt(direction.dot(a * direction));
    target.twist = (a * target.u).normalized();
    target.weight = total_weight / static_cast<double>(directions.size());
    targets.push_back(target);
  }
  return targets;
}

Eigen::Matrix3d fit_ellipsoid(const Targets& pushes, double level_weight, const Vectors& forms) {
  PowerSum sum(2, forms);
  fit(pushes, {}, level_weight, sum);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < forms.size(); ++k) {
    a += sum.weight(k) * forms[k] * forms[k].transpose();
  }
  return a;
}

LimitSurface fit_quartic(const Targets& pushes, const Eigen::Matrix3d& ellipsoid,
                         const LimitSurfaceFitOptions& options, const Vectors& forms, double force,
                         double length) {
  const double prior_weight = options.prior_weight * static_cast<double>(pushes.size());
  PowerSum sum(4, forms);
  fit(pushes, targets_on(ellipsoid, prior_weight, forms), options.level_weight, sum);
  LimitSurface surface{force, length, {}};
  for (std::size_t k = 0; k < forms.size(); ++k) {
    const auto power = detail::fourth_power_of(forms[k]);
    for (std::size_t i = 0; i < power.size(); ++i) {
      surface.coefficients[i] += sum.weight(k) * power[i];
    }
  }
  return surface;
}

bool is_usable(const PushSample& sample) {
  return sample.wrench.allFinite() && sample.twist.allFinite() && sample.wrench.norm() > 0.0 &&
         sample.twist.norm() > 0.0;
}

/// Whether the vectors span space rather than a plane.
bool spans_space(const Targets& targets, Eigen::Vector3d Target::*member) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Target& target : targets) {
    spread += (target.*member).normalized() * (target.*member).normalized().transpose();
  }
  const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(spread).singularValues();
  return singular[2] > kLeastSpread * kLeastSpread * singular[0];
}

double median_angle(std::span<const PushSample> samples, const LimitSurface& surface) {
  std::vector<double> angles;
  for (const PushSample& sample : samples) {
    angles.push_back(
        twist_angle(sliding_direction(surface, sample.wrench), sample.twist, surface.length));
  }
  return median(std::move(angles));
}

/// 1 where half the wrenches lie inside: least squares would follow the few large ones.
double median_level(std::span<const PushSample> samples, const LimitSurface& surface) {
  std::vector<double> levels;
  for (const PushSample& sample : samples) levels.push_back(level(surface, sample.wrench));
  return median(std::move(levels));
}

double median_of(std::span<const PushSample> samples, double (*measure)(const PushSample&)) {
  std::vector<double> values;
  for (const PushSample& sample : samples) values.push_back(measure(sample));
  return median(std::move(values));
}

}  // namespace

LimitSurfaceFit fit_limit_surface(std::span<const PushSample> all,
                                  const LimitSurfaceFitOptions& options) {
  LimitSurfaceFit result;
  std::vector<PushSample> samples;
  std::copy_if(all.begin(), all.end(), std::back_inserter(samples), is_usable);
  result.samples_used = static_cast<int>(samples.size());
  const int least = options.shape == SurfaceShape::ellipsoid ? 6 : 15;
  if (result.samples_used < least) return result;

  const double force =
      median_of(samples, [](const PushSample& s) { return s.wrench.head<2>().norm(); });
  double length =
      median_of(samples, [](const PushSample& s) { return std::abs(s.wrench.z()); }) / force;
  result.status = LimitSurfaceFitStatus::not_excited;
  if (!(force > 0.0) || !(length > 0.0)) return result;
  const Vectors forms = half_sphere();
  Targets pushes = scaled(samples, force, length);
  if (!spans_space(pushes, &Target::u) || !spans_space(pushes, &Target::twist)) return result;

  // Once to learn the length that makes the surface nearly round, once in that scale.
  Eigen::Matrix3d ellipsoid = fit_ellipsoid(pushes, options.level_weight, forms);
  length *= std::sqrt((ellipsoid(0, 0) + ellipsoid(1, 1)) / (2.0 * ellipsoid(2, 2)));
  pushes = scaled(samples, force, length);
  ellipsoid = fit_ellipsoid(pushes, options.level_weight, forms);
  result.surface = options.shape == SurfaceShape::ellipsoid
                       ? quadratic_surface(force, length, ellipsoid)
                       : fit_quartic(pushes, ellipsoid, options, forms, force, length);
  result.surface.force *= median_level(samples, result.surface);
  result.status = LimitSurfaceFitStatus::fitted;
  result.median_angle = median_angle(samples, result.surface);
  return result;
}

}  // namespace pcavr
