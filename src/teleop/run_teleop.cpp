// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleop/run_teleop.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <utility>

#include "pcavr/core/check.hpp"
#include "pcavr/core/random.hpp"
#include "pcavr/prediction/body_physics.hpp"

#include "teleop/input_checks.hpp"
#include "teleop/link.hpp"
#include "teleop/operator_site.hpp"
#include "teleop/recorded_signals.hpp"
#include "teleop/robot_site.hpp"

namespace pcavr {
namespace {

constexpr double kStep = 0.001;  // [s] the operator's cycle
// An offset between clocks is taken off where it is beyond doubt and matters.
constexpr double kOffsetSigmas = 3.0;
constexpr double kLongGap = 0.2;         // [s] without a frame of an object
constexpr double kSameInstant = 5e-7;    // [s] half the last digit that is written
constexpr double kShortest = 0.008;      // [s] of a phase
constexpr double kForceOffset = 0.005;   // [s]
constexpr double kCameraOffset = 0.020;  // [s]

void require_sound(const TeleopInput& input, const TeleopOptions& options) {
  PCAVR_REQUIRE(input.t_tool.size() == input.p_base_tip.size());
  PCAVR_REQUIRE(input.t_force.size() == input.force_base.size());
  PCAVR_REQUIRE(input.tool_radius > 0.0, input.tool_radius);
  PCAVR_REQUIRE(input.objects.size() < 256, input.objects.size());
  PCAVR_REQUIRE(options.forward_delay >= 0.0, options.forward_delay);
  PCAVR_REQUIRE(options.backward_delay >= 0.0, options.backward_delay);
  PCAVR_REQUIRE(options.force_tolerance > 0.0, options.force_tolerance);
  PCAVR_REQUIRE(options.position_tolerance > 0.0, options.position_tolerance);
}

bool matters(const std::optional<TimeOffset>& offset, double least) {
  return offset && std::abs(offset->offset) > std::max(kOffsetSigmas * offset->deviation, least);
}

std::string late(const char* what, const TimeOffset& offset) {
  char text[128];
  std::snprintf(text, sizeof text, "%s comes %.0f +- %.0f ms late by its stamps: taken off", what,
                1e3 * offset.offset, 1e3 * offset.deviation);
  return text;
}

/// The input with the clocks' offsets taken off; the tool's clock counts.
TeleopInput on_one_clock(const TeleopInput& input, const InputFindings& findings,
                         std::vector<std::string>& notes) {
  TeleopInput result = input;
  if (!matters(findings.tool_to_camera, kCameraOffset)) return result;
  for (TeleopObject& object : result.objects) {
    for (TrackedPose& pose : object.tracked) pose.t -= findings.tool_to_camera->offset;
  }
  notes.push_back(late("tracking", *findings.tool_to_camera));
  return result;
}

struct Span {
  double start = 0.0;
  std::size_t cycles = 0;
};

Span span_of(const TipMotion& tip) {
  const double length = tip.t.back() - tip.t.front();
  return {tip.t.front(), static_cast<std::size_t>(std::floor(length / kStep))};
}

void show(const OperatorSite& site, std::size_t objects, TeleopRun& run, PredictionLog& log) {
  for (std::size_t i = 0; i < objects; ++i) {
    const Prediction prediction = site.prediction(i);
    log.append(prediction);
    run.shown[i].push_back({site.now(), site.shown(i).T_base_object});
  }
}

/// A command on its way to the robot's site, by the instant that it is for.
struct Command {
  double arrival = 0.0;  ///< [s]
  double t = 0.0;        ///< [s]
};

/// Takes what has come by `now`, or all of it, and returns the newest.
std::optional<double> newest_by(double now, bool all, std::deque<Command>& on_the_way) {
  std::optional<double> newest;
  while (!on_the_way.empty() && (all || on_the_way.front().arrival <= now)) {
    newest = on_the_way.front().t;
    on_the_way.pop_front();
  }
  return newest;
}

void send(const CorrectionMessage& message, double now, double epoch, Link& link,
          OperatorSite& site, RobotSite& robot, TeleopRun& run) {
  std::vector<std::uint8_t> bytes = encode(message, epoch);
  SentCorrection sent;
  sent.t = message.t;
  sent.object = message.object;
  sent.which = message.which;
  sent.what = describe(message);
  sent.bytes = bytes.size();
  run.correction_bytes += bytes.size();
  robot.note_bytes(bytes.size());
  const std::optional<double> arrival = link.arrival(now);
  sent.is_lost = !arrival;
  if (arrival) site.expect(*arrival, std::move(bytes));
  run.corrections.push_back(std::move(sent));
}

/// Without stretches shorter than 8 ms, which join what was before, as the format has it; the first
/// joins what comes after.
std::vector<MonitoredPhase> merged(const std::vector<MonitoredPhase>& changes) {
  std::vector<MonitoredPhase> result;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const bool is_short = i + 1 < changes.size() && changes[i + 1].t - changes[i].t < kShortest;
    if (is_short) continue;
    if (result.empty() || result.back().phase != changes[i].phase) result.push_back(changes[i]);
  }
  if (!result.empty()) result.front().t = changes.front().t;
  return result;
}

std::vector<MonitoredPhase> predicted_changes(std::size_t object, const PredictionLog& log,
                                              const Span& span) {
  std::vector<MonitoredPhase> changes;
  for (std::size_t k = 0; k <= span.cycles; ++k) {
    const double t = span.start + kStep * static_cast<double>(k);
    const MotionPhase phase = log.at(t, object).phase;
    if (changes.empty() || changes.back().phase != phase) changes.push_back({t, phase});
  }
  return merged(changes);
}

/// Both sites' phases merged into rows that each state both.
std::vector<PhaseRow> phase_rows(std::size_t object, const std::vector<MonitoredPhase>& measured,
                                 const std::vector<MonitoredPhase>& predicted) {
  std::vector<PhaseRow> rows;
  std::size_t m = 0, p = 0;
  PhaseRow row{predicted.front().t, object, measured.front().phase, predicted.front().phase};
  while (true) {
    rows.push_back(row);
    const double next_m = m + 1 < measured.size() ? measured[m + 1].t : 1e300;
    const double next_p = p + 1 < predicted.size() ? predicted[p + 1].t : 1e300;
    row.t = std::min(next_m, next_p);
    if (row.t == 1e300) return rows;
    if (next_m < row.t + kSameInstant) row.measured = measured[++m].phase;
    if (next_p < row.t + kSameInstant) row.predicted = predicted[++p].phase;
  }
}

/// Where the camera lost an object: what was shown then was prediction, and how far it may be off.
void note_gaps(const TeleopObject& object, TeleopRun& run) {
  for (std::size_t i = 1; i < object.tracked.size(); ++i) {
    const TrackedPose& before = object.tracked[i - 1];
    const TrackedPose& after = object.tracked[i];
    if (after.t - before.t < kLongGap) continue;
    const double way = translation_distance(before.T_base_object, after.T_base_object);
    char text[160];
    std::snprintf(
        text, sizeof text,
        " was not seen from %.2f to %.2f s: prediction went on alone, and its uncertainty "
        "grew to %.1f mm",
        before.t, after.t, 1e3 * (before.position_sigma + kUnseenShare * way));
    run.notes.push_back(object.name + text);
  }
}

void note_unseen(const TeleopInput& input, const RobotSite& robot, TeleopRun& run) {
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const TeleopObject& object = input.objects[i];
    note_gaps(object, run);
    if (object.tracked.empty()) {
      run.notes.push_back(object.name +
                          " was never tracked: its place is the scene's, carried on "
                          "by what was felt");
    }
    if (robot.objects()[i].monitor.changes().size() == 1) {
      run.notes.push_back(object.name + " was never touched: nothing could be learned of it");
    }
  }
}

void finish(const TeleopInput& input, const RobotSite& robot, const OperatorSite& site,
            const PredictionLog& log, const Span& span, TeleopRun& run) {
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const std::vector<PhaseRow> rows = phase_rows(i, merged(robot.objects()[i].monitor.changes()),
                                                  predicted_changes(i, log, span));
    run.phases.insert(run.phases.end(), rows.begin(), rows.end());
    run.parameters.push_back(robot.objects()[i].learner.known());
  }
  std::stable_sort(run.phases.begin(), run.phases.end(),
                   [](const PhaseRow& a, const PhaseRow& b) { return a.t < b.t; });
  run.forces = robot.forces();
  run.streaming_bytes = robot.streaming_bytes();
  if (site.late() > 0) {
    run.notes.push_back(
        "corrections that came too late, further back than the prediction remembers, and were left "
        "out: " +
        std::to_string(site.late()));
  }
  run.notes.insert(run.notes.end(), robot.notes().begin(), robot.notes().end());
  note_unseen(input, robot, run);
}

}  // namespace

Expected<TeleopRun> run_teleop(const TeleopInput& recorded, const TeleopOptions& options,
                               const Observer& observer) {
  require_sound(recorded, options);
  TeleopRun run;
  run.shown.resize(recorded.objects.size());
  const TipMotion tip = clean_tip(recorded);
  if (recorded.objects.empty() || tip.t.size() < 2 || span_of(tip).cycles == 0) {
    run.notes.emplace_back("nothing was predicted: no object to push, or no tool motion");
    run.parameters.resize(recorded.objects.size());
    run.assumed.resize(recorded.objects.size());
    return run;
  }
  const InputFindings findings = check_input(recorded, tip);
  run.notes = findings.notes;
  if (tip.jumps > 0) run.notes.push_back(describe_jumps(tip));
  run.tool_to_force = findings.tool_to_force;
  run.tool_to_camera = findings.tool_to_camera;
  const TeleopInput input = on_one_clock(recorded, findings, run.notes);
  const bool is_force_late = matters(findings.tool_to_force, kForceOffset);
  const double force_late = is_force_late ? findings.tool_to_force->offset : 0.0;
  if (is_force_late) run.notes.push_back(late("the force", *findings.tool_to_force));
  const ForceSignal force = smooth_force(input, tip, force_late);

  std::vector<BodyPhysics> physics;
  for (const TeleopObject& object : input.objects) {
    CompletedPhysics completed =
        complete_physics(object.parameters, object.model, object.T_base_object);
    physics.push_back(completed.physics);
    run.assumed.push_back(std::move(completed.assumed));
  }
  const Span span = span_of(tip);
  const std::vector<Eigen::Vector3d> command = command_of(tip, span.start, kStep, span.cycles + 1);
  const double round_trip = options.forward_delay + options.backward_delay;
  Expected<OperatorSite> made =
      OperatorSite::create(input, physics, round_trip, span.start, command.front());
  if (!made) return made.error();
  OperatorSite& site = *made;
  RobotSite robot(input, options, tip, force, findings, physics, span.start);
  const Random random(options.seed);
  Link backward({options.backward_delay, options.jitter, options.loss}, random.fork(1));
  Link forward({0.0, options.jitter, 0.0}, random.fork(2));
  PredictionLog log(span.start, kStep, input.objects.size());
  std::deque<Command> on_the_way;

  for (std::size_t k = 1; k <= span.cycles; ++k) {
    const double t = span.start + kStep * static_cast<double>(k);
    // The command for t was given a forward delay ago; jitter holds it, and those behind it, up.
    const double wall = t - options.forward_delay;
    site.step(wall, command[k]);
    show(site, input.objects.size(), run, log);
    on_the_way.push_back({*forward.arrival(t), t});
    const std::optional<double> heard = newest_by(t, k == span.cycles, on_the_way);
    if (!heard) continue;
    for (const CorrectionMessage& message : robot.advance(*heard, log)) {
      send(message, t, span.start, backward, site, robot, run);
    }
    if (k % 1000 == 0) observer.on_progress("both sites", k / 1000, span.cycles / 1000);
  }
  finish(input, robot, site, log, span, run);
  return run;
}

}  // namespace pcavr
