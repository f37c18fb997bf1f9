// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/teleoperation/link/tip_response.hpp"

namespace pcavr {

/// Identifies how the tip of an arm follows its setpoints, from its motion and the forces that it
/// exerts. For given rate and damping ratio the shortfall is linear in the other parameters of
/// TipResponse, with force and setpoint passed through the oscillator: least squares for each pair
/// of a grid, and the minimum between its points (separable least squares; Golub & Pereyra 1973).
/// Force and setpoint are known well beside the tip, whose noise is the residual's; so there is no
/// bias by noisy derivatives. All signals are taken without their mean over the last second: a
/// constant offset of tip or force does not matter. Newer contacts replace older ones. Not
/// thread-safe.
class ToolResponse {
 public:
  ToolResponse();
  /// The setpoint of the tip from `t` [s] on; ascending, as the other two.
  void add_setpoint(double t, const Eigen::Vector3d& p_base);
  /// The force that the tip exerted at `t` [N].
  void add_force(double t, const Eigen::Vector3d& force_base);
  /// The tip's position at `t` [m].
  void add_tip(double t, const Eigen::Vector3d& p_base_tip);
  /// The response, once the compliance is known to a third. A tip that is driven by something else
  /// has none.
  [[nodiscard]] const std::optional<TipResponse>& value() const { return value_; }

 private:
  struct Timed {
    double t = 0.0;  ///< [s]
    Eigen::Vector3d value;
  };
  /// A signal behind a damped oscillator.
  struct Filtered {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();          ///< [1/s]
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< [1/s^2]
  };
  /// The signals behind an oscillator of one pair of rate and damping ratio.
  struct Oscillator {
    double rate = 0.0;  ///< [rad/s]
    double damping_ratio = 0.0;
    Filtered force = {}, setpoint = {};
    Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();  ///< of the regressors, each a column
    // Sums over axes and time, of force, speed and acceleration.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();

    void advance(Filtered& signal, const Eigen::Vector3d& input, double dt) const;
    [[nodiscard]] Eigen::Matrix3d regressors() const;
  };

  /// The least squares of one pair.
  struct Fit {
    Eigen::Vector3d found = Eigen::Vector3d::Zero();  ///< compliance and both lags
    Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
    double left = 0.0;  ///< of the squares [m^2 s]
  };

  static std::optional<Eigen::Vector3d> at(const std::deque<Timed>& signal, double t);
  void process(const Timed& tip, const Eigen::Vector3d& setpoint, const Eigen::Vector3d& force);
  void restart(const Eigen::Vector3d& setpoint, const Eigen::Vector3d& force);
  void add_rows(const Eigen::Vector3d& shortfall, double speed, double dt);
  [[nodiscard]] Fit fit(const Oscillator& oscillator) const;
  void solve();

  std::deque<Timed> setpoints_, forces_, tips_;  ///< tips: that wait for the others
  std::deque<Eigen::Vector3d> raw_forces_;       ///< the newest three
  std::optional<double> last_force_ = {};        ///< [s] of the newest of them
  std::vector<Oscillator> oscillators_;
  std::optional<double> last_ = {};  ///< [s] the newest processed tip
  Eigen::Vector3d last_setpoint_ = Eigen::Vector3d::Zero();
  double continuous_ = 0.0;  ///< [s] since the last restart
  Eigen::Vector3d mean_shortfall_ = Eigen::Vector3d::Zero();
  double squares_ = 0.0;        ///< of the shortfall
  double time_ = 0.0;           ///< [s] in the sums
  double pressed_ = 0.0;        ///< [s] of contact
  double next_solution_ = 0.0;  ///< [s]
  std::optional<TipResponse> value_ = {};
};

}  // namespace pcavr
