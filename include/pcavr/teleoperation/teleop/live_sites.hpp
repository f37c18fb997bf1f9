// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/tracked_pose.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

/// Both sites as the two programs run them: fed sample by sample, connected by messages. All times
/// are seconds of the scene: the shared clock less LinkWelcome::start. One thread at a time.
namespace pcavr {

/// A correction to be sent, with its description for the log.
struct LiveCorrection {
  SentCorrection sent;
  double due = 0.0;                 ///< [s] predictions for later times contain it
  std::vector<std::uint8_t> bytes;  ///< a CorrectionMessage with `sent.t` as its epoch
};

/// Decodes a correction's bytes for a log; nothing if they are not valid. `t` [s]: the time that it
/// corrects.
[[nodiscard]] std::optional<SentCorrection> decode_correction(std::span<const std::uint8_t> bytes,
                                                              double t);
/// Bytes for sending every wrench sample and every tracked pose, as in TeleopRun.
[[nodiscard]] std::size_t streaming_bytes_of(std::size_t wrench_samples, std::size_t tracked_poses);
/// The whole pose of a predicted object; `T_base_start` gives height and tilt.
[[nodiscard]] Pose predicted_pose(const LinkPrediction& prediction, const Pose& T_base_start);

/// The robot's site: what it measures and what the operator's site predicts, to corrections.
class LiveRobotSite {
 public:
  /// An Error if there are too many objects, or the inputs are not usable.
  [[nodiscard]] static Expected<LiveRobotSite> create(const TeleopInput& world,
                                                      const TeleopOptions& options, double start);
  LiveRobotSite(LiveRobotSite&&) noexcept;
  LiveRobotSite& operator=(LiveRobotSite&&) noexcept;
  ~LiveRobotSite();

  /// Samples that are added from now on have arrived at `now` [s].
  void set_arrival(double now);
  // Samples in any interleaving; each series ascends. Others are ignored and noted.
  void add_tool(double t, const Eigen::Vector3d& p_base_tip, const Eigen::Quaterniond& q_base_tool);
  void add_wrench(double t, const Eigen::Vector3d& force_base);
  void add_tracked(std::size_t object, const TrackedPose& pose);

  /// Adds what the operator's site has predicted for the time `t` at which its command is executed;
  /// by object. Predictions of another number of objects are ignored. Missing cycles count as the
  /// one before. `correction_delay` [s]: from the composition of a correction to the first
  /// prediction that contains it; 0: as the options expect.
  void add_predictions(double t, std::span<const LinkPrediction> predictions,
                       double correction_delay = 0.0);
  /// Processes, one of these times after the other, what had been measured up to it. `now` [s]: no
  /// prediction for a time long before it will come.
  [[nodiscard]] std::vector<LiveCorrection> advance(double now);
  /// Whether advance() waits for what a thread identifies or tries, as by default. Else it leaves
  /// the times from then on to its next calls, for ten seconds at most, and processes a few at a
  /// time: the corrections are the same, and a control loop goes on.
  void set_waiting(bool is_waiting);
  /// Times that were left to the next calls.
  [[nodiscard]] std::size_t backlog() const;
  /// Called in place of advance() without an operator's site: forgets what is older than needed.
  void idle(double now);
  /// Called after an interruption: what was sent may be lost, and nothing before `now` [s] is
  /// compared. The next predictions begin a new series.
  void restart(double now);

  [[nodiscard]] MotionPhase phase(std::size_t object) const;
  struct PhaseChange {
    double t = 0.0;  ///< [s] when it happened, which is before it was detected
    std::size_t object = 0;
    MotionPhase phase = MotionPhase::free;
  };
  /// The changes that are older than `age` [s] and were not taken before. Samples that come later
  /// revise the newest ones.
  [[nodiscard]] std::vector<PhaseChange> take_phase_changes(double age);
  [[nodiscard]] std::size_t objects() const;
  [[nodiscard]] std::size_t streaming_bytes() const;  ///< as in TeleopRun
  [[nodiscard]] std::vector<std::string> notes() const;
  /// Computations beside the cycles that failed since the last call, a line for each: what was
  /// known before is kept.
  [[nodiscard]] std::vector<std::string> take_failures();

 private:
  struct State;
  explicit LiveRobotSite(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The operator's site: the predicted world, with the corrections of the robot's site.
class LiveOperatorSite {
 public:
  /// The world at `start` [s], with the tip at `p_base_tip`. An Error if an object can't be made a
  /// body. `options.forward_delay` and `backward_delay` are the history that corrections need.
  [[nodiscard]] static Expected<LiveOperatorSite> create(const TeleopInput& world,
                                                         const TeleopOptions& options, double start,
                                                         const Eigen::Vector3d& p_base_tip);
  LiveOperatorSite(LiveOperatorSite&&) noexcept;
  LiveOperatorSite& operator=(LiveOperatorSite&&) noexcept;
  ~LiveOperatorSite();

  /// Applies a correction at its time `t` [s]. False if its bytes are not a correction of an object
  /// of this world.
  bool apply(double t, std::span<const std::uint8_t> bytes);
  /// One cycle of options.predictor.step.
  void step(const Eigen::Vector3d& p_base_tip,
            const Eigen::Vector3d& a_base_tip = Eigen::Vector3d::Zero());

  /// [m] Tool less command: the tip of step() is the command, and the robot is to be sent both
  /// together. It is that of case 1.2b, see `retraction_speed`; `options.retraction_speed` 0: none.
  [[nodiscard]] const Eigen::Vector3d& tool_offset() const;
  /// The object that the tool is being moved out of.
  [[nodiscard]] std::optional<std::size_t> retracts_from() const;
  /// Sets the response that the robot's site has found, see LinkState.
  void set_tool_response(const TipResponse& response);
  /// Places an object at rest, for the start of a session; it stays upright on its support.
  void place(std::size_t object, const Pose& T_base_object);

  [[nodiscard]] double now() const;
  /// The predicted world, without the blending of shown().
  [[nodiscard]] const PredictedWorld& world() const;
  /// Gets the predictions by object, for now().
  void get_predictions(std::vector<LinkPrediction>& predictions) const;
  [[nodiscard]] ShownBody shown(std::size_t object) const;
  [[nodiscard]] std::size_t objects() const;
  /// Corrections that came too late for the history: only their parameters are used.
  [[nodiscard]] std::size_t late() const;

 private:
  struct State;
  explicit LiveOperatorSite(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A recorded motion as the operator's command, smoothed as in run_teleop.
class RecordedCommand {
 public:
  /// Keeps a reference to the input's series. An Error if the motion has fewer than two samples.
  [[nodiscard]] static Expected<RecordedCommand> create(const TeleopInput& input,
                                                        const TeleopOptions& options);
  RecordedCommand(RecordedCommand&&) noexcept;
  RecordedCommand& operator=(RecordedCommand&&) noexcept;
  ~RecordedCommand();

  [[nodiscard]] double start() const;        ///< [s]
  [[nodiscard]] std::size_t cycles() const;  ///< of options.predictor.step
  /// At start() + step * cycle, constant after the end. Cheapest in ascending order.
  [[nodiscard]] Eigen::Vector3d p_base_tip(std::size_t cycle);
  [[nodiscard]] Eigen::Vector3d a_base_tip(std::size_t cycle);  ///< [m/s^2]

 private:
  struct State;
  explicit RecordedCommand(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
