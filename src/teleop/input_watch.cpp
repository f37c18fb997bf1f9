// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/input_watch.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pcavr {
namespace {

/// [s] Without a contact, before the samples are examined for the first time.
constexpr double kFirstExamination = 5.0;
/// Examined again when the stored time has grown by this share, after a contact and without one:
/// the work grows with that time.
constexpr double kContactGrowth = 0.1;
constexpr double kTimeGrowth = 0.5;
/// [s] An offset that changes by less keeps its value: all stamps would change.
constexpr double kMinOffsetChange = 0.002;

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
                       const TeleopOptions& options, std::launch background)
    : prior_(options.sensors),
      background_(background),
      monitor_(bodies_of(objects), tool_radius, options.inputs),
      force_{options.sensors.force_offset},
      camera_{options.sensors.camera_offset} {}

void InputWatch::add(Waiting sample) {
  if (examination_) return waiting_.push_back(std::move(sample));
  sample(monitor_);
}

void InputWatch::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                          const std::optional<Eigen::Quaterniond>& q_base_tool) {
  // Orientations come with all samples or with none.
  if (!has_orientation_) has_orientation_ = q_base_tool.has_value();
  if (*has_orientation_ && !q_base_tool) return;
  first_ = std::min(first_, t);
  const std::optional<Eigen::Quaterniond> q = *has_orientation_ ? q_base_tool : std::nullopt;
  add([=](InputMonitor& monitor) { monitor.add_tool(t, p_base_tip, q); });
}

void InputWatch::add_force(double t, const Eigen::Vector3d& force_base) {
  add([=, this](InputMonitor& monitor) { monitor.add_force(t - prior_.force_offset, force_base); });
}

void InputWatch::add_tracked(std::size_t object, const TrackedPose& pose) {
  TrackedPose shifted = pose;
  shifted.t -= prior_.camera_offset;
  add([=](InputMonitor& monitor) { monitor.add_tracked(object, shifted); });
}

InputFindings InputWatch::findings() {
  if (examination_) static_cast<void>(take_examined());
  return monitor_.findings();
}

InputFindings InputWatch::take_examined() {
  InputFindings found = examination_->get();
  examination_.reset();
  for (const Waiting& sample : waiting_) sample(monitor_);
  waiting_.clear();
  return found;
}

bool InputWatch::examine(double t, bool has_new_contact) {
  const bool has_changed =
      examination_ && examination_->is_due(t) && apply_findings(take_examined(), t);
  const double since = t - examined_.value_or(first_);
  const double known = examined_ ? *examined_ - first_ : 0.0;
  const double due =
      has_new_contact ? kContactGrowth * known : std::max(kFirstExamination, kTimeGrowth * known);
  if (examination_ || !(since >= due)) return has_changed;
  examined_ = t;
  examination_.emplace(background_, t + kExaminationTime, [this] { return monitor_.findings(); });
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
