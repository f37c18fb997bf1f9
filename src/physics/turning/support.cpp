// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/turning/support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "pcavr/base/core/solvers.hpp"
#include "pcavr/base/geometry/convex_hull.hpp"
#include "pcavr/physics/friction/point_push.hpp"
#include "pcavr/physics/friction/standing.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

namespace pcavr {
namespace {

constexpr double kContactHeight = 2e-3;  // [m] vertices so close to the lowest are on the support
constexpr int kCells = 12;               // across the support
/// Largest shift of the pressure's centre, as a share of the way from the centre of mass to the
/// support's edge: beyond, a stiff body stands on a line.
constexpr double kMaxShift = 0.8;
constexpr int kMaxLiftOffs = 20;  // rounds until the loaded points are found; two or three suffice
/// Scales of the support: a single foot near the centre, and two thirds beyond its rim.
constexpr double kMinScale = 0.2, kMaxScale = 1.7;
constexpr int kScales = 16;      // geometric, between those
constexpr int kNarrowings = 14;  // golden sections of one step: to a thousandth

bool contains(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector2d& p) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Eigen::Vector2d from = outline[k].head<2>();
    const Eigen::Vector2d edge = outline[(k + 1) % outline.size()].head<2>() - from;
    const Eigen::Vector2d offset = p - from;
    if (edge.x() * offset.y() - edge.y() * offset.x() < 0.0) return false;
  }
  return true;
}

/// The loads that move the support with a sample's twist.
struct SupportLoad {
  Eigen::Vector3d coulomb = Eigen::Vector3d::Zero();  ///< over the Coulomb friction
  Eigen::Vector3d viscous = Eigen::Vector3d::Zero();  ///< over B
};

SupportLoad load_of(const Support& support, const PushSample& sample) {
  SupportLoad load;
  const std::vector<double> shares = support.pressure(sample.centre_of_pressure);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const Eigen::Vector2d arm = support.points()[i] - sample.centre_of_pressure;
    const Eigen::Vector2d velocity = velocity_of(arm, sample.twist);
    load.coulomb += wrench_of(shares[i] * velocity.normalized(), arm);
    load.viscous += wrench_of(shares[i] * velocity, arm);
  }
  return load;
}

/// Mean angle between the samples' loads and those of the support under their twists [rad], with
/// moments over `length` [m].
double mean_angle(std::span<const PushSample> samples, const Support& support, double length,
                  double viscous) {
  double sum = 0.0;
  for (const PushSample& sample : samples) {
    const SupportLoad load = load_of(support, sample);
    sum += twist_angle(load.coulomb, sample.wrench - viscous * load.viscous, 1.0 / length);
  }
  return sum / static_cast<double>(samples.size());
}

}  // namespace

Support::Support(const CadModel& model, const Pose& T_base_object) {
  const Eigen::AngleAxisd back(-heading_of(T_base_object), Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d centre = T_base_object * model.centre_of_mass_object;
  const double highest = support_height(model, T_base_object) + kContactHeight;
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector3f& vertex : model.mesh_object.vertices) {
    const Eigen::Vector3d p = T_base_object * vertex.cast<double>();
    if (p.z() <= highest) corners.push_back(back * (p - centre));
  }
  const std::vector<Eigen::Vector3d> outline = convex_hull_xy(std::move(corners));
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3d& corner : outline) box.extend(corner.head<2>());
  for (int i = 0; i < kCells; ++i) {
    for (int k = 0; k < kCells; ++k) {
      const Eigen::Vector2d share((i + 0.5) / kCells, (k + 0.5) / kCells);
      const Eigen::Vector2d p = box.min() + share.cwiseProduct(box.sizes());
      if (contains(outline, p)) points_.push_back(p);
    }
  }
  if (points_.empty()) points_.push_back(Eigen::Vector2d::Zero());
}

double Support::radius() const {
  double sum = 0.0;
  for (const Eigen::Vector2d& p : points_) sum += p.norm();
  return sum / static_cast<double>(points_.size());
}

Support Support::scaled(double factor) const {
  Support result = *this;
  for (Eigen::Vector2d& p : result.points_) p *= factor;
  return result;
}

std::vector<double> Support::pressure(const Eigen::Vector2d& centre) const {
  const std::vector<double> even(points_.size(), 1.0 / static_cast<double>(points_.size()));
  if (centre.norm() < 1e-6) return even;
  std::vector<double> shares = even;
  double edge = 0.0;
  for (const Eigen::Vector2d& p : points_) edge = std::max(edge, p.dot(centre.normalized()));
  const Eigen::Vector2d borne = std::min(1.0, kMaxShift * edge / centre.norm()) * centre;
  for (int round = 0; round < kMaxLiftOffs; ++round) {
    Eigen::Matrix3d sums = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (shares[i] <= 0.0) continue;
      const Eigen::Vector3d row(1.0, points_[i].x(), points_[i].y());
      sums += row * row.transpose();
    }
    const Eigen::Vector3d plane = sums.ldlt().solve(Eigen::Vector3d(1.0, borne.x(), borne.y()));
    bool is_same = true;
    double total = 0.0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double share = std::max(0.0, plane.x() + plane.tail<2>().dot(points_[i]));
      is_same = is_same && (share > 0.0) == (shares[i] > 0.0);
      total += shares[i] = share;
    }
    // The body stands on a point or a line, which bears no moment.
    if (!(total > 0.0) || !std::isfinite(total)) return even;
    for (double& share : shares) share /= total;
    if (is_same) break;
  }
  return shares;
}

Eigen::Vector3d viscous_load(const Support& support, const PushSample& sample, double viscous) {
  return viscous * load_of(support, sample).viscous;
}

std::optional<Support> scaled_to_pushes(const Support& support, std::span<const PushSample> samples,
                                        double viscous) {
  const double length = support.radius();
  if (samples.empty() || !(length > 0.0)) return std::nullopt;
  const auto cost = [&](double log_scale) {
    return mean_angle(samples, support.scaled(std::exp(log_scale)), length, viscous);
  };
  const double step = std::log(kMaxScale / kMinScale) / kScales;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kScales; ++i) {
    const double angle = cost(std::log(kMinScale) + i * step);
    if (angle < least) {
      least = angle;
      best = i;
    }
  }
  if (best == 0 || best == kScales) return std::nullopt;
  double low = std::log(kMinScale) + (best - 1) * step;
  double high = low + 2.0 * step;
  for (int i = 0; i < kNarrowings; ++i) {
    const double a = high - (std::numbers::phi - 1.0) * (high - low);
    const double b = low + (std::numbers::phi - 1.0) * (high - low);
    if (cost(a) < cost(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return support.scaled(std::exp(0.5 * (low + high)));
}

}  // namespace pcavr
