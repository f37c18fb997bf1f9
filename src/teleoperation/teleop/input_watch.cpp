// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/input_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/caught.hpp"

namespace pcavr {
namespace {

/// [s] Time without a contact before the samples are examined for the first time.
constexpr double kFirstExamination = 5.0;
/// Examined again when the stored time has grown by this share, after a contact and without one:
/// the work grows with that time.
constexpr double kContactGrowth = 0.1;
constexpr double kTimeGrowth = 0.5;
/// [s] An offset that changes by less keeps its value: all stamps would change.
constexpr double kMinOffsetChange = 0.002;
/// Samples that are stored at once: those of two seconds at 1 kHz, in 400 kB.
constexpr std::size_t kChunk = 4096;

std::vector<InputBody> bodies_of(const std::vector<TeleopObject>& objects) {
  std::vector<InputBody> bodies;
  for (const TeleopObject& object : objects) {
    InputBody& body = bodies.emplace_back(
        InputBody{object.name, &object.model, object.T_base_object, {}, {}, object.is_movable});
    if (object.is_movable && object.parameters.mass) body.mass = object.parameters.mass->value;
  }
  return bodies;
}

}  // namespace

InputWatch::InputWatch(const std::vector<TeleopObject>& objects, double tool_radius,
                       const TeleopOptions& options, Background background)
    : prior_(options.sensors),
      background_(std::move(background)),
      monitor_(bodies_of(objects), tool_radius, options.inputs),
      force_{options.sensors.force_offset},
      camera_{options.sensors.camera_offset} {}

void InputWatch::add(Sample sample) {
  if (waiting_.empty() || waiting_.back().size() == kChunk) {
    if (!waiting_.empty()) store();
    waiting_.emplace_back().reserve(kChunk);
  }
  waiting_.back().push_back(std::move(sample));
}

void InputWatch::store() {
  if (examination_) {
    if (examination_->would_wait(std::numeric_limits<double>::infinity())) return;
    static_cast<void>(examination_->get());  // of the samples up to it, also where it is deferred
  }
  auto add_after = [this, before = storage_, samples = std::move(waiting_)]() mutable {
    if (before.valid()) before.get();
    add_to_monitor(samples);
    before = {};  // or each would keep all before it, as long as it is kept itself
    samples = {};
  };
  storage_ = std::async(background_.policy, std::move(add_after)).share();
  // A deferred task is run at once: otherwise each would be run by the next.
  if (background_.policy == std::launch::deferred) storage_.wait();
  waiting_.clear();
}

void InputWatch::add_to_monitor(const Chunks& samples) {
  for (const std::vector<Sample>& chunk : samples) {
    for (const Sample& sample : chunk) {
      if (const auto* tool = std::get_if<ToolSample>(&sample)) {
        monitor_.add_tool(tool->t, tool->p_base_tip, tool->q_base_tool);
      } else if (const auto* force = std::get_if<ForceSample>(&sample)) {
        monitor_.add_force(force->t, force->force_base);
      } else if (const auto* tracked = std::get_if<TrackedSample>(&sample)) {
        monitor_.add_tracked(tracked->object, tracked->pose);
      }
    }
  }
}

void InputWatch::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                          const std::optional<Eigen::Quaterniond>& q_base_tool) {
  // Orientations come with all samples or with none.
  if (!has_orientation_) has_orientation_ = q_base_tool.has_value();
  if (*has_orientation_ && !q_base_tool) return;
  first_ = std::min(first_, t);
  const std::optional<Eigen::Quaterniond> q = *has_orientation_ ? q_base_tool : std::nullopt;
  add(ToolSample{t, p_base_tip, q});
}

void InputWatch::add_force(double t, const Eigen::Vector3d& force_base) {
  add(ForceSample{t - prior_.force_offset, force_base});
}

void InputWatch::add_tracked(std::size_t object, const TrackedPose& pose) {
  TrackedPose shifted = pose;
  shifted.t -= prior_.camera_offset;
  add(TrackedSample{object, shifted});
}

Expected<InputFindings> InputWatch::findings() {
  if (examination_) static_cast<void>(examination_->get());
  examination_.reset();
  store();
  return caught([this] {
    storage_.get();
    return monitor_.findings();
  });
}

bool InputWatch::examine(double t, bool has_new_contact) {
  bool has_changed = false;
  if (examination_ && examination_->is_due(t)) {
    const Expected<InputFindings>& found = examination_->get();
    if (found) {
      has_changed = apply_findings(*found, t);
    } else {
      failure_ = found.error();
    }
    examination_.reset();
  }
  const double since = t - examined_.value_or(first_);
  const double known = examined_ ? *examined_ - first_ : 0.0;
  const double due =
      has_new_contact ? kContactGrowth * known : std::max(kFirstExamination, kTimeGrowth * known);
  if (examination_ || !(since >= due)) return has_changed;
  examined_ = t;
  store();
  examination_.emplace(background_, kTask, t + kExaminationTime, [this, stored = storage_] {
    stored.get();
    return monitor_.findings();
  });
  return has_changed;
}

bool InputWatch::apply_findings(const InputFindings& found, double t) {
  // A fault of the tool or its clock ends a session: little data may look like one.
  const bool is_of_all = found.fault && !found.fault->is_of_force_only();
  if (is_of_all) return false;
  const bool had_fault = fault_.has_value();
  fault_ = found.fault;
  bool has_changed = had_fault != fault_.has_value();
  if (fault_) return has_changed;
  has_changed |= suspected_turn_ != found.suspected_turn;
  suspected_turn_ = found.suspected_turn;
  has_changed |=
      apply(found.tool_to_force, found.is_force_offset_applied, prior_.force_offset, t, force_);
  has_changed |=
      apply(found.tool_to_camera, found.is_camera_offset_applied, prior_.camera_offset, t, camera_);
  return has_changed;
}

bool InputWatch::apply(const TimeOffset& found, bool is_significant, double prior, double t,
                       AppliedOffset& applied) const {
  const double offset = is_significant ? prior + found.offset : prior;
  const double change = std::abs(offset - applied.offset);
  if (change < std::max(kMinOffsetChange, is_significant ? found.std : 0.0)) return false;
  applied.offset = offset;
  applied.std = found.std;
  if (!applied.since) applied.since = t;
  if (!is_significant) applied.since.reset();
  return true;
}

}  // namespace pcavr
