// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

namespace pcavr {

/// Candidates for the displacement over which a joint's friction changes its sign [rad]: from the
/// compliance of a bearing's contacts to that of a harmonic drive.
inline constexpr std::array<double, 6> kPreslidingDisplacements{0.0005, 0.001, 0.002,
                                                                0.004,  0.008, 0.016};

/// The sign of a friction that builds up by displacement, not by speed: after a reversal it goes
/// from one sign to the other over some `displacement` [rad] > 0, dz/dq = (1 - z sign(dq)) /
/// displacement [Dahl 1968, exponent 1]. It is so in gears and pre-loaded bearings.
class PreslidingSign {
 public:
  explicit PreslidingSign(double displacement, double start = 0.0);

  /// Moves by `step` [rad]; returns the sign after it. Exact for any step without a reversal.
  double move(double step);
  [[nodiscard]] double value() const { return value_; }  ///< -1 to 1
  [[nodiscard]] double slope(double direction) const;    ///< dz/dq [1/rad] in a direction

 private:
  double displacement_;
  double value_;
};

/// The sign at each of the positions [rad], from 0 at the first.
[[nodiscard]] Eigen::VectorXd presliding_sign(const Eigen::VectorXd& position, double displacement);

}  // namespace pcavr
