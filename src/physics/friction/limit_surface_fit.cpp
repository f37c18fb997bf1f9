// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/friction/limit_surface_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "pcavr/base/core/median.hpp"
#include "pcavr/base/core/solvers.hpp"

#include "ternary_form.hpp"

namespace pcavr {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

constexpr int kDirections = 90;    // of linear forms; 60 to 200 give the same surfaces
constexpr int kReweightings = 25;  // bounds the time: each is a weighted solution
constexpr int kSweeps = 200;       // of coordinate descent, each from the last solution

/// Evenly over half a sphere, by the golden angle (Fibonacci lattice).
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

/// A wrench in units of the scales, the unit twist conjugate to it, and their weight.
struct Target {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  Eigen::Vector3d twist = Eigen::Vector3d::Zero();
  double weight = 1.0;
};
using Targets = std::vector<Target>;

/// H(u) = sum of c_k (l_k . u)^Degree, with all c_k >= 0: convex for an even degree.
template <int Degree>
class PowerSum {
 public:
  using Form = detail::TernaryForm<Degree>;

  explicit PowerSum(const Vectors& forms)
      : powers_(Form::kTerms, std::ssize(forms)),
        weights_(
            Eigen::VectorXd::Constant(std::ssize(forms), 1.0 / static_cast<double>(forms.size()))) {
    for (std::size_t k = 0; k < forms.size(); ++k) {
      powers_.col(static_cast<Eigen::Index>(k)) = Form::power_of(forms[k]);
    }
  }

  [[nodiscard]] typename Form::Coefficients coefficients() const { return powers_ * weights_; }

  /// The weights that fit normals to twists and levels to 1 in least squares. The cost is a
  /// quadratic in the form's few coefficients, whatever the number of its linear forms.
  void solve(const Targets& targets, double level_weight) {
    constexpr int kTerms = Form::kTerms;
    Eigen::Matrix<double, kTerms, kTerms> normal_matrix =
        Eigen::Matrix<double, kTerms, kTerms>::Zero();
    typename Form::Coefficients right = Form::Coefficients::Zero();
    for (const Target& target : targets) {
      const Eigen::Matrix<double, 3, kTerms> normal = Form::gradient(target.u);
      Eigen::Matrix<double, 4, kTerms> rows;
      rows.template topRows<3>() = normal - target.twist * (target.twist.transpose() * normal);
      rows.row(3) = std::sqrt(level_weight) * target.u.transpose() * normal;
      normal_matrix.noalias() += target.weight * rows.transpose() * rows;
      right += target.weight * std::sqrt(level_weight) * rows.row(3).transpose();
    }
    descend(normal_matrix, right);
  }

 private:
  using Powers = Eigen::Matrix<double, Form::kTerms, Eigen::Dynamic>;

  /// Non-negative least squares (NNLS) by coordinate descent; the cost never grows.
  void descend(const Eigen::Matrix<double, Form::kTerms, Form::kTerms>& matrix,
               const typename Form::Coefficients& right) {
    const Powers slopes = matrix * powers_;
    const Eigen::VectorXd curvatures = powers_.cwiseProduct(slopes).colwise().sum();
    typename Form::Coefficients gradient = matrix * coefficients() - right;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Eigen::Index k = 0; k < weights_.size(); ++k) {
        if (!(curvatures[k] > 0.0)) continue;
        const double slope = powers_.col(k).dot(gradient);
        const double next = std::max(0.0, weights_[k] - slope / curvatures[k]);
        const double change = next - weights_[k];
        if (change == 0.0) continue;
        weights_[k] = next;
        gradient += change * slopes.col(k);
      }
    }
  }

  Powers powers_;  // of each linear form
  Eigen::VectorXd weights_;
};

/// The coefficients of least absolute angles, by iteratively reweighted least squares (IRLS).
template <int Degree>
typename detail::TernaryForm<Degree>::Coefficients fit(const Targets& pushes, const Targets& prior,
                                                       const LimitSurfaceFitOptions& options,
                                                       const Vectors& forms) {
  PowerSum<Degree> surface(forms);
  Targets targets;
  for (int iteration = 0; iteration < kReweightings; ++iteration) {
    targets = pushes;
    const typename detail::TernaryForm<Degree>::Coefficients coefficients = surface.coefficients();
    for (Target& target : targets) {
      const Eigen::Vector3d normal = detail::TernaryForm<Degree>::gradient(target.u) * coefficients;
      const double angle = std::atan2(normal.cross(target.twist).norm(), normal.dot(target.twist));
      target.weight = options.min_angle / std::max(angle, options.min_angle) / normal.squaredNorm();
    }
    targets.insert(targets.end(), prior.begin(), prior.end());
    surface.solve(targets, options.level_weight);
  }
  return surface.coefficients();
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

/// Samples of wrench and twist over a whole surface, in units of the scales: the prior of the
/// quartic.
Targets targets_on(const LimitSurface& prior, double total_weight, const Vectors& directions,
                   double force, double length) {
  Targets targets;
  const Eigen::Vector3d scale(force, force, force * length);
  for (const Eigen::Vector3d& direction : directions) {
    const Eigen::Vector3d wrench = direction.cwiseProduct(scale);
    Target target;
    target.u = direction / level(prior, wrench);
    target.twist = sliding_direction(prior, wrench).cwiseProduct(scale).normalized();
    target.weight = total_weight / static_cast<double>(directions.size());
    targets.push_back(target);
  }
  return targets;
}

Eigen::Matrix3d fit_ellipsoid(const Targets& pushes, const LimitSurfaceFitOptions& options,
                              const Vectors& forms) {
  // xx, xy, xz, yy, yz, zz
  const Eigen::Matrix<double, 6, 1> c = fit<2>(pushes, {}, options, forms);
  Eigen::Matrix3d a;
  a << c[0], c[1] / 2.0, c[2] / 2.0, c[1] / 2.0, c[3], c[4] / 2.0, c[2] / 2.0, c[4] / 2.0, c[5];
  return a;
}

LimitSurface fit_quartic(const Targets& pushes, const LimitSurface& prior, double weight,
                         const LimitSurfaceFitOptions& options, const Vectors& forms, double force,
                         double length) {
  const double prior_weight = weight * static_cast<double>(pushes.size());
  const auto coefficients =
      fit<4>(pushes, targets_on(prior, prior_weight, forms, force, length), options, forms);
  LimitSurface surface{force, length, {}};
  std::copy(coefficients.begin(), coefficients.end(), surface.coefficients.begin());
  return surface;
}

bool is_usable(const PushSample& sample) {
  return sample.wrench.allFinite() && sample.twist.allFinite() && sample.wrench.norm() > 0.0 &&
         sample.twist.norm() > 0.0;
}

/// Whether the vectors span space rather than a plane (full rank).
bool spans_space(const Targets& targets, Eigen::Vector3d Target::*member, double min_spread) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Target& target : targets) {
    spread += (target.*member).normalized() * (target.*member).normalized().transpose();
  }
  const Eigen::Vector3d singular = Eigen::JacobiSVD<Eigen::Matrix3d>(spread).singularValues();
  return singular[2] > min_spread * min_spread * singular[0];
}

double median_angle(std::span<const PushSample> samples, const LimitSurface& surface) {
  std::vector<double> angles;
  for (const PushSample& sample : samples) {
    angles.push_back(
        twist_angle(sliding_direction(surface, sample.wrench), sample.twist, surface.length));
  }
  return median(std::move(angles));
}

/// 1 where half the wrenches lie inside: a mean would follow the few large ones.
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
                                  const LimitSurfaceFitOptions& options,
                                  const std::optional<LimitSurface>& given) {
  LimitSurfaceFit result;
  std::vector<PushSample> samples;
  std::copy_if(all.begin(), all.end(), std::back_inserter(samples), is_usable);
  result.samples_used = static_cast<int>(samples.size());
  const int min_pushes = options.shape == SurfaceShape::ellipsoid ? 6 : 15;
  if (result.samples_used < min_pushes) return result;

  const double force =
      median_of(samples, [](const PushSample& s) { return s.wrench.head<2>().norm(); });
  double length =
      median_of(samples, [](const PushSample& s) { return std::abs(s.wrench.z()); }) / force;
  result.status = LimitSurfaceFitStatus::not_excited;
  if (!(force > 0.0) || !(length > 0.0)) return result;
  const Vectors forms = half_sphere();
  Targets pushes = scaled(samples, force, length);
  if (!spans_space(pushes, &Target::u, options.min_spread) ||
      !spans_space(pushes, &Target::twist, options.min_spread)) {
    return result;
  }

  // First to find the length that makes the surface nearly round, then in that scale.
  Eigen::Matrix3d ellipsoid = fit_ellipsoid(pushes, options, forms);
  length *= std::sqrt((ellipsoid(0, 0) + ellipsoid(1, 1)) / (2.0 * ellipsoid(2, 2)));
  pushes = scaled(samples, force, length);
  ellipsoid = fit_ellipsoid(pushes, options, forms);
  const LimitSurface own = quadratic_surface(force, length, ellipsoid);
  if (options.shape == SurfaceShape::ellipsoid) {
    result.surface = own;
  } else if (given) {
    LimitSurface prior = *given;
    prior.force *= median_level(samples, prior);
    result.surface =
        fit_quartic(pushes, prior, options.given_prior_weight, options, forms, force, length);
  } else {
    result.surface = fit_quartic(pushes, own, options.prior_weight, options, forms, force, length);
  }
  result.surface.force *= median_level(samples, result.surface);
  result.status = LimitSurfaceFitStatus::fitted;
  result.median_angle = median_angle(samples, result.surface);
  return result;
}

}  // namespace pcavr
