// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/identification/object_parameters.hpp"
#include "pcavr/prediction/predicted_world.hpp"

#include "teleop/contact_line.hpp"

namespace pcavr {

struct MonitorSample {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();       ///< smoothed [m]
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();       ///< smoothed, bias removed [N]
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitX();  ///< from the tip into the object
  bool is_within_reach = false;  ///< so near that the force may be this object's
};

struct MonitoredPhase {
  double t = 0.0;  ///< [s] when it happened, which is before it was known
  MotionPhase phase = MotionPhase::free;
};

struct MonitorOptions {
  double interval = 0.002;      ///< between samples [s]
  double tip_noise = 5e-5;      ///< of one raw sample [m]
  double force_noise = 0.2;     ///< of one raw sample [N]
  double correlated = 6.0;      ///< smoothed samples that count as one
  double enter_force = 0.4;     ///< smoothed force above: contact [N]
  double slide_speed = 0.0025;  ///< least speed that is told from rest [m/s]
};

/// Tells an object's phase from force and motion, each decision from the past only. Touched: force
/// above its noise while the tip is near. Slides: the object's way, which is the tip's less the
/// compression by the push's own contact line, grows [paper C, SMA, without a hand]. Critical: the
/// friction needed has reached F_M less the larger of its STD and a tenth. A change is noticed some
/// 40 ms late, and then stamped with the instant at which the fitted motion began.
class PhaseMonitor {
 public:
  PhaseMonitor(double t_start, const MonitorOptions& options);

  /// `damping`: what the contact's damping is over its stiffness, chi in k d^n (1 + chi d') [s/m];
  /// 0 where it is not known.
  void step(const MonitorSample& sample, const std::optional<ParameterValue>& limiting_friction,
            double damping);
  /// What the camera alone shows of an object that no force speaks of.
  void see(double t, bool is_moving, bool is_near);

  [[nodiscard]] MotionPhase phase() const { return changes_.back().phase; }
  [[nodiscard]] bool is_touched() const { return is_touched_; }
  [[nodiscard]] double contact_begin() const { return contact_begin_; }
  [[nodiscard]] const Eigen::Vector3d& direction_base() const { return direction_base_; }
  [[nodiscard]] bool is_press() const { return is_press_; }
  /// In the present or the last contact.
  [[nodiscard]] bool has_slid() const { return is_line_final_; }
  /// Of the object along the push [m/s]; 0 unless it slides.
  [[nodiscard]] double speed() const { return speed_; }
  /// The force along the push less what damping adds [N]: what tells the depth.
  [[nodiscard]] double resting_force() const;
  /// How far the object has gone in this contact [m], on the line as it is known now. Nothing
  /// before the line is, and for times outside the contact.
  [[nodiscard]] std::optional<double> way_at(double t) const;
  /// The latest stamps may still move by some 30 ms as more is seen.
  [[nodiscard]] const std::vector<MonitoredPhase>& changes() const { return changes_; }

 private:
  struct Point {
    double t = 0.0;
    double tip = 0.0;       ///< [m]
    double force = 0.0;     ///< less damping [N]
    double friction = 0.0;  ///< what the support bears [N]
  };
  void begin_contact(const MonitorSample& sample);
  [[nodiscard]] double without_damping(double t, double tip, double force, double damping) const;
  void end_contact();
  void stamp_contact();
  void follow(const Point& point, const std::optional<ParameterValue>& limiting_friction);
  void judge_rest(const std::optional<ParameterValue>& limiting_friction);
  void measure_speed();
  void begin_slide();
  void stamp_slide();
  void end_slide();
  void stamp_critical(double t_onset);
  void stamp_rest(double t_stop);
  [[nodiscard]] double critical_force() const;
  void change_to(double t, MotionPhase phase);
  [[nodiscard]] double way(const Point& point) const;
  [[nodiscard]] double mean_way(double from, double to) const;
  [[nodiscard]] std::size_t first_after(double t) const;
  [[nodiscard]] double way_noise(double force) const;

  MonitorOptions options_;
  std::vector<MonitoredPhase> changes_;
  bool is_touched_ = false;
  bool is_press_ = false;
  int in_a_row_ = 0;
  double above_since_ = 0.0;
  double last_loaded_ = 0.0;  ///< [s]
  double last_near_ = 0.0;    ///< [s] that the tip was where it last pressed
  double loaded_tip_ = 0.0;   ///< [m] there
  double contact_begin_ = 0.0;
  bool is_contact_stamped_ = false;
  Eigen::Vector3d direction_base_ = Eigen::Vector3d::UnitX();
  ContactLine line_;
  bool is_line_final_ = false;
  std::size_t next_for_line_ = 0;
  std::vector<Point> contact_;  ///< all samples of the present contact
  double window_ = 0.06;        ///< of the speed [s]
  double speed_ = 0.0, tip_speed_ = 0.0, speed_noise_ = 0.0;
  int fast_in_a_row_ = 0;
  int critical_in_a_row_ = 0;
  double rest_way_ = 0.0;
  double rest_since_ = 0.0;
  double seen_since_ = 0.0;  ///< when the slide was noticed
  bool is_slide_stamped_ = true;
  std::optional<ParameterValue> limit_ = {};
};

}  // namespace pcavr
