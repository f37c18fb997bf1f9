// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/accumulated.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "physics/inputs/clock_shift.hpp"
#include "physics/inputs/force_turn.hpp"

namespace pcavr {
namespace {

/// Newest contacts, and pushes of a body, that are stored.
constexpr std::size_t kMaxStored = 256;

template <typename Value>
void append_newest(const std::vector<Value>& added, std::vector<Value>& stored) {
  stored.insert(stored.end(), added.begin(), added.end());
  if (stored.size() <= kMaxStored) return;
  stored.erase(stored.begin(), stored.end() - static_cast<std::ptrdiff_t>(kMaxStored));
}

void merge(const Approach& added, Approach& stored) {
  if (added.gap < stored.gap) stored.gap = added.gap, stored.t = added.t;
  stored.max_gap = std::max(stored.max_gap, added.max_gap);
  stored.moved = std::max(stored.moved, added.moved);
  stored.max_force = std::max(stored.max_force, added.max_force);
}

std::string times(std::size_t count) {
  return std::to_string(count) + (count == 1 ? " time" : " times");
}

}  // namespace

AccumulatedFindings::AccumulatedFindings(std::vector<InputBody> bodies)
    : bodies_(std::move(bodies)), friction_(bodies_.size()), approaches_(bodies_.size()) {
  for (InputBody& body : bodies_) body.tracked = {};
}

void AccumulatedFindings::add(const WindowFindings& window) {
  counts_.tool_to_force = window.tool_to_force;
  counts_.tool_to_camera = window.tool_to_camera;
  counts_.is_force_offset_applied = window.is_force_offset_applied;
  counts_.is_camera_offset_applied = window.is_camera_offset_applied;
  force_filter_ = window.force_filter;
  has_unknown_filter_ = window.has_unknown_filter && !force_filter_;
  force_drift_ = window.force_drift;
  if (counts_.tool_outliers == 0) first_outlier_ = window.first_outlier;
  if (counts_.tool_jumps == 0 && !window.jumps.empty()) first_jump_ = window.jumps.front();
  counts_.tool_outliers += window.tool_outliers;
  counts_.tool_jumps += window.jumps.size();
  if (counts_.saturations == 0 && !window.saturated.empty()) {
    counts_.first_saturation = window.saturated.front().begin;
  }
  counts_.saturations += window.saturated.size();
  for (const SaturatedInterval& interval : window.saturated) {
    counts_.force_ceiling =
        std::min(counts_.force_ceiling.value_or(interval.force), interval.force);
  }
  counts_.force_spikes += window.force_spikes;
  counts_.force_noise = std::max(counts_.force_noise, window.force_noise);
  counts_.max_drift = std::max(counts_.max_drift, window.max_drift);
  free_force_ = std::max(free_force_, window.free_force);
  counts_.contacts += window.contacts.size();
  append_newest(window.evidence, evidence_);
  touches_.add(window.touches);
  placement_.add(window.placement);
  if (window.clock_fault && !is_clock_sound_ && !clock_fault_) clock_fault_ = window.clock_fault;
  is_clock_sound_ |= !window.clock_fault && !window.evidence.empty();
  for (std::size_t i = 0; i < window.friction.size(); ++i) {
    append_newest(window.friction[i].ratios, friction_[i].ratios);
    friction_[i].is_weighed = window.friction[i].is_weighed;
  }
  for (std::size_t i = 0; i < window.approaches.size(); ++i) {
    merge(window.approaches[i], approaches_[i]);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].T_base_object = window.T_base_objects_end[i];
  }
}

WindowPrior AccumulatedFindings::prior() const {
  return {counts_.tool_to_force, counts_.tool_to_camera, counts_.contacts > 0, force_filter_,
          force_drift_};
}

std::optional<InputFault> AccumulatedFindings::find_fault(
    const std::optional<NoContact>& none) const {
  if (none && none->is_unit_fault) return InputFault{InputFaultKind::force_unit, none->error};
  if (auto fault = tool_unit_fault(touches_)) return fault;
  // The clock is checked before the axes: with an offset of seconds, a push may be compared with
  // another one's face.
  if (clock_fault_) return clock_fault_;
  if (force_drift_) {
    if (auto fault = drift_fault(*force_drift_)) return fault;
  }
  if (auto fault = placement_fault(bodies_, placement_)) return fault;
  if (auto fault = axes_fault(evidence_)) return fault;
  for (std::size_t i = 0; i < friction_.size(); ++i) {
    if (auto fault = force_unit_fault(bodies_[i].name, friction_[i])) return fault;
  }
  return std::nullopt;
}

std::vector<std::string> AccumulatedFindings::notes() const {
  std::vector<std::string> notes;
  if (counts_.tool_outliers > 0) {
    notes.push_back(fmt::format(
        "the tool's pose jumps and returns ({} sample{}, first at {}): ignored",
        counts_.tool_outliers, counts_.tool_outliers == 1 ? "" : "s", at_time(first_outlier_)));
  }
  if (counts_.tool_jumps > 0) {
    notes.push_back("the tool's pose jumps " + times(counts_.tool_jumps) + ", first at " +
                    at_time(first_jump_) + ": contacts at that time are not used");
  }
  if (force_filter_) {
    notes.push_back(fmt::format(
        "the force went through {}, as its noise without contact shows, and is {:.1f} +- {:.1f} ms "
        "late by it: the filter is undone here, but not in the file",
        kind_of(*force_filter_), 1e3 * force_filter_->delay, 1e3 * force_filter_->std));
  }
  if (has_unknown_filter_) {
    notes.push_back(
        "the force's noise without contact is correlated from sample to sample, as behind a "
        "filter, but of no kind that is known here: what it delays and smooths is not taken off; "
        "record the force unfiltered");
  }
  if (counts_.saturations > 0) {
    notes.push_back(fmt::format(
        "force sensor saturated {} at {:.1f} N, first at {}: contacts at that time are not used to "
        "identify",
        times(counts_.saturations), *counts_.force_ceiling, at_time(counts_.first_saturation)));
  }
  for (std::size_t i = 0; i < friction_.size(); ++i) {
    std::string note = doubtful_friction(bodies_[i].name, friction_[i]);
    if (!note.empty()) notes.push_back(std::move(note));
  }
  for (std::string& note : placement_notes(bodies_, placement_)) notes.push_back(std::move(note));
  return notes;
}

std::vector<std::string> AccumulatedFindings::warnings() const {
  std::vector<std::string> warnings;
  if (free_force_ > 0.0) {
    warnings.push_back(fmt::format(
        "the force is {:.1f} N where the tip is far from every object: taken off here, but not in "
        "the file; set the sensor to zero before recording, or import with --tare",
        free_force_));
  }
  if (force_drift_) {
    warnings.push_back(fmt::format(
        "the force's clock is {:.2g} +- {:.2g} % {} than the tool's, as their delay between the "
        "contacts shows: taken off here; which of them is right is not known, and speeds may be "
        "off by that",
        1e2 * std::abs(force_drift_->rate), 1e2 * force_drift_->rate_std,
        force_drift_->rate > 0.0 ? "faster" : "slower"));
  }
  for (std::string& warning : placement_contradictions(bodies_, placement_)) {
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

/// The force's offset without drift and filter becomes that of the force as measured.
void AccumulatedFindings::add_delay_as_measured(InputFindings& findings) const {
  if (!force_drift_ && !force_filter_) return;
  TimeOffset& offset = findings.tool_to_force;
  if (!findings.is_force_offset_applied) offset.offset = 0.0;
  if (force_drift_) offset.offset += force_drift_->offset;
  if (force_filter_) {
    offset.offset += force_filter_->delay;
    offset.std = std::hypot(offset.std, force_filter_->std);
  }
  offset.is_known = findings.is_force_offset_applied = true;
}

InputFindings AccumulatedFindings::conclude() const {
  InputFindings findings = counts_;
  add_delay_as_measured(findings);
  std::optional<NoContact> none;
  if (counts_.contacts == 0 && !bodies_.empty()) none = explain_no_contact(bodies_, approaches_);
  if (none) findings.no_contact = none->error;
  findings.fault = find_fault(none);
  findings.notes = notes();
  findings.warnings = warnings();
  TurnFinding turn = state_force_turn(evidence_);
  if (!turn.note.empty()) findings.warnings.push_back(std::move(turn.note));
  findings.suspected_turn = turn.noted_angle;
  findings.notes.insert(findings.notes.end(), findings.warnings.begin(), findings.warnings.end());
  return findings;
}

}  // namespace pcavr
