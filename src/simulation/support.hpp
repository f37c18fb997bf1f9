// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "pcavr/simulation/plant.hpp"

#include "simulation/bristles.hpp"

namespace pcavr::simulation {

/// The load on the support in addition to the body's weight. Base axes.
struct SupportLoad {
  double extra_normal_force = 0.0;  ///< [N]
  /// Tipping moment, directed as the force that causes it [N m]: shifts the centre of pressure in
  /// this direction.
  Eigen::Vector2d tipping_moment = Eigen::Vector2d::Zero();
};

/// The friction under one body: bristles on patches. A tipping moment shifts pressure from patch to
/// patch, linearly as a uniform elastic (Winkler) foundation; patches can't pull (unilateral).
class Support {
 public:
  explicit Support(const PlantBody& body);

  [[nodiscard]] const Eigen::Vector2d& centre_body() const { return centre_; }
  [[nodiscard]] double radius() const { return radius_; }  ///< see friction_radius [m]
  /// See PlantBodyState::load_factor; of the latest step.
  [[nodiscard]] double load_factor() const { return load_factor_; }

  /// Advances the bristles by dt [s]; `twist` of the centre of mass [m/s, m/s, rad/s]. Returns
  /// the wrench on the body, base axes [N, N, N m about the centre of mass].
  [[nodiscard]] Eigen::Vector3d advance(const Eigen::Vector3d& twist, double yaw,
                                        const SupportLoad& load, double dt);

 private:
  struct Patch {
    Eigen::Vector2d r_body;  ///< from the centre of mass [m]
    double share;
    double wear;
    double pressure;                                       ///< [N] at present
    Eigen::Vector2d deflection = Eigen::Vector2d::Zero();  ///< base axes [m]
  };

  /// Friction coefficient of a patch over the body's.
  [[nodiscard]] double friction_factor(const Patch& patch) const;
  void distribute(double extra_normal_force, const Eigen::Vector2d& tipping_moment_body);
  /// `total` [N]
  void distribute_evenly(double total);

  BristleLaw law_;
  double weight_ = 0.0;   ///< [N]
  double viscous_ = 0.0;  ///< [N s/m]
  double load_exponent_ = 0.0;
  double radius_ = 0.0;
  double load_factor_ = 1.0;
  double half_side_ = 0.0;  ///< half the smaller side of the patches' rectangle [m]
  Eigen::Vector2d centre_;
  std::vector<Patch> patches_;
};

}  // namespace pcavr::simulation
