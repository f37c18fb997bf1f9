// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace pcavr {

/// The contact law, fitted online to the push itself while the object is static: the tip's
/// coordinate is surface + (F / k)^(1/n), a least-squares fit over running sums for n = 1 (linear)
/// and n = 1.5 (Hertz), of which the one with the smaller residual is used. An object that moves
/// deviates from the line [paper C, SMA]. Until the slope's standard error is small enough, and on
/// contacts so stiff that it never is, the chord from first contact to the latest sample is used:
/// it curves less than any law with n >= 1, so compression is not mistaken for motion.
class ContactLine {
 public:
  /// The tip's coordinate [m] and the force [N] when contact was detected.
  explicit ContactLine(double touch = 0.0, double touch_force = 0.0)
      : touch_(touch), touch_force_(touch_force) {}

  /// tip: coordinate growing into the object [m]; force > 0 [N].
  /// `correlated`: number of correlated samples per independent one.
  void add(double tip, double force, double correlated);

  /// The relative standard error of the fit's slope is below 10 %.
  [[nodiscard]] bool is_ready() const { return is_ready_; }
  /// Whether at least the chord exists: the force has doubled since contact was detected.
  [[nodiscard]] bool is_usable() const { return is_ready_ || chord_ > 0.0; }
  [[nodiscard]] double surface() const;  ///< the tip's coordinate at first contact [m]
  [[nodiscard]] double penetration(double force) const;  ///< at a quasi-static force [m]
  /// Inverse of penetration(): the quasi-static force [N].
  [[nodiscard]] double force(double penetration) const;

 private:
  static constexpr std::array<double, 2> kExponents{1.0, 1.5};
  struct Fit {
    double slope = 0.0;     ///< penetration over F^(1/n)
    double surface = 0.0;   ///< relative to origin_
    double residual = 0.0;  ///< [m^2]
    double slope_std = 0.0;
  };
  struct Sums {
    double g = 0.0, gg = 0.0, gx = 0.0;
  };
  [[nodiscard]] Fit fit(std::size_t law) const;
  [[nodiscard]] std::size_t best() const;

  std::array<Sums, 2> sums_{};
  double x_ = 0.0, xx_ = 0.0;
  double origin_ = 0.0;  ///< the first tip coordinate, subtracted for numerical accuracy
  double touch_;
  double touch_force_;
  double chord_ = 0.0;  ///< slope of the chord [m/N]
  std::size_t count_ = 0;
  bool is_ready_ = false;
};

}  // namespace pcavr
