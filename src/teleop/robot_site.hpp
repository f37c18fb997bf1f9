// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/inputs/input_findings.hpp"
#include "pcavr/inputs/tip_path.hpp"
#include "pcavr/inputs/touch.hpp"
#include "pcavr/teleop/run_teleop.hpp"

#include "teleop/operator_site.hpp"
#include "teleop/recorded_signals.hpp"
#include "teleop/robot_object.hpp"

namespace pcavr {

/// The operator site's recent predictions by time and object, as received with its commands.
class PredictionLog {
 public:
  PredictionLog(double start, double step, std::size_t objects)
      : start_(start), step_(step), objects_(objects) {}
  void append(const Prediction& prediction) { rows_.push_back(prediction); }
  /// The prediction of the cycle that ended nearest to `t`; the first or last one outside. Throws
  /// ContractError if it was discarded.
  [[nodiscard]] const Prediction& at(double t, std::size_t object) const;
  /// Predictions for times before `t` will not be requested again.
  void discard_before(double t);

 private:
  double start_;
  double step_;
  std::size_t objects_;
  std::size_t discarded_ = 0;     ///< cycles
  std::vector<Prediction> rows_;  ///< by cycle, then by object
  [[nodiscard]] std::size_t cycle_at(double t) const;
};

/// The robot's site: measures force, tip and tracking, identifies parameters online, compares with
/// the operator site's predictions for the same times, and sends corrections.
class RobotSite {
 public:
  /// Keeps references to the arguments, which must outlive it.
  RobotSite(const TeleopInput& input, const TeleopOptions& options, const TipPath& tip,
            ForceSignal& force, const InputFindings& findings,
            const std::vector<BodyPhysics>& physics, double start);

  /// Processes all data available at `now` [s]; `log` covers it. Returns the corrections to send.
  [[nodiscard]] std::vector<CorrectionMessage> advance(double now, const PredictionLog& log);

  /// For an operator's site that begins anew: pose and all parameters of every movable object, as
  /// corrections at `t` [s].
  [[nodiscard]] std::vector<CorrectionMessage> full_state(double t);

  [[nodiscard]] const std::vector<RobotObject>& objects() const { return objects_; }
  /// The rows since the last call.
  [[nodiscard]] std::vector<ForceRow> take_forces() { return std::exchange(forces_, {}); }
  /// No prediction before this time will be requested from the log again [s].
  [[nodiscard]] double oldest_needed() const;
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  void note_bytes(std::size_t sent) { sent_bytes_ += sent; }
  [[nodiscard]] std::size_t streaming_bytes() const { return streaming_bytes_; }

 private:
  void process_sample(std::size_t index, const PredictionLog& log);
  void process_time(const TouchSample& sample, const PredictionLog& log);
  [[nodiscard]] std::optional<TouchedBody> attribute(const TouchSample& sample,
                                                     std::vector<Touch>& touches) const;
  void estimate_bias(const TouchSample& sample, const std::vector<Touch>& touches);
  void update_tracking(double t);
  void acknowledge(RobotObject& object, const Prediction& prediction);
  void check_static_limit(RobotObject& object, const TouchSample& sample);
  void plan_learning(RobotObject& object, MotionPhase before, bool was_touched, double t);
  void learn(RobotObject& object, double t);
  void record_force(const TouchSample& sample, const Eigen::Vector3d& clean_base,
                    const PredictionLog& log);
  void compare(std::size_t index, const TouchSample& sample, const Prediction& prediction);
  [[nodiscard]] std::optional<CorrectionMessage> compose(std::size_t index, CorrectionCase which,
                                                         const TouchSample& sample,
                                                         const PlanarPose& predicted, double gap,
                                                         const SiteComparison& seen);
  void update_from_camera(double t);
  void note_once(const std::string& text);

  const TeleopInput& input_;
  const TeleopOptions& options_;
  const TipPath& tip_;
  ForceSignal& force_;
  bool has_force_;
  SensorProperties sensors_;
  std::vector<RobotObject> objects_;
  std::vector<ForceRow> forces_;
  std::vector<std::string> notes_;
  std::vector<CorrectionMessage> outgoing_;
  std::size_t next_sample_ = 0;
  double next_camera_update_ = 0.0;
  Eigen::Vector3d bias_base_ = Eigen::Vector3d::Zero();
  double bias_since_ = 0.0;
  std::size_t far_samples_ = 0;
  double now_ = 0.0;
  double start_;
  std::size_t sent_bytes_ = 0;
  std::size_t streaming_bytes_ = 0;
  std::vector<std::size_t> streamed_frames_;
};

}  // namespace pcavr
