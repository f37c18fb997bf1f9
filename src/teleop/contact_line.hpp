// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace pcavr {

/// The contact's law as the push itself shows it while the object stands: the tip's coordinate is
/// surface + (F / k)^(1/n), fitted over running sums for n = 1 and n = 1.5, of which the smaller
/// residual holds. An object that moves leaves the line [paper C, SMA]. Until the fit is sure of
/// its slope, and on contacts so stiff that it never is, the straight line from first touch to the
/// latest sample stands in: it bends less than any law with n >= 1, so it takes no compression for
/// motion.
class ContactLine {
 public:
  /// The tip's coordinate [m] and the force [N] when the touch was noticed.
  explicit ContactLine(double touch = 0.0, double touch_force = 0.0)
      : touch_(touch), touch_force_(touch_force) {}

  /// tip: coordinate growing into the object [m]; force > 0 [N].
  /// `correlated`: how many successive samples count as one.
  void add(double tip, double force, double correlated);

  /// The fit's slope is known to a tenth.
  [[nodiscard]] bool is_ready() const { return is_ready_; }
  /// There is at least the straight line: the force has doubled since the touch was noticed.
  [[nodiscard]] bool is_usable() const { return is_ready_ || chord_ > 0.0; }
  [[nodiscard]] double surface() const;            ///< the tip's coordinate at first touch [m]
  [[nodiscard]] double depth(double force) const;  ///< under a resting force [m]
  /// Inverse of depth(): the resting force [N].
  [[nodiscard]] double force(double depth) const;

 private:
  static constexpr std::array<double, 2> kExponents{1.0, 1.5};
  struct Fit {
    double slope = 0.0;     ///< depth over F^(1/n)
    double surface = 0.0;   ///< relative to origin_
    double residual = 0.0;  ///< [m^2]
    double slope_deviation = 0.0;
  };
  struct Sums {
    double g = 0.0, gg = 0.0, gx = 0.0;
  };
  [[nodiscard]] Fit fit(std::size_t law) const;
  [[nodiscard]] std::size_t best() const;

  std::array<Sums, 2> sums_{};
  double x_ = 0.0, xx_ = 0.0;
  double origin_ = 0.0;  ///< the first tip: keeps the sums small
  double touch_;
  double touch_force_;
  double chord_ = 0.0;  ///< of the straight line [m/N]
  std::size_t count_ = 0;
  bool is_ready_ = false;
};

}  // namespace pcavr
