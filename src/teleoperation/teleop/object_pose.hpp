// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/message.hpp"
#include "teleoperation/teleop/phase_monitor.hpp"
#include "teleoperation/teleop/slow_slide.hpp"
#include "teleoperation/teleop/surface_offset.hpp"
#include "teleoperation/teleop/tracking_noise.hpp"

namespace pcavr {

/// Tip and force at one time, at the robot's site.
struct TouchSample {
  double t = 0.0;
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_base = Eigen::Vector3d::Zero();  ///< bias removed [N]
};

/// The robot site's estimate of an object's pose, with its uncertainty.
struct PoseEstimate {
  Pose T_base_object;
  double std = 0.0;        ///< along one axis [m]
  bool is_current = true;  ///< false: it is moving, and was last tracked some time before
};

[[nodiscard]] inline bool slides(MotionPhase phase) { return phase == MotionPhase::sliding; }

/// Where the robot's site has one object, by tracking and contact, and in which phase of motion.
/// There is always a pose: the scene's before the first frame; poses that have arrived are used in
/// order, each once, when the tool's clock has reached them. Not thread-safe.
class ObjectPose {
 public:
  /// Keeps a reference to `object`, which must outlive it; its `tracked` is not used.
  ObjectPose(const TeleopObject& object, const TeleopOptions& options,
             const SensorProperties& sensors, double tool_radius, double start);

  /// A pose that has arrived; stamps of the camera, ascending.
  void add_tracked(const TrackedPose& pose);
  /// Processes the poses up to `t` [s] on the tool's clock, which the camera's is ahead of by
  /// `camera_offset` [s].
  void update_tracking(double t, double camera_offset);
  [[nodiscard]] Touch touch(const Eigen::Vector3d& p_base_tip) const;
  /// Whether it moves according to the camera alone.
  [[nodiscard]] bool is_seen_moving() const { return is_seen_moving_; }
  /// Whether it has moved in this contact according to the camera, however slowly.
  [[nodiscard]] bool has_moved_in_contact() const { return has_moved_in_contact_; }
  [[nodiscard]] bool is_lost(double t) const;

  /// The pose used last, and the newest frame with its std.
  [[nodiscard]] const Pose& T_base_object() const { return T_base_object_; }
  [[nodiscard]] const TrackedPose& latest() const { return latest_; }
  /// The tip pushes it: touched, not pressed onto its support.
  [[nodiscard]] bool is_pushed() const { return monitor_.is_touched() && !monitor_.is_press(); }

  /// Its pose at a sample's time: the latest frame, extrapolated by the object's displacement
  /// since, and during contact fused with the face's position by force and the contact law in
  /// `known`, weighted by the inverse variances. The correction by contact is kept until the camera
  /// sees the object move. An object that is not tracked is where the operator's site has predicted
  /// it to be (dead reckoning) until a contact shows its face elsewhere.
  [[nodiscard]] PoseEstimate estimate(const TouchSample& sample, const PlanarPose& predicted,
                                      const ObjectParameters& known);
  /// Current estimate of [vx vy omega].
  [[nodiscard]] Eigen::Vector3d twist() const;

  static constexpr double kMaxTrackedTime = 4.0;  ///< [s] a trial of more would hold up the site
  /// The object's motion in its last contacts, for trials of parameters: begin, pose at touch,
  /// direction and the poses of the first kMaxTrackedTime; of presses, only the newest contact.
  [[nodiscard]] const std::deque<Contact>& tracked_contacts() const { return tracked_contacts_; }
  void forget_contacts() { tracked_contacts_.clear(); }
  /// The object's tracked poses in [begin, end] [s].
  [[nodiscard]] std::vector<TrackedPose> tracked_between(double begin, double end) const;
  /// The surface offset under `law` as it was measured here, else as `known`.
  [[nodiscard]] std::optional<Eigen::Vector3d> surface_offset(const HuntCrossley& law,
                                                              const ObjectParameters& known) const;

  [[nodiscard]] PhaseMonitor& monitor() { return monitor_; }
  [[nodiscard]] const PhaseMonitor& monitor() const { return monitor_; }
  [[nodiscard]] const TeleopObject& source() const { return *source_; }

 private:
  /// Offset from an estimate of the pose to the face that the tip presses.
  struct ContactOffset {
    Eigen::Vector3d offset_base = Eigen::Vector3d::Zero();  ///< [m]
    double std = 0.0;                                       ///< of the shifted pose, one axis [m]
  };
  [[nodiscard]] PoseEstimate estimate_from_frame(const TouchSample& sample,
                                                 const ObjectParameters& known);
  [[nodiscard]] PoseEstimate estimate_from_prediction(const TouchSample& sample,
                                                      const PlanarPose& predicted,
                                                      const ObjectParameters& known) const;
  /// Empty without a push, or without a contact law that gives the penetration.
  [[nodiscard]] std::optional<ContactOffset> offset_by_contact(const TouchSample& sample,
                                                               const PoseEstimate& estimate,
                                                               const ObjectParameters& known) const;
  /// Whether the force along the push is that on the face which the tip is nearest to.
  [[nodiscard]] bool is_pressed(const Touch& tip) const;
  /// [m] Std of the tip behind the low-pass filter of the offset from camera to contact.
  [[nodiscard]] double filtered_tip_noise() const;
  /// Measures where the tip meets the tracked body, once for each frame.
  void measure_surface(const TouchSample& sample, const PoseEstimate& estimate,
                       const ObjectParameters& known);
  static void apply(const ContactOffset& face, PoseEstimate& estimate);
  [[nodiscard]] double displacement_since_frame(double t) const;
  void update_motion(const TrackedPose& seen);
  /// The mean of the newest frames while the object rests: their noise is no motion.
  [[nodiscard]] TrackedPose averaged_at_rest(const TrackedPose& seen);
  /// Whether two poses are apart by more than their noise.
  [[nodiscard]] bool is_apart(const TrackedPose& a, const TrackedPose& b) const;
  void end_average();
  void compare_with_before_contact();
  void record_contact(const TrackedPose& seen);
  void remember(const TrackedPose& seen);
  /// Slides that tracking shows although force and motion do not.
  void detect_slow_slide(const TrackedPose& seen);
  void measure_interval(double t);
  /// Measures how the body moves while it is pushed, from its newest frames.
  void measure_motion();
  /// A pose moved on with the contact by `displacement` [m] along the push.
  [[nodiscard]] Pose moved_on(const Pose& T_base_object, double displacement) const;

  /// Motion of the body per displacement of its contact along the push.
  struct PushedMotion {
    Eigen::Vector2d shift_base = Eigen::Vector2d::Zero();  ///< [m/m] of the object's origin
    double rotation = 0.0;                                 ///< [rad/m]
  };

  PhaseMonitor monitor_;
  const TeleopObject* source_;
  PoseFusionOptions options_;
  double max_contact_time_;  ///< [s] of a contact that is identified
  BodySurface surface_;
  double tool_radius_;
  std::deque<TrackedPose> waiting_;  ///< arrived and not processed
  std::deque<TrackedPose> seen_;     ///< those processed last
  TrackingNoise noise_ = {};
  /// Empty while it does not turn: it moves with the contact.
  std::optional<PushedMotion> motion_ = {};
  std::deque<double> gaps_;  ///< [s] between the newest frames
  std::size_t frames_ = 0;   ///< processed
  int averaged_frames_ = 0;  ///< in `latest_`
  bool was_apart_ = false;   ///< the frame before, from that mean
  TrackedPose latest_;       ///< or the mean of the latest; the scene's pose before the first frame
  Pose T_base_object_;       ///< latest frame, or the estimate while it is lost
  double yaw_rate_ = 0.0;    ///< [rad/s]
  bool is_seen_moving_ = false;
  TrackedPose before_contact_;  ///< the latest frame before the contact
  bool has_moved_in_contact_ = false;
  std::deque<Contact> tracked_contacts_;  ///< the newest
  std::vector<TrackedPose> history_;      ///< of the longest contact that is identified, at least
  SlowSlide slow_slide_;
  std::optional<double> slow_contact_begin_ = {};             ///< [s] of its contact
  Eigen::Vector3d touched_object_ = Eigen::Vector3d::Zero();  ///< [m] at first touch
  Eigen::Vector3d p_base_tip_ = Eigen::Vector3d::Zero();      ///< newest [m]
  double frame_interval_;
  Eigen::Vector3d touched_offset_ =
      Eigen::Vector3d::Zero();  ///< from the tracked position to that by contact [m]
  double touched_std_ = 0.0;    ///< [m]; 0: not touched at this pose
  SurfaceOffset measured_surface_;
  std::size_t measured_frame_ = 0;  ///< the last of `frames_` in it
};

}  // namespace pcavr
