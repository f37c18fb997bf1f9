// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/friction/limit_surface_fit.hpp"
#include "pcavr/physics/friction/point_push.hpp"

namespace pcavr {

/// A ground truth that the fit does NOT assume: a body on many small patches of Coulomb friction,
/// pushed by a finger at its edge, measured by noisy sensors. No ellipsoid, no quartic; points give
/// flat faces.
class SimulatedSupport {
 public:
  enum class Kind { even, uneven, three_points, four_points, ring, random_points };
  static constexpr int kKinds = 6;

  struct Patch {
    Eigen::Vector2d position;  ///< [m] from the centre of mass
    double force;              ///< [N] Coulomb friction that it bears
  };

  SimulatedSupport(Kind kind, Random& random)
      : length_(random.uniform(0.08, 0.3)), width_(length_ * random.uniform(0.5, 1.0)) {
    place_patches(kind, random);
    // Statics: the centre of mass is the centre of pressure.
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();
    double sum = 0.0;
    for (const Patch& patch : patches_) {
      centre += patch.force * patch.position;
      sum += patch.force;
    }
    centre_ = centre / sum;
    force_ = random.uniform(2.0, 40.0);
    for (Patch& patch : patches_) {
      patch.position -= centre_;
      patch.force *= force_ / sum;
    }
  }

  /// Friction force of a translation in any direction [N].
  [[nodiscard]] double force() const { return force_; }
  /// Half the body's mean side [m]: the weight of a rotation of 1 rad in an error of direction.
  [[nodiscard]] double length() const { return 0.25 * (length_ + width_); }

  /// A push at a random point of the edge inside a friction cone of 0.3. `noise` scales all
  /// measurement errors: 1 is a good force sensor and good tracking, 0 is exact.
  [[nodiscard]] PushSample push(Random& random, double noise) const {
    Eigen::Vector2d point, normal;
    edge(random, point, normal);
    const double angle = std::atan(0.3) * random.uniform(-1.0, 1.0);
    const Eigen::Vector2d direction = Eigen::Rotation2Dd(angle) * normal;
    PushSample sample;
    sample.twist =
        twist_under(wrench_of(direction, point), varied_patches(random, noise), sample.wrench);
    add_noise(random, noise, point, sample);
    return sample;
  }

 private:
  void place_patches(Kind kind, Random& random) {
    const auto anywhere = [&] {
      return Eigen::Vector2d(0.5 * length_ * random.uniform(-1.0, 1.0),
                             0.5 * width_ * random.uniform(-1.0, 1.0));
    };
    if (kind == Kind::even || kind == Kind::uneven) {
      const Eigen::Vector2d slope(random.uniform(-0.9, 0.9), random.uniform(-0.9, 0.9));
      const double concavity = random.uniform(-0.8, 0.8);
      for (int i = 0; i < 144; ++i) {
        const Eigen::Vector2d at((i % 12 - 5.5) / 12.0, (i / 12 - 5.5) / 12.0);
        const double pressure = (1.0 + slope.dot(at)) * (1.0 + 4.0 * concavity * at.squaredNorm());
        patches_.push_back({at.cwiseProduct(Eigen::Vector2d(length_, width_)),
                            kind == Kind::even ? 1.0 : std::max(0.05, pressure)});
      }
    } else if (kind == Kind::ring) {
      for (int i = 0; i < 72; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / 72.0;
        const double pressure = 1.0 + 0.5 * std::cos(angle);
        patches_.push_back(
            {0.45 * Eigen::Vector2d(length_ * std::cos(angle), width_ * std::sin(angle)),
             pressure});
      }
    } else {
      const int count = kind == Kind::three_points ? 3 : kind == Kind::four_points ? 4 : 12;
      for (int i = 0; i < count; ++i) patches_.push_back({anywhere(), random.uniform(0.3, 1.0)});
    }
  }

  /// The friction coefficient of a table varies by a few per cent: a level and a gradient under the
  /// body, random for each push.
  [[nodiscard]] std::vector<Patch> varied_patches(Random& random, double noise) const {
    const Eigen::Vector3d change =
        0.04 * noise * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    std::vector<Patch> patches = patches_;
    for (Patch& patch : patches) {
      patch.force *=
          std::max(0.2, 1.0 + change.z() + change.head<2>().dot(patch.position) / length());
    }
    return patches;
  }

  void edge(Random& random, Eigen::Vector2d& point, Eigen::Vector2d& normal) const {
    const double share = random.uniform(-0.5, 0.5);
    const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
    const bool is_long = random.uniform() * (length_ + width_) < length_;
    const Eigen::Vector2d middle = is_long ? Eigen::Vector2d(share * length_, side * 0.5 * width_)
                                           : Eigen::Vector2d(side * 0.5 * length_, share * width_);
    normal = -side * (is_long ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX());
    point = middle - centre_;
  }

  /// Minimises half the squared dissipation less the wrench's power: Newton's method on a convex
  /// function. Each patch's friction is regularised: a slope of 1 % of the body's speed instead of
  /// a jump.
  static Eigen::Vector3d twist_under(const Eigen::Vector3d& wrench,
                                     const std::vector<Patch>& patches,
                                     Eigen::Vector3d& wrench_on_surface) {
    double force = 0.0, radius = 0.0;
    for (const Patch& patch : patches) {
      force += patch.force;
      radius += patch.force * patch.position.norm();
    }
    const Eigen::Vector3d scale(1.0, 1.0, force / std::max(radius, 1e-6));
    const Eigen::Vector3d target = wrench.cwiseProduct(scale).normalized() * force * force;
    Eigen::Vector3d twist = target / (force * force);
    double cost = slope_at(twist, scale, patches, target).cost;
    for (int i = 0; i < 100; ++i) {
      const Slope slope = slope_at(twist, scale, patches, target);
      const Eigen::Vector3d step = slope.curvature.ldlt().solve(slope.gradient);
      double share = 1.0;
      while (share > 1e-9 && slope_at(twist - share * step, scale, patches, target).cost > cost) {
        share *= 0.5;
      }
      twist -= share * step;
      cost = slope_at(twist, scale, patches, target).cost;
      wrench_on_surface = slope.wrench_on_surface.cwiseQuotient(scale);
      if (slope.gradient.norm() < 1e-9 * force * force) break;
    }
    return twist.cwiseProduct(scale);
  }

  struct Slope {
    double cost = 0.0;
    Eigen::Vector3d wrench_on_surface = Eigen::Vector3d::Zero();  ///< scaled wrench on the surface
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  };
  static Slope slope_at(const Eigen::Vector3d& twist, const Eigen::Vector3d& scale,
                        const std::vector<Patch>& patches, const Eigen::Vector3d& target) {
    constexpr double kSoft = 0.01;
    Slope slope;
    double dissipation = 0.0;
    for (const Patch& patch : patches) {
      Eigen::Matrix<double, 2, 3> to_patch;
      to_patch << scale.x(), 0.0, -scale.z() * patch.position.y(), 0.0, scale.y(),
          scale.z() * patch.position.x();
      const Eigen::Vector2d v = to_patch * twist;
      const double speed = std::sqrt(v.squaredNorm() + kSoft * kSoft);
      dissipation += patch.force * speed;
      slope.wrench_on_surface += patch.force * to_patch.transpose() * v / speed;
      const Eigen::Matrix2d across =
          Eigen::Matrix2d::Identity() / speed - v * v.transpose() / (speed * speed * speed);
      slope.curvature += patch.force * to_patch.transpose() * across * to_patch;
    }
    slope.cost = 0.5 * dissipation * dissipation - target.dot(twist);
    slope.gradient = dissipation * slope.wrench_on_surface - target;
    slope.curvature = dissipation * slope.curvature +
                      slope.wrench_on_surface * slope.wrench_on_surface.transpose();
    return slope;
  }

  /// Adds the noise of a push of 6 mm: poses to 0.15 mm and 0.15 deg, forces to 1 % and 1 deg of
  /// the sensor's axes, the point of contact to 1 mm.
  static void add_noise(Random& random, double noise, const Eigen::Vector2d& point,
                        PushSample& sample) {
    const Eigen::Vector2d error(random.normal(), random.normal());
    const Eigen::Vector2d measured = point + 0.001 * noise * error;
    Eigen::Vector2d force = sample.wrench.head<2>();
    const double size = force.norm();
    force = Eigen::Rotation2Dd(std::numbers::pi / 180.0 * noise * random.normal()) * force;
    force += 0.01 * noise * size * Eigen::Vector2d(random.normal(), random.normal());
    sample.wrench = wrench_of(force, measured);
    sample.twist *= 0.006 / velocity_of(point, sample.twist).norm();
    sample.twist += noise * Eigen::Vector3d(0.00015 * random.normal(), 0.00015 * random.normal(),
                                            0.0026 * random.normal());
  }

  double length_, width_;  // [m] of the body's outline
  double force_ = 1.0;
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();  // of mass, in the outline's axes
  std::vector<Patch> patches_;
};

}  // namespace pcavr
