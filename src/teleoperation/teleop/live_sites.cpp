// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/live_sites.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

#include "teleoperation/teleop/command_path.hpp"
#include "teleoperation/teleop/message.hpp"
#include "teleoperation/teleop/operator_site.hpp"
#include "teleoperation/teleop/prediction_log.hpp"
#include "teleoperation/teleop/robot_site.hpp"
#include "teleoperation/teleop/sample_queue.hpp"
#include "teleoperation/teleop/tool_retraction.hpp"

namespace pcavr {
namespace {

std::vector<BodyPhysics> completed_bodies(const TeleopInput& world, const TeleopOptions& options) {
  std::vector<BodyPhysics> physics;
  for (const TeleopObject& object : world.objects) {
    const auto complete = object.is_movable ? complete_physics : complete_immovable_physics;
    physics.push_back(complete(object.parameters, object.model, object.T_base_object,
                               options.gravity(), options.unknown_objects)
                          .physics);
  }
  return physics;
}

Prediction prediction_of(const LinkPrediction& received) {
  return {{received.pose.x(), received.pose.y(), received.pose.z()},
          received.force.cast<double>(),
          received.rendered_force.cast<double>(),
          received.phase,
          received.received};
}

LinkPrediction link_prediction_of(const Prediction& prediction) {
  const PlanarPose& pose = prediction.pose;
  return {Eigen::Vector3d(pose.x, pose.y, pose.yaw).cast<float>(),
          prediction.force_base.cast<float>(), prediction.rendered_force_base.cast<float>(),
          prediction.phase, prediction.received};
}

}  // namespace

std::optional<SentCorrection> decode_correction(std::span<const std::uint8_t> bytes, double t) {
  const std::optional<CorrectionMessage> message = decode(bytes, t);
  if (!message) return std::nullopt;
  SentCorrection correction;
  correction.t = message->t;
  correction.object = message->object;
  correction.which = message->which;
  correction.what = describe(*message);
  correction.bytes = bytes.size();
  return correction;
}

std::size_t streaming_bytes_of(std::size_t wrench_samples, std::size_t tracked_poses) {
  return wrench_samples * bytes_of_wrench_sample() + tracked_poses * bytes_of_tracked_pose();
}

Pose predicted_pose(const LinkPrediction& prediction, const Pose& T_base_start) {
  return pose_at(prediction_of(prediction).pose, T_base_start);
}

struct LiveRobotSite::State {
  State(const TeleopInput& world, const TeleopOptions& options, double scene_start)
      : objects(world.objects.size()),
        step(options.predictor.step),
        start(scene_start),
        site(world, options, completed_bodies(world, options), scene_start,
             Background{std::launch::async}),
        samples(options.pose.tracking_latency),
        correction_delay(options.round_trip()),
        taken_phases(world.objects.size(), 0) {}

  /// Predictions for one time.
  struct Cycle {
    double t = 0.0;
    double correction_delay = 0.0;  ///< 0: not stated
    std::vector<LinkPrediction> predictions;
  };
  [[nodiscard]] double on_grid(double t) const;
  void record(const Cycle& cycle);
  void process(const Cycle& cycle, std::vector<LiveCorrection>& corrections);

  std::size_t objects;
  double step;   ///< [s]
  double start;  ///< [s]
  RobotSite site;
  SampleQueue samples;
  double correction_delay;                ///< [s]
  std::vector<std::size_t> taken_phases;  ///< by object
  double processed = 0.0;                 ///< [s] the newest cycle's time
  std::vector<Cycle> cycles;              ///< used again, so that no command allocates
  std::size_t waiting = 0;                ///< the first of them, not processed yet
  bool is_waiting = true;                 ///< for threads
  std::optional<PredictionLog> log;       ///< since the start, or the last interruption
  double log_start = 0.0;
  std::size_t logged = 0;          ///< cycles
  std::vector<Prediction> newest;  ///< by object; used again
};

/// The cycle's own time where `t` is a whole number of cycles from the start: what the shared
/// clock's rounding leaves of it must not move a sample to another cycle.
double LiveRobotSite::State::on_grid(double t) const {
  constexpr double kRounding = 1e-7;  // [s] of a clock of some days
  const double cycle = start + step * std::round((t - start) / step);
  return std::abs(cycle - t) < kRounding ? cycle : t;
}

void LiveRobotSite::State::record(const Cycle& cycle) {
  if (!log) {
    log_start = cycle.t - step;
    logged = 0;
    log.emplace(log_start, step, objects);
  }
  const auto last = static_cast<std::size_t>(std::round((cycle.t - log_start) / step));
  if (last <= logged) return;
  newest.clear();
  for (const LinkPrediction& prediction : cycle.predictions) {
    newest.push_back(prediction_of(prediction));
  }
  log->append_after(last - logged, newest);
  logged = last;
}

void LiveRobotSite::State::process(const Cycle& cycle, std::vector<LiveCorrection>& corrections) {
  record(cycle);
  if (cycle.correction_delay > 0.0 && cycle.correction_delay != correction_delay) {
    correction_delay = cycle.correction_delay;
    site.set_round_trip(correction_delay);
  }
  processed = cycle.t;
  samples.notify_change(cycle.t, site, log_start);
  for (const CorrectionMessage& message : site.advance(cycle.t, *log)) {
    LiveCorrection& correction = corrections.emplace_back();
    correction.due = cycle.t + cycle.correction_delay;
    correction.bytes = encode(message, message.t);
    correction.sent.t = message.t;
    correction.sent.object = message.object;
    correction.sent.which = message.which;
    correction.sent.what = describe(message);
    correction.sent.bytes = correction.bytes.size();
    site.note_bytes(correction.bytes.size());
  }
  static_cast<void>(site.take_forces());
  log->discard_before(site.oldest_needed());
}

LiveRobotSite::LiveRobotSite(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveRobotSite::LiveRobotSite(LiveRobotSite&&) noexcept = default;
LiveRobotSite& LiveRobotSite::operator=(LiveRobotSite&&) noexcept = default;
LiveRobotSite::~LiveRobotSite() = default;

Expected<LiveRobotSite> LiveRobotSite::create(const TeleopInput& world,
                                              const TeleopOptions& options, double start) {
  if (world.objects.size() > kMaxLinkObjects) {
    return Error{.message = std::to_string(world.objects.size()) + " objects exceed the limit of " +
                            std::to_string(kMaxLinkObjects),
                 .hint = "split the scene"};
  }
  return LiveRobotSite(std::make_unique<State>(world, options, start));
}

void LiveRobotSite::set_arrival(double now) { state_->samples.set_arrival(now); }

void LiveRobotSite::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                             const Eigen::Quaterniond& q_base_tool) {
  state_->samples.add_tool(t, p_base_tip, q_base_tool);
}

void LiveRobotSite::add_wrench(double t, const Eigen::Vector3d& force_base) {
  state_->samples.add_wrench(t, force_base);
}

void LiveRobotSite::add_tracked(std::size_t object, const TrackedPose& pose) {
  if (object < state_->objects) state_->samples.add_tracked(object, pose);
}

void LiveRobotSite::add_predictions(double t, std::span<const LinkPrediction> predictions,
                                    double correction_delay) {
  const std::size_t objects = state_->objects;
  if (predictions.size() != objects || objects == 0 || !std::isfinite(t)) return;
  const double step = state_->step;
  const double logged = state_->log_start + step * static_cast<double>(state_->logged);
  const std::size_t waiting = state_->waiting;
  const bool is_superseded = (state_->log && t < logged + 0.5 * step) ||
                             (waiting > 0 && t <= state_->cycles[waiting - 1].t);
  if (is_superseded) return;
  if (waiting == state_->cycles.size()) state_->cycles.emplace_back();
  State::Cycle& cycle = state_->cycles[state_->waiting++];
  cycle.t = state_->on_grid(t);
  cycle.correction_delay = correction_delay;
  cycle.predictions.assign(predictions.begin(), predictions.end());
}

std::vector<LiveCorrection> LiveRobotSite::advance(double now) {
  // [s] Older samples are not kept for predictions that may still come.
  constexpr double kMaxWait = 0.5;
  constexpr double kMaxBacklog = 10.0;  // [s]
  // In a call of a loop that does not wait: each takes some tens of microseconds, and a second of
  // them would stop that loop.
  constexpr std::size_t kMaxCycles = 8;
  std::vector<LiveCorrection> corrections;
  std::vector<State::Cycle>& cycles = state_->cycles;
  std::size_t done = 0;
  const std::size_t most = state_->is_waiting ? state_->waiting : kMaxCycles;
  for (; done < std::min(state_->waiting, most); ++done) {
    const double t = cycles[done].t;
    if (!state_->is_waiting && t > now - kMaxBacklog && state_->site.would_wait(t)) break;
    state_->process(cycles[done], corrections);
  }
  const auto begin = cycles.begin();
  std::rotate(begin, begin + static_cast<std::ptrdiff_t>(done),
              begin + static_cast<std::ptrdiff_t>(state_->waiting));
  state_->waiting -= done;
  if (state_->waiting == 0) state_->samples.notify_change(now - kMaxWait, state_->site);
  return corrections;
}

void LiveRobotSite::set_waiting(bool is_waiting) { state_->is_waiting = is_waiting; }

std::size_t LiveRobotSite::backlog() const { return state_->waiting; }

void LiveRobotSite::idle(double now) {
  state_->samples.notify_change(now, state_->site);
  state_->site.idle(now);
}

void LiveRobotSite::restart(double now) {
  state_->log.reset();
  state_->waiting = 0;
  state_->site.restart(now);
}

MotionPhase LiveRobotSite::phase(std::size_t object) const {
  return state_->site.objects()[object].monitor().phase();
}

std::vector<LiveRobotSite::PhaseChange> LiveRobotSite::take_phase_changes(double age) {
  std::vector<PhaseChange> taken;
  for (std::size_t i = 0; i < state_->objects; ++i) {
    const std::vector<MonitoredPhase>& changes = state_->site.objects()[i].monitor().changes();
    std::size_t& next = state_->taken_phases[i];
    for (; next < changes.size() && changes[next].t < state_->processed - age; ++next) {
      taken.push_back({changes[next].t, i, changes[next].phase});
    }
  }
  return taken;
}

std::size_t LiveRobotSite::objects() const { return state_->objects; }
std::size_t LiveRobotSite::streaming_bytes() const { return state_->site.streaming_bytes(); }
std::vector<std::string> LiveRobotSite::notes() const { return state_->site.notes(); }
std::vector<std::string> LiveRobotSite::take_failures() { return state_->site.take_failures(); }

struct LiveOperatorSite::State {
  [[nodiscard]] bool touches(std::size_t object) const {
    return site.world().state()[object].tool_force_base.squaredNorm() > 0.0;
  }

  void retract(const CorrectionMessage& message, bool was_touched) {
    const Eigen::Vector3d& displacement = *message.tool_retraction;
    if (message.which != CorrectionCase::phases_differ) {
      if (!was_touched) retraction.begin(message.object, displacement);
    } else if (displacement.isZero()) {
      retraction.release();
    } else {
      retraction.keep_off(message.object, displacement);
    }
  }

  OperatorSite site;
  std::size_t objects = 0;
  double step = 0.0;  ///< [s]
  ToolRetraction retraction;
};

LiveOperatorSite::LiveOperatorSite(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveOperatorSite::LiveOperatorSite(LiveOperatorSite&&) noexcept = default;
LiveOperatorSite& LiveOperatorSite::operator=(LiveOperatorSite&&) noexcept = default;
LiveOperatorSite::~LiveOperatorSite() = default;

Expected<LiveOperatorSite> LiveOperatorSite::create(const TeleopInput& world,
                                                    const TeleopOptions& options, double start,
                                                    const Eigen::Vector3d& p_base_tip) {
  Expected<OperatorSite> site =
      OperatorSite::create(world, completed_bodies(world, options), options, start, p_base_tip);
  if (!site) return site.error();
  return LiveOperatorSite(
      std::make_unique<State>(State{std::move(*site), world.objects.size(), options.predictor.step,
                                    ToolRetraction(options.retraction_speed)}));
}

bool LiveOperatorSite::apply(double t, std::span<const std::uint8_t> bytes) {
  const std::optional<CorrectionMessage> message = decode(bytes, t);
  if (!message || message->object >= state_->objects) return false;
  const bool was_touched = state_->touches(message->object);
  const bool is_applied = state_->site.apply(*message);
  if (is_applied && message->tool_retraction) state_->retract(*message, was_touched);
  return true;
}

void LiveOperatorSite::step(const Eigen::Vector3d& p_base_tip, const Eigen::Vector3d& a_base_tip) {
  ToolRetraction& retraction = state_->retraction;
  const std::optional<std::size_t> object = retraction.object();
  retraction.step(p_base_tip, object && state_->touches(*object), state_->step);
  state_->site.step(state_->site.now(), p_base_tip + retraction.offset(), a_base_tip);
}

const Eigen::Vector3d& LiveOperatorSite::tool_offset() const { return state_->retraction.offset(); }

std::optional<std::size_t> LiveOperatorSite::retracts_from() const {
  return state_->retraction.object();
}

void LiveOperatorSite::set_tool_response(const TipResponse& response) {
  state_->site.set_tool_response(response);
}

void LiveOperatorSite::place(std::size_t object, const Pose& T_base_object) {
  PCAVR_REQUIRE(object < state_->objects, object, state_->objects);
  state_->site.place(object, T_base_object);
}

const PredictedWorld& LiveOperatorSite::world() const { return state_->site.world(); }
double LiveOperatorSite::now() const { return state_->site.now(); }

void LiveOperatorSite::get_predictions(std::vector<LinkPrediction>& predictions) const {
  predictions.resize(state_->objects);
  for (std::size_t i = 0; i < state_->objects; ++i) {
    predictions[i] = link_prediction_of(state_->site.prediction(i));
  }
}

ShownBody LiveOperatorSite::shown(std::size_t object) const { return state_->site.shown(object); }
std::size_t LiveOperatorSite::objects() const { return state_->objects; }
std::size_t LiveOperatorSite::late() const { return state_->site.late(); }

struct RecordedCommand::State {
  TipPath tip;
  std::optional<CommandPath> path;
  double start = 0.0;
  std::size_t cycles = 0;
};

RecordedCommand::RecordedCommand(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordedCommand::RecordedCommand(RecordedCommand&&) noexcept = default;
RecordedCommand& RecordedCommand::operator=(RecordedCommand&&) noexcept = default;
RecordedCommand::~RecordedCommand() = default;

Expected<RecordedCommand> RecordedCommand::create(const TeleopInput& input,
                                                  const TeleopOptions& options) {
  auto state = std::make_unique<State>();
  state->tip = clean_tip_path(input.t_tool, input.p_base_tip, options.inputs);
  if (state->tip.t.size() < 2) {
    return Error{.message = "the motion has fewer than two samples", .file = "tool.csv"};
  }
  state->start = state->tip.t.front();
  state->cycles = static_cast<std::size_t>(
      std::floor((state->tip.t.back() - state->start) / options.predictor.step + 1e-5));
  state->path.emplace(state->tip, height_over_objects(input), state->start, options.predictor.step);
  return RecordedCommand(std::move(state));
}

double RecordedCommand::start() const { return state_->start; }
std::size_t RecordedCommand::cycles() const { return state_->cycles; }
Eigen::Vector3d RecordedCommand::p_base_tip(std::size_t cycle) {
  return state_->path->at(std::min(cycle, state_->cycles));
}
Eigen::Vector3d RecordedCommand::a_base_tip(std::size_t cycle) {
  if (cycle > state_->cycles) return Eigen::Vector3d::Zero();
  return state_->path->acceleration_at(cycle);
}

}  // namespace pcavr
