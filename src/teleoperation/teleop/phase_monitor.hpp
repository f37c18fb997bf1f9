// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/object/object_parameters.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"

#include "teleoperation/teleop/contact_line.hpp"

namespace pcavr {

struct MonitorSample {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();       ///< smoothed [m]
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();       ///< smoothed, bias removed [N]
  Eigen::Vector3d direction_base = Eigen::Vector3d::UnitX();  ///< from the tip into the object
  bool is_within_reach = false;  ///< so near that the force may act on this object
};

struct MonitoredPhase {
  double t = 0.0;  ///< [s] when it happened, which is before it was detected
  MotionPhase phase = MotionPhase::free;
};

/// Properties of the sensors as measured so far.
struct SensorProperties {
  double interval = 0.002;   ///< between samples [s]
  double tip_noise = 5e-5;   ///< of one raw sample [m]
  double force_noise = 0.2;  ///< of one raw sample [N]
  double correlated = 6.0;   ///< correlated smoothed samples per independent one
  double enter_force = 0.4;  ///< contact threshold of the smoothed force [N]
};

/// Detects an object's phase (free, static, critical, sliding) from force and motion, causally.
/// Contact: force above its noise while the tip is near; another one once the force has turned
/// round, as in a hole, where the tip is pulled out along the other wall. Sliding: the object's
/// displacement, which is the tip's minus the compression by the push's own contact line, grows
/// [paper C, SMA, automated]. Critical: the friction force has reached F_M minus the larger of its
/// std and a tenth. A change is detected some 40 ms late, and then stamped with the onset of the
/// fitted motion.
class PhaseMonitor {
 public:
  /// An object that is not movable never slides: each of its contacts is a press.
  PhaseMonitor(double t_start, const SensorProperties& sensors,
               const PhaseMonitorOptions& options = {}, bool is_movable = true);

  /// Call it while no contact lasts.
  void set_sensors(const SensorProperties& sensors) { sensors_ = sensors; }
  [[nodiscard]] const SensorProperties& sensors() const { return sensors_; }
  /// Ends a contact of which no more samples come.
  void lose_force();
  /// `damping`: damping over stiffness of the contact, chi in k d^n (1 + chi d') [s/m]; 0 if it is
  /// not known.
  void step(const MonitorSample& sample, const std::optional<ParameterValue>& limiting_friction,
            double damping);
  /// Tracking shows that a pushed object slides, since `t_onset` [s], although force and motion do
  /// not: a slow slide looks like a contact being loaded. Then the contact line is that before the
  /// onset, and the slide lasts until tracking shows the object at rest, or force and motion take
  /// over.
  void begin_slow_slide(double t_onset);
  /// Ends such a slide; otherwise without effect.
  void end_slow_slide();
  /// Update by the camera alone, without force.
  void update_from_camera(double t, bool is_moving, bool is_near);

  [[nodiscard]] MotionPhase phase() const { return changes_.back().phase; }
  [[nodiscard]] bool is_touched() const { return is_touched_; }
  [[nodiscard]] double contact_begin() const { return contact_begin_; }
  /// Direction of the push, level; of a press, into the face.
  [[nodiscard]] const Eigen::Vector3d& direction_base() const { return direction_base_; }
  /// The tip's coordinate along it [m] is how far the object has to give way in the direction of
  /// the push for the tip to be as deep in the face as before: below an inclined face a tip that
  /// goes down advances, too.
  [[nodiscard]] const Eigen::Vector3d& advance_base() const { return advance_base_; }
  [[nodiscard]] bool is_press() const { return is_press_; }
  /// Whether the object has slid in the current or the last contact, by force and motion.
  [[nodiscard]] bool has_slid() const { return has_slid_; }
  /// Whether the object slides by tracking alone.
  [[nodiscard]] bool is_slow_slide() const { return is_slow_slide_; }
  /// The object's speed along the push [m/s]; 0 unless it slides.
  [[nodiscard]] double speed() const { return speed_; }
  /// The tip's speed along the push, over the same time [m/s].
  [[nodiscard]] double tip_speed() const { return tip_speed_; }
  /// The force along the push without damping [N], which determines the penetration.
  [[nodiscard]] double resting_force() const;
  /// The object's displacement in this contact [m], by the current contact line. Empty before there
  /// is a line, and for times outside the contact.
  [[nodiscard]] std::optional<double> displacement_at(double t) const;
  /// The latest stamps may still change by some 30 ms with more data.
  [[nodiscard]] const std::vector<MonitoredPhase>& changes() const { return changes_; }

 private:
  struct Point {
    double t = 0.0;
    double tip = 0.0;       ///< [m] along advance_base()
    double force = 0.0;     ///< without damping [N]
    double friction = 0.0;  ///< at the support [N]
  };
  void begin_contact(const MonitorSample& sample);
  /// Whether the object pushes the tip back no longer, but the opposite wall does.
  [[nodiscard]] bool has_turned(const MonitorSample& sample);
  [[nodiscard]] double without_damping(double t, double tip, double force, double damping) const;
  void end_contact();
  void stamp_contact();
  [[nodiscard]] std::optional<double> touch_time() const;  ///< [s]
  void end_line_of_press(double force);
  void process(const Point& point, const std::optional<ParameterValue>& limiting_friction);
  void update_static_phase(const std::optional<ParameterValue>& limiting_friction);
  void measure_speed();
  /// Whether the object's speed has been above its noise for some samples.
  [[nodiscard]] bool is_fast();
  void begin_slide();
  /// `is_over`: no further samples will refine its onset.
  void stamp_slide(bool is_over = false);
  void end_slide();
  void stamp_critical(double t_onset);
  void stamp_rest(double t_stop);
  [[nodiscard]] double critical_force() const;
  void change_to(double t, MotionPhase phase);
  [[nodiscard]] double displacement(const Point& point) const;
  [[nodiscard]] double mean_displacement(double from, double to) const;
  [[nodiscard]] std::size_t first_after(double t) const;
  /// [m] of a slide.
  [[nodiscard]] double min_displacement() const;
  [[nodiscard]] double displacement_noise(double force) const;

  SensorProperties sensors_;
  PhaseMonitorOptions options_;
  bool is_movable_;
  std::vector<MonitoredPhase> changes_;
  bool is_touched_ = false;
  bool is_press_ = false;
  int in_a_row_ = 0, turned_in_a_row_ = 0;
  double above_since_ = 0.0;
  double last_loaded_ = 0.0;  ///< [s]
  double last_near_ = 0.0;    ///< [s] when the tip was last at its last loaded position
  double loaded_tip_ = 0.0;   ///< [m] last tip coordinate under load
  double contact_begin_ = 0.0;
  double contact_stamp_ = 0.0;                              ///< [s] of its change of the phase
  Eigen::Vector3d inward_base_ = Eigen::Vector3d::UnitX();  ///< of the touched face
  std::optional<Eigen::Vector3d> opposite_base_ = {};       ///< inward, after the force has turned
  Eigen::Vector3d direction_base_ = Eigen::Vector3d::UnitX();
  Eigen::Vector3d advance_base_ = Eigen::Vector3d::UnitX();
  ContactLine line_;
  bool is_line_final_ = false;
  bool has_slid_ = false;
  bool is_slow_slide_ = false;
  double touch_force_ = 0.0;  ///< [N] when contact was detected
  double max_force_ = 0.0;    ///< [N] of a press
  std::size_t next_for_line_ = 0;
  struct TipSample {
    double t = 0.0;
    Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  };
  std::deque<TipSample> approach_;  ///< the newest before the current contact, and its first
  std::vector<Point> contact_;      ///< all samples of the current contact
  double window_;                   ///< for the speed estimate [s]
  double speed_ = 0.0, tip_speed_ = 0.0, speed_noise_ = 0.0;
  int fast_in_a_row_ = 0;
  int critical_in_a_row_ = 0;
  double rest_displacement_ = 0.0;
  double rest_since_ = 0.0;
  double slide_detected_ = 0.0;  ///< [s]
  bool is_slide_stamped_ = true;
  std::optional<ParameterValue> limit_ = {};
};

}  // namespace pcavr
