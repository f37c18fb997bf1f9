// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"
#include "pcavr/teleoperation/link/link_conditions.hpp"

#include "teleoperation/teleop/command_path.hpp"
#include "teleoperation/teleop/operator_site.hpp"
#include "teleoperation/teleop/parameter_history.hpp"
#include "teleoperation/teleop/recording_feed.hpp"
#include "teleoperation/teleop/robot_site.hpp"
#include "teleoperation/teleop/sent_parameters.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxObjects = 255;     // a message has one byte for its object's index
constexpr double kMinHeld = 0.05;            // [s] shorter contacts with the scan are not noted
constexpr double kHistoryInterval = 0.1;     // [s] between two looks at the parameters
constexpr double kMinTrackingGap = 0.2;      // [s] without a frame of an object, that is noted
constexpr double kTimeTolerance = 5e-7;      // [s] half the last digit in files
constexpr double kMinPhaseDuration = 0.008;  // [s] of the file format

void require_valid(const TeleopInput& input, const TeleopOptions& options) {
  PCAVR_REQUIRE(input.t_tool.size() == input.p_base_tip.size());
  PCAVR_REQUIRE(input.t_force.size() == input.force_base.size());
  PCAVR_REQUIRE(input.tool_radius > 0.0, input.tool_radius);
  PCAVR_REQUIRE(options.forward_delay >= 0.0, options.forward_delay);
  PCAVR_REQUIRE(options.backward_delay >= 0.0, options.backward_delay);
  const CorrectionSwitchOptions& correction = options.correction_switch;
  PCAVR_REQUIRE(correction.force_tolerance > 0.0, correction.force_tolerance);
  PCAVR_REQUIRE(correction.position_tolerance > 0.0, correction.position_tolerance);
}

Error too_many_objects(std::size_t count) {
  return {.message = std::to_string(count) + " movable objects exceed the limit of " +
                     std::to_string(kMaxObjects),
          .file = "scene.yaml",
          .place = "objects",
          .hint = "split the scene, or set movable: false for objects that do not move"};
}

/// Notes on what the inputs have shown, beyond those of the robot's site on the way.
std::vector<std::string> input_notes(const TeleopInput& input, const RobotSite& robot,
                                     const InputFindings& findings) {
  std::vector<std::string> notes = findings.notes;
  if (input.t_force.empty()) {
    notes.emplace_back(
        "no wrench was recorded: contact and sliding are detected by the camera alone, and "
        "nothing is identified");
  } else if (findings.fault && !robot.has_force_fault()) {
    notes.push_back("the force is not used from the end on, too late: " +
                    findings.fault->error.message + "; " + findings.fault->error.hint);
  } else if (findings.no_contact) {
    notes.push_back(findings.no_contact->message);
  }
  return notes;
}

struct Span {
  double start = 0.0;
  std::size_t cycles = 0;
};

Span span_of(const TipPath& tip, double step) {
  // A stamp's rounding must not drop the last cycle: far from zero it is some 1e-6 of one.
  constexpr double kRounding = 1e-5;
  const double cycles = (tip.t.back() - tip.t.front()) / step;
  return {tip.t.front(), static_cast<std::size_t>(std::floor(cycles + kRounding))};
}

/// Phase changes of one object at the operator's site.
using Changes = std::vector<MonitoredPhase>;

/// Records the operator site's result of one cycle, which ended at `t`; the first one also gives
/// the phases at the start.
Expected<void> show(const OperatorSite& site, const Span& span, double t, const TeleopSink& sink,
                    std::vector<Changes>& phases, PredictionLog& log) {
  for (std::size_t i = 0; i < phases.size(); ++i) {
    const Prediction prediction = site.prediction(i);
    log.append(prediction);
    if (phases[i].empty()) {
      phases[i].push_back({span.start, prediction.phase});
    } else if (phases[i].back().phase != prediction.phase) {
      phases[i].push_back({t, prediction.phase});
    }
    const Expected<void> stored = sink.take_shown(i, {site.now(), site.shown(i).T_base_object});
    if (!stored) return stored;
  }
  return {};
}

/// A command in flight to the robot's site.
struct Command {
  double arrival = 0.0;  ///< [s]
  double t = 0.0;        ///< [s] of its execution
};

/// Removes the commands that have arrived by `now`, or all, and returns the newest one's time.
std::optional<double> newest_by(double now, bool all, std::deque<Command>& in_flight) {
  std::optional<double> newest;
  while (!in_flight.empty() && (all || in_flight.front().arrival <= now)) {
    newest = in_flight.front().t;
    in_flight.pop_front();
  }
  return newest;
}

Expected<void> send(const CorrectionMessage& message, double now, double epoch,
                    LinkConditions& link, OperatorSite& site, RobotSite& robot,
                    const TeleopSink& sink, ParameterHistory& history, TeleopRun& run) {
  // A correction for a time before the simulation applies from its start.
  CorrectionMessage sendable = message;
  sendable.t = std::max(message.t, epoch);
  std::vector<std::uint8_t> bytes = encode(sendable, epoch);
  SentCorrection sent;
  sent.t = sendable.t;
  sent.object = message.object;
  sent.which = message.which;
  sent.what = describe(message);
  sent.bytes = bytes.size();
  run.correction_bytes += bytes.size();
  robot.note_bytes(bytes.size());
  const LinkConditions::Arrivals arrivals = link.arrivals(now, bytes.size());
  sent.is_lost = !arrivals.first;
  if (arrivals.first) history.send(*arrivals.first, message.object, message.parameters);
  if (arrivals.second) site.enqueue(*arrivals.second, bytes);
  if (arrivals.first) site.enqueue(*arrivals.first, std::move(bytes));
  ++run.sent_corrections;
  return sink.take_correction(sent);
}

/// Merges phases shorter than 8 ms into the one before, as the file format requires; the first into
/// the one after.
Changes merged(const Changes& changes) {
  Changes result;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const bool is_short =
        i + 1 < changes.size() && changes[i + 1].t - changes[i].t < kMinPhaseDuration;
    if (is_short) continue;
    if (result.empty() || result.back().phase != changes[i].phase) result.push_back(changes[i]);
  }
  if (!result.empty()) result.front().t = changes.front().t;
  return result;
}

/// Both sites' phases merged into rows with both.
std::vector<PhaseRow> phase_rows(std::size_t object, const Changes& measured,
                                 const Changes& predicted) {
  std::vector<PhaseRow> rows;
  std::size_t m = 0, p = 0;
  PhaseRow row{predicted.front().t, object, measured.front().phase, predicted.front().phase};
  while (true) {
    rows.push_back(row);
    const bool has_m = m + 1 < measured.size();
    const bool has_p = p + 1 < predicted.size();
    if (!has_m && !has_p) return rows;
    const double next_m = has_m ? measured[m + 1].t : predicted[p + 1].t;
    const double next_p = has_p ? predicted[p + 1].t : measured[m + 1].t;
    row.t = std::min(next_m, next_p);
    if (has_m && next_m < row.t + kTimeTolerance) row.measured = measured[++m].phase;
    if (has_p && next_p < row.t + kTimeTolerance) row.predicted = predicted[++p].phase;
  }
}

/// Notes the times without tracking of an object, and the uncertainty of the prediction after them.
void note_gaps(const TeleopObject& object, double drift, TeleopRun& run) {
  for (std::size_t i = 1; i < object.tracked.size(); ++i) {
    const TrackedPose& before = object.tracked[i - 1];
    const TrackedPose& after = object.tracked[i];
    if (after.t - before.t < kMinTrackingGap) continue;
    const double distance = translation_distance(before.T_base_object, after.T_base_object);
    run.notes.push_back(fmt::format(
        "{} was not tracked from {:.2f} to {:.2f} s: predicted without corrections, with an "
        "uncertainty of up to {:.1f} mm",
        object.name, before.t, after.t, 1e3 * (before.position_std + drift * distance)));
  }
}

/// Notes where the predicted object could not follow the tip.
void note_held(const TeleopObject& object, const HeldTimes& held, TeleopRun& run) {
  if (held.blocked >= kMinHeld) {
    run.notes.push_back(fmt::format(
        "{} was pressed against the scan, which held it, for {:.2f} s from {:.2f} s on: its "
        "predicted force there is that of the contact with the scan",
        object.name, held.blocked, held.first_blocked));
  }
  if (held.saturated >= kMinHeld) {
    run.notes.push_back(fmt::format(
        "the predicted force on {} was at its maximum for {:.2f} s from {:.2f} s on: see "
        "prediction.world.max_contact_force",
        object.name, held.saturated, held.first_saturated));
  }
}

/// Notes that the tool's path is not known where it moved during gaps of its recording.
void note_unrecorded_moves(const std::vector<UnrecordedMove>& moves, TeleopRun& run) {
  if (moves.empty()) return;
  const UnrecordedMove& first = moves.front();
  run.notes.push_back(fmt::format(
      "the tool was not recorded while it moved by {:.0f} mm, from {:.2f} to {:.2f} s{}: taken to "
      "have gone over the objects",
      1e3 * (first.p_base_to - first.p_base_from).norm(), first.begin, first.end,
      moves.size() > 1 ? fmt::format(", and in {} more gaps", moves.size() - 1) : ""));
}

void note_unseen(const TeleopInput& input, const TeleopOptions& options, const RobotSite& robot,
                 TeleopRun& run) {
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const TeleopObject& object = input.objects[i];
    note_gaps(object, options.pose.untracked_drift, run);
    if (object.tracked.empty() && object.is_movable) {
      run.notes.push_back(object.name +
                          " was never tracked: its pose is that of the scene, updated "
                          "by contact only");
    }
    if (robot.objects()[i].monitor().changes().size() == 1) {
      run.notes.push_back(object.name +
                          " was never touched: none of its parameters could be identified");
    }
  }
}

void finish(const TeleopInput& input, const TeleopOptions& options, const RobotSite& robot,
            const OperatorSite& site, const std::vector<Changes>& predicted, TeleopRun& run) {
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const std::vector<PhaseRow> rows =
        phase_rows(i, merged(robot.objects()[i].monitor().changes()), merged(predicted[i]));
    run.phases.insert(run.phases.end(), rows.begin(), rows.end());
    run.parameters.push_back(robot.objects()[i].knowledge().parameters());
    note_held(input.objects[i], site.held(i), run);
  }
  std::stable_sort(run.phases.begin(), run.phases.end(),
                   [](const PhaseRow& a, const PhaseRow& b) { return a.t < b.t; });
  if (site.late() > 0) {
    run.notes.push_back("corrections whose poses came too late for the prediction's history: " +
                        std::to_string(site.late()));
  }
  for (std::string& note : robot.notes()) run.notes.push_back(std::move(note));
  note_unseen(input, options, robot, run);
}

std::vector<ObjectParameters> all_sent_parameters(const std::vector<BodyPhysics>& physics,
                                                  double gravity) {
  std::vector<ObjectParameters> all;
  for (const BodyPhysics& one : physics) all.push_back(sent_parameters(one, gravity));
  return all;
}

/// Simulates both sites cycle by cycle.
class Session {
 public:
  Session(const TeleopInput& recorded, const TeleopOptions& options, CommandPath& command,
          const Span& span, OperatorSite& site, RobotSite& robot, const TeleopSink& sink,
          const std::vector<BodyPhysics>& physics)
      : options_(options),
        span_(span),
        site_(site),
        robot_(robot),
        sink_(sink),
        command_(command),
        random_(options.seed),
        backward_({.delay = options.backward_delay,
                   .jitter = options.jitter,
                   .loss = options.loss,
                   .burst = options.burst,
                   .reorder = options.reorder,
                   .duplicate = options.duplicate,
                   .rate_limit = options.rate_limit},
                  random_.fork(1)),
        forward_({.jitter = options.jitter}, random_.fork(2)),
        log_(span.start, options.predictor.step, recorded.objects.size()),
        history_(all_sent_parameters(physics, options.gravity())),
        feed_(recorded, options.pose.tracking_latency),
        predicted_(recorded.objects.size()) {}

  Expected<void> run(const Observer& observer, TeleopRun& run) {
    for (std::size_t k = 1; k <= span_.cycles; ++k) {
      const Expected<void> done = step(k, run);
      if (!done) return done;
      if (k % 1000 == 0) observer.on_progress("both sites", k / 1000, span_.cycles / 1000);
    }
    run.streaming_bytes = robot_.streaming_bytes();
    // Samples that were stamped after the tool's end show nothing but the state of the clocks.
    feed_.notify_change(std::numeric_limits<double>::infinity(), robot_);
    return {};
  }
  [[nodiscard]] const std::vector<Changes>& predicted() const { return predicted_; }

 private:
  Expected<void> step(std::size_t k, TeleopRun& run) {
    const double t = span_.start + options_.predictor.step * static_cast<double>(k);
    // The command for t was sent a forward delay ago; jitter delays it and those after it.
    const double wall = t - options_.forward_delay;
    site_.step(wall, command_.at(k), command_.acceleration_at(k));
    const Expected<void> shown = show(site_, span_, t, sink_, predicted_, log_);
    if (!shown) return shown;
    in_flight_.push_back({*forward_.arrival(t), t});
    const std::optional<double> received = newest_by(t, k == span_.cycles, in_flight_);
    if (!received) return {};
    feed_.notify_change(*received, robot_);
    for (const CorrectionMessage& message : robot_.advance(*received, log_)) {
      const Expected<void> sent =
          send(message, t, span_.start, backward_, site_, robot_, sink_, history_, run);
      if (!sent) return sent;
    }
    for (const ForceRow& row : robot_.take_forces()) {
      const Expected<void> stored = sink_.take_force(row);
      if (!stored) return stored;
    }
    log_.discard_before(robot_.oldest_needed());
    return write_parameters(t);
  }

  /// Every kHistoryInterval.
  Expected<void> write_parameters(double t) {
    if (!sink_.take_parameter || (last_history_ && t < *last_history_ + kHistoryInterval)) {
      return {};
    }
    last_history_ = t;
    for (std::size_t i = 0; i < robot_.objects().size(); ++i) {
      const BodyPhysics physics = robot_.objects()[i].physics();
      for (const ParameterRow& row :
           history_.advance(t, i, sent_parameters(physics, options_.gravity()))) {
        const Expected<void> stored = sink_.take_parameter(row);
        if (!stored) return stored;
      }
    }
    return {};
  }

  const TeleopOptions& options_;
  const Span& span_;
  OperatorSite& site_;
  RobotSite& robot_;
  const TeleopSink& sink_;
  CommandPath& command_;
  Random random_;
  LinkConditions backward_;
  LinkConditions forward_;
  PredictionLog log_;
  ParameterHistory history_;
  std::optional<double> last_history_ = {};  ///< [s]
  RecordingFeed feed_;
  std::deque<Command> in_flight_;
  std::vector<Changes> predicted_;
};

/// A sink that stores everything.
TeleopSink storing_sink(TeleopRun& stored) {
  return {.take_shown = [&stored](std::size_t object, const ShownPose& shown) -> Expected<void> {
            stored.shown[object].push_back(shown);
            return {};
          },
          .take_force = [&stored](const ForceRow& row) -> Expected<void> {
            stored.forces.push_back(row);
            return {};
          },
          .take_correction = [&stored](const SentCorrection& sent) -> Expected<void> {
            stored.corrections.push_back(sent);
            return {};
          },
          .take_parameter = [&stored](const ParameterRow& row) -> Expected<void> {
            stored.parameter_rows.push_back(row);
            return {};
          }};
}

}  // namespace

Expected<TeleopRun> run_teleop(const TeleopInput& input, const TeleopOptions& options,
                               const Observer& observer) {
  TeleopRun stored;
  stored.shown.resize(input.objects.size());
  Expected<TeleopRun> run = run_teleop(input, options, storing_sink(stored), observer);
  if (!run) return run;
  run->shown = std::move(stored.shown);
  run->forces = std::move(stored.forces);
  run->corrections = std::move(stored.corrections);
  run->parameter_rows = std::move(stored.parameter_rows);
  return run;
}

Expected<TeleopRun> run_teleop(const TeleopInput& recorded, const TeleopOptions& options,
                               const TeleopSink& sink, const Observer& observer) {
  require_valid(recorded, options);
  if (recorded.objects.size() > kMaxObjects) return too_many_objects(recorded.objects.size());
  TeleopRun run;
  run.shown.resize(recorded.objects.size());
  const TipPath tip = clean_tip_path(recorded.t_tool, recorded.p_base_tip, options.inputs);
  if (recorded.objects.empty() || tip.t.size() < 2 ||
      span_of(tip, options.predictor.step).cycles == 0) {
    run.notes.emplace_back("nothing was predicted: no object, or no tool motion");
    run.parameters.resize(recorded.objects.size());
    run.assumed.resize(recorded.objects.size());
    return run;
  }
  std::vector<BodyPhysics> physics;
  for (const TeleopObject& object : recorded.objects) {
    const auto complete = object.is_movable ? complete_physics : complete_immovable_physics;
    CompletedPhysics completed = complete(object.parameters, object.model, object.T_base_object,
                                          options.gravity(), options.unknown_objects);
    physics.push_back(completed.physics);
    run.assumed.push_back(std::move(completed.assumed));
  }
  const double step = options.predictor.step;
  const Span span = span_of(tip, step);
  CommandPath command(tip, height_over_objects(recorded), span.start, step);
  Expected<OperatorSite> site =
      OperatorSite::create(recorded, physics, options, span.start, command.at(0));
  if (!site) return site.error();
  RobotSite robot(recorded, options, physics, span.start);
  Session session(recorded, options, command, span, *site, robot, sink, physics);
  const Expected<void> done = session.run(observer, run);
  if (!done) return done.error();
  robot.apply_identifications();
  run.inputs = robot.findings();
  if (run.inputs.fault && !run.inputs.fault->is_of_force_only()) return run.inputs.fault->error;
  run.notes = input_notes(recorded, robot, run.inputs);
  note_unrecorded_moves(command.unrecorded_moves(), run);
  finish(recorded, options, robot, *site, session.predicted(), run);
  return run;
}

}  // namespace pcavr
