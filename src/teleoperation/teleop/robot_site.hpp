// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/geometry/pose_outliers.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/inputs/tip_stream.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/correction_trial.hpp"
#include "teleoperation/teleop/force_stream.hpp"
#include "teleoperation/teleop/input_watch.hpp"
#include "teleoperation/teleop/operator_site.hpp"
#include "teleoperation/teleop/pending_trial.hpp"
#include "teleoperation/teleop/prediction_log.hpp"
#include "teleoperation/teleop/robot_object.hpp"

namespace pcavr {

/// The robot's site: measures force, tip and tracking as they come, identifies parameters online,
/// compares with the operator site's predictions for the same times, and sends corrections. Nothing
/// is known of the samples beforehand but the priors of the options: noise, bias and clock offsets
/// are measured on the way. Memory is bounded: a minute of samples, and the window of `inputs`.
/// Deterministic in the order of the calls. One thread at a time.
class RobotSite {
 public:
  /// The series and `tracked` of `world` are not used. It is copied. The inputs are examined by a
  /// thread, so that this does not hold up `advance`, or, where `background` is deferred, within
  /// it; the results are the same.
  RobotSite(const TeleopInput& world, const TeleopOptions& options,
            const std::vector<BodyPhysics>& physics, double start, Background background = {});
  // The parts refer to each other.
  RobotSite(const RobotSite&) = delete;
  RobotSite& operator=(const RobotSite&) = delete;

  /// Samples in any interleaving, stamps [s] ascending in each series and by each sensor's clock.
  /// Those out of order, and numbers that are not finite, are ignored and noted.
  void add_tool(double t, const Eigen::Vector3d& p_base_tip,
                const std::optional<Eigen::Quaterniond>& q_base_tool = {});
  void add_wrench(double t, const Eigen::Vector3d& force_base);
  void add_tracked(std::size_t object, const TrackedPose& pose);
  /// Processes the samples that are ready at `now` [s]; `log` covers it. Returns the corrections to
  /// send.
  [[nodiscard]] std::vector<CorrectionMessage> advance(double now, const PredictionLog& log);
  /// Whether advance() to `now` [s] would wait for a thread.
  [[nodiscard]] bool would_wait(double now) const;
  /// Called after an outage of the link: nothing is in flight, nothing before `now` [s] is
  /// compared, and the next comparison of each object sends all of its state.
  void restart(double now);
  /// Nobody predicts: nothing is compared up to `now` [s], and old samples are forgotten.
  void idle(double now);

  [[nodiscard]] const std::vector<RobotObject>& objects() const { return objects_; }
  /// The rows since the last call.
  [[nodiscard]] std::vector<ForceRow> take_forces() { return std::exchange(forces_, {}); }
  /// No prediction before this time will be requested from the log again [s].
  [[nodiscard]] double oldest_needed() const;
  [[nodiscard]] std::vector<std::string> notes() const;
  /// Tasks that have failed since the last call, a line for each; what was known is kept. Those at
  /// the end are in notes().
  [[nodiscard]] std::vector<std::string> take_failures() { return std::exchange(failures_, {}); }
  /// [s] Sets the time from sending a correction to the first prediction that contains it, from now
  /// on.
  void set_round_trip(double round_trip);
  /// Applies what is still being identified, at the end.
  void apply_identifications();
  void note_bytes(std::size_t sent) { sent_bytes_ += sent; }
  [[nodiscard]] std::size_t streaming_bytes() const { return streaming_bytes_; }
  /// The force has a fault, so that it is not used.
  [[nodiscard]] bool has_force_fault() const { return watch_.fault().has_value(); }
  /// Findings about the inputs so far, by all samples; expensive.
  [[nodiscard]] InputFindings findings();

 private:
  [[nodiscard]] bool has_force(double now) const;
  [[nodiscard]] bool is_any_touched() const;
  void process_forces(double now, const PredictionLog& log);
  void process_camera(double now, const PredictionLog& log);
  void process_sample(const ForceStream::Sample& measured, const PredictionLog& log);
  void update_sensors();
  void examine_inputs_at(double t);
  [[nodiscard]] double stored_time() const;  ///< [s] of samples that may be requested again
  void learn_again(double offset_change);
  /// The samples of a contact, copied.
  [[nodiscard]] ContactSamples copy_of(const RobotObject& object,
                                       const ObjectKnowledge::UsedContact& contact) const;
  /// Applies from now on what was identified of the object. Waits for the thread.
  void apply_identification(RobotObject& object);
  /// Uses what was found of friction when it is due, and begins the next search.
  void search_friction(RobotObject& object, double t);
  void apply_search(RobotObject& object);
  void note_contradiction(RobotObject& object, double begin);
  [[nodiscard]] const UnusableInterval* unusable_in(double begin, double end) const;
  void process_time(const TouchSample& sample, const PredictionLog& log);
  [[nodiscard]] std::optional<TouchedBody> attribute(const TouchSample& sample,
                                                     std::vector<Touch>& touches) const;
  void estimate_bias(const TouchSample& sample, const std::vector<Touch>& touches);
  void update_tracking(double t);
  void check_static_limit(RobotObject& object, const TouchSample& sample);
  void plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t);
  void update_first_law(RobotObject& object, double t);
  void learn(RobotObject& object, double t);
  void identify(RobotObject& object, double t);
  void record_force(const TouchSample& sample, const Eigen::Vector3d& clean_base,
                    const PredictionLog& log);
  void compare(std::size_t index, const TouchSample& sample, const Prediction& prediction);
  /// A correction of what differs, without what only noise shows; not tried yet.
  [[nodiscard]] CorrectionMessage compose(std::size_t index, CorrectionCase which,
                                          const TouchSample& sample, const PlanarPose& predicted,
                                          double gap, const SiteComparison& seen);
  void send_tried(const TouchSample& sample);
  /// Sends what is left of a correction after its trial, if it is worth sending.
  void send(CorrectionMessage message, const TouchSample& sample);
  /// The case of a law that was sent before its contact had ended, once: after the whole contact
  /// has been identified.
  static std::optional<CorrectionCase> take_unfinished_law(RobotObject& object,
                                                           const SiteComparison& seen);
  /// The parts of a correction that have to be tried.
  [[nodiscard]] CorrectionProposal propose(const CorrectionMessage& message, double gap) const;
  [[nodiscard]] TriedCorrection tried_pose(const CorrectionMessage& message) const;
  /// [m] Gap between the sites below which it says nothing while the object rests here.
  [[nodiscard]] double resting_noise(const RobotObject& object, const TouchSample& sample,
                                     const SiteComparison& seen) const;
  /// The last contacts, which must not be predicted worse with these parameters.
  [[nodiscard]] std::vector<TriedContact> tried_contacts(std::size_t index,
                                                         const ObjectParameters& parameters) const;
  /// Whether the contact of an object that the tool is kept off was identified.
  [[nodiscard]] static bool is_release_due(const RobotObject& object, double t);
  void send_release(std::size_t index, double t);
  void send_full_state(std::size_t index, const TouchSample& sample, const PlanarPose& predicted,
                       const SiteComparison& seen);
  void update_from_camera(double t);
  [[nodiscard]] bool is_next(const char* what, double t, bool is_finite,
                             std::optional<double>& last);
  void note_once(const std::string& text);
  void note_failure(const char* task, const Error& error);

  TeleopOptions options_;
  Background background_;
  std::vector<TeleopObject> world_;  ///< without tracking; the objects refer to it
  TipStream tip_;
  ForceStream force_;
  InputWatch watch_;
  CorrectionTrial trial_;
  SensorProperties sensors_;
  std::vector<RobotObject> objects_;
  std::vector<ForceRow> forces_;
  std::vector<std::string> notes_;
  std::vector<std::string> failures_;
  std::vector<CorrectionMessage> outgoing_;
  std::optional<double> force_fault_since_ = {};             ///< [s]
  std::optional<double> last_tool_ = {}, last_wrench_ = {};  ///< [s] stamps as they came
  std::vector<std::optional<double>> last_tracked_;          ///< [s] by object
  std::vector<PoseOutlierFilter> tracked_outliers_;          ///< by object
  double force_seen_;                                        ///< [s] when a force last arrived
  bool has_new_force_ = false;
  bool has_new_contact_ = false;  ///< since the inputs were examined
  double free_since_;             ///< [s] no object is touched
  double processed_;              ///< [s] comparisons are later than this
  double next_camera_update_;
  Eigen::Vector3d bias_base_ = Eigen::Vector3d::Zero();
  double bias_since_ = 0.0;
  std::size_t far_samples_ = 0;
  bool has_far_force_ = false;  ///< noted
  double now_ = 0.0;
  double start_;
  double round_trip_;  ///< [s]
  std::size_t sent_bytes_ = 0;
  std::size_t streaming_bytes_ = 0;
  /// A trial of one object at a time: trials share a world. Last: its thread uses that.
  std::optional<PendingTrial> pending_trial_ = {};
};

}  // namespace pcavr
