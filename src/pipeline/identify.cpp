// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <algorithm>
#include <cmath>

#include "pcavr/core/check.hpp"
#include "pcavr/recording/stream_clocks.hpp"

#include "identify_faults.hpp"
#include "identify_findings.hpp"
#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// An offset is applied where it exceeds this many stds ...
constexpr double kMinOffsetStds = 3.0;
constexpr double kMinOffset = 0.0005;  // [s] ... and a quarter of a sample interval
constexpr double kJumpMargin = 0.1;    // [s] around a jump, over which the smoothing spreads it

struct Prepared {
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<double> t_force;  ///< on the tool's clock
  Segmentation found;
  std::vector<BadInterval> bad;
};

void find_bad_intervals(const IdentificationInput& input, Prepared& prepared,
                        std::vector<std::string>& notes) {
  const std::vector<double> jumps = find_jumps(input.t_tool, prepared.p_base_tip);
  for (const double t : jumps) {
    prepared.bad.push_back({{t - kJumpMargin, t + kJumpMargin}, "the tool's pose jumps"});
  }
  if (!jumps.empty()) {
    notes.push_back("the tool's pose jumps " + std::to_string(jumps.size()) + " times, first at " +
                    at_time(jumps.front()));
  }
  const std::vector<SaturatedInterval> flat = find_saturation(prepared.t_force, input.force_base);
  for (const SaturatedInterval& stretch : flat) {
    prepared.bad.push_back({{stretch.begin, stretch.end}, "force sensor saturated"});
  }
  if (!flat.empty()) {
    notes.push_back("force sensor saturated " + std::to_string(flat.size()) + " times, first at " +
                    at_time(flat.front().begin) + ": those samples are not used");
  }
}

/// Segments the recording, on the tool's clock where the force sensor's clock has an offset.
Prepared prepare(const IdentificationInput& input, Identification& result) {
  Prepared prepared;
  prepared.p_base_tip = without_spikes(input.p_base_tip);
  prepared.t_force = input.t_force;
  const PathView tip(input.t_tool, prepared.p_base_tip);
  const auto segment = [&] {
    prepared.found =
        segment_contacts(prepared.t_force, input.force_base, input.t_tool, prepared.p_base_tip);
  };
  segment();
  result.tool_to_force = force_offset(prepared.found, prepared.t_force, tip);
  const TimeOffset& offset = result.tool_to_force;
  result.is_offset_applied = offset.is_known && std::abs(offset.offset) > kMinOffset &&
                             std::abs(offset.offset) > kMinOffsetStds * offset.std;
  if (result.is_offset_applied) {
    for (double& t : prepared.t_force) t -= offset.offset;
    segment();
  }
  find_bad_intervals(input, prepared, result.notes);
  result.spikes = prepared.found.spikes;
  result.force_noise = prepared.found.noise;
  for (const Eigen::Vector3d& bias : prepared.found.bias_base) {
    result.max_drift = std::max(result.max_drift, bias.norm());
  }
  return prepared;
}

ObjectIdentification begin_object(const IdentifiableObject& object, const ParameterTable& known) {
  ObjectIdentification result;
  result.name = object.name;
  if (const auto entry = known.find(object.name); entry != known.end()) {
    result.parameters = entry->second;
  }
  if (!result.parameters.mass && object.mass)
    result.parameters.mass = ParameterValue{*object.mass, {}};
  return result;
}

std::vector<double> friction_ratios_of(std::size_t object, const IdentificationInput& input,
                                       const std::vector<IdentifiedContact>& contacts,
                                       const ObjectPoses& object_poses) {
  std::vector<double> ratios;
  for (const IdentifiedContact& contact : contacts) {
    if (contact.object != object || !contact.left_out.empty()) continue;
    if (const auto ratio = friction_ratio(input, contact, object_poses)) ratios.push_back(*ratio);
  }
  return ratios;
}

void note_contacts(Identification& result, const IdentificationInput& input) {
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    const bool is_touched =
        std::any_of(result.contacts.begin(), result.contacts.end(),
                    [&](const IdentifiedContact& contact) { return contact.object == i; });
    if (!is_touched)
      result.objects[i].notes.push_back("was never touched: record a press and a push");
  }
  for (const IdentifiedContact& contact : result.contacts) {
    if (contact.left_out.empty()) continue;
    const std::string owner =
        contact.object ? input.objects[*contact.object].name : std::string("no object");
    result.notes.push_back("the contact at " + at_time(contact.episode.begin) + " (" + owner +
                           ") is not used: " + contact.left_out);
  }
}

}  // namespace

std::optional<Error> missing_streams(const IdentificationInput& input) {
  if (input.t_force.size() < 100) {
    return Error{.message = "identification needs the tool's force, but the recording has none",
                 .file = "wrench.csv",
                 .hint = "record it with the header t,fx,fy,fz,tx,ty,tz"};
  }
  if (input.t_tool.size() < 20) {
    return Error{.message = "identification needs the tool's motion, but the recording has none",
                 .file = "tool.csv",
                 .hint = "record it with the header t,x,y,z,qx,qy,qz,qw"};
  }
  const auto span = [](const char* name, const std::vector<double>& t) {
    return StreamSpan{name, Stamp::from_seconds(t.front()), Stamp::from_seconds(t.back())};
  };
  const auto conflict =
      compare_clocks(span("wrench.csv", input.t_force), span("tool.csv", input.t_tool));
  if (conflict) return clock_error(*conflict, {});
  return std::nullopt;
}

ParameterTable Identification::parameters() const {
  ParameterTable table = known;
  for (const ObjectIdentification& object : objects) table[object.name] = object.parameters;
  return table;
}

Expected<Identification> identify(const IdentificationInput& input, IdentificationGoal goal) {
  PCAVR_REQUIRE(input.t_force.size() == input.force_base.size());
  PCAVR_REQUIRE(input.t_tool.size() == input.p_base_tip.size());
  PCAVR_REQUIRE(input.q_base_tool.empty() || input.q_base_tool.size() == input.t_tool.size());
  if (const auto error = missing_streams(input)) return *error;
  if (input.objects.empty()) {
    return Error{.message = "no object is defined that the tool could have touched",
                 .file = "recording.yaml",
                 .place = "objects",
                 .hint = "declare them there with mesh and pose, or give --scene"};
  }
  Identification result;
  result.goal = goal;
  result.known = input.known;
  result.left_out = input.left_out;
  const Prepared prepared = prepare(input, result);
  const PathView tip(input.t_tool, prepared.p_base_tip);
  if (prepared.found.contacts.empty()) return no_contact_error(input, tip);
  ObjectPoses object_poses(input.objects);
  result.contacts =
      attribute_contacts(input, prepared.found, prepared.t_force, tip, prepared.bad, object_poses);
  const std::vector<ContactEvidence> evidence =
      gather_evidence(input, result.contacts, tip, object_poses);
  if (auto error =
          find_fault({input, prepared.found, result.contacts, evidence, tip, object_poses})) {
    return *error;
  }
  leave_out_misdirected(evidence, result.contacts);
  result.tool_to_camera = camera_offset(input, result.contacts);

  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    ObjectIdentification& found = result.objects.emplace_back(begin_object(object, input.known));
    const bool has_contact_law = found.parameters.contact_stiffness.has_value();
    if (goal == IdentificationGoal::contact || !has_contact_law) {
      identify_contact_of(result.contacts, i, found);
    }
    if (goal == IdentificationGoal::friction) {
      identify_friction_of(result.contacts, i, object.mass, found);
      identify_turning_of(result.contacts, i, object, tip, input.tool_radius, found);
      const std::vector<double> friction_ratios =
          friction_ratios_of(i, input, result.contacts, object_poses);
      if (const auto error = force_unit_fault(object, found.sliding.mass, friction_ratios))
        return *error;
      if (const std::string note = doubtful_friction(friction_ratios); !note.empty()) {
        found.notes.push_back(note);
      }
    }
    state_findings(goal, object, found);
  }
  note_contacts(result, input);
  return result;
}

}  // namespace pcavr
