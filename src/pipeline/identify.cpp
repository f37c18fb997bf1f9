// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "pcavr/core/check.hpp"
#include "pcavr/core/gravity.hpp"

#include "identify_findings.hpp"
#include "identify_parts.hpp"

namespace pcavr {
namespace {

/// A mass that force and motion make, against the one that somebody weighed: beyond this factor
/// the force is in another unit (a kilogram-force is 9.8 N, a pound-force 4.4 N).
constexpr double kMassFactor = 3.0;
/// Below polished PTFE and above soft rubber.
constexpr double kLeastCoefficient = 0.03;
constexpr double kGreatestCoefficient = 3.0;
/// An offset counts where it is this many of its deviations, ...
constexpr double kOffsetDeviations = 3.0;
constexpr double kLeastOffset = 0.0005;  // [s] ... and worth a shift: a quarter of a sample
constexpr double kJumpMargin = 0.1;      // [s] about a jump that the smoothing smears it over
constexpr double kTouchDepth = 0.001;    // [m] deeper than this in a body there must be a force

/// Everything is free, by the force. Was it so by the tip?
Error nothing_touched(const IdentificationInput& input, const PathView& tip) {
  const ObjectPlaces places(input.objects);
  double deepest = std::numeric_limits<double>::infinity();
  double when = 0.0;
  for (double t = input.t_tool.front(); t < input.t_tool.back(); t += 0.02) {
    for (std::size_t i = 0; i < input.objects.size(); ++i) {
      const auto touch = places.touch(i, t, tip.at(t), input.tool_radius);
      if (touch && touch->gap < deepest) deepest = touch->gap, when = t;
    }
  }
  if (deepest < -kTouchDepth) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "the force stays below 0.3 N although the tip is %.1f mm deep in an object at "
                  "t = %.2f s",
                  -deepest * 1e3, when);
    return {.message = text, .file = "wrench.csv", .hint = "write newtons (is it in kilonewtons?)"};
  }
  return {.message = "nothing was touched: the force never leaves its noise",
          .file = "wrench.csv",
          .hint = "press the object along z, then push it"};
}

struct Prepared {
  std::vector<Eigen::Vector3d> p_base_tip;
  std::vector<double> t_force;  ///< on the tool's clock
  Segmentation found;
  std::vector<BadStretch> bad;
};

void find_bad_stretches(const IdentificationInput& input, Prepared& prepared,
                        std::vector<std::string>& notes) {
  const std::vector<double> jumps = find_jumps(input.t_tool, prepared.p_base_tip);
  for (const double t : jumps) {
    prepared.bad.push_back({{t - kJumpMargin, t + kJumpMargin}, "the tool's pose jumps"});
  }
  if (!jumps.empty()) {
    notes.push_back("the tool's pose jumps " + std::to_string(jumps.size()) +
                    " times, first at t = " + std::to_string(jumps.front()).substr(0, 6) + " s");
  }
  const std::vector<SaturatedStretch> flat = find_saturation(prepared.t_force, input.force_base);
  for (const SaturatedStretch& stretch : flat) {
    prepared.bad.push_back({{stretch.begin, stretch.end}, "the force sensor was at its end"});
  }
  if (!flat.empty()) {
    notes.push_back("the force sensor was at its end " + std::to_string(flat.size()) +
                    " times, first at t = " + std::to_string(flat.front().begin).substr(0, 6) +
                    " s: what it measured meanwhile is not used");
  }
}

/// Segments the recording, on the tool's clock if the force's is another.
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
  result.is_offset_applied = offset.is_known && std::abs(offset.offset) > kLeastOffset &&
                             std::abs(offset.offset) > kOffsetDeviations * offset.deviation;
  if (result.is_offset_applied) {
    for (double& t : prepared.t_force) t -= offset.offset;
    segment();
  }
  find_bad_stretches(input, prepared, result.notes);
  result.spikes = prepared.found.spikes;
  result.force_noise = prepared.found.noise;
  for (const Eigen::Vector3d& bias : prepared.found.bias_base) {
    result.largest_drift = std::max(result.largest_drift, bias.norm());
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

/// The mass that somebody weighed tells the force's unit: by the accelerations where they are told,
/// else by the friction that the weight makes.
std::optional<Error> wrong_unit(const IdentifiableObject& object,
                                const ObjectIdentification& found) {
  if (!object.mass) return std::nullopt;
  char text[200];
  if (found.sliding.mass.is_excited) {
    const double factor = found.sliding.mass.value / *object.mass;
    if (factor < kMassFactor && factor > 1.0 / kMassFactor) return std::nullopt;
    std::snprintf(text, sizeof text,
                  "by force and motion %s weighs %.3g kg, by the manifest %.3g kg: the force is in "
                  "another unit",
                  object.name.c_str(), found.sliding.mass.value, *object.mass);
  } else {
    if (found.limit.pushes == 0) return std::nullopt;
    const double coefficient = found.limit.mean / (*object.mass * kStandardGravity);
    if (coefficient > kLeastCoefficient && coefficient < kGreatestCoefficient) return std::nullopt;
    std::snprintf(text, sizeof text,
                  "%s would break away at %.2g of its weight, which nothing on a table does: the "
                  "force is in another unit",
                  object.name.c_str(), coefficient);
  }
  return Error{.message = text, .file = "wrench.csv", .hint = "write newtons, or correct the mass"};
}

void note_contacts(Identification& result, const IdentificationInput& input) {
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    const bool is_touched =
        std::any_of(result.contacts.begin(), result.contacts.end(),
                    [&](const IdentifiedContact& contact) { return contact.object == i; });
    if (!is_touched) result.objects[i].notes.push_back("was never touched: press and push it");
  }
  for (const IdentifiedContact& contact : result.contacts) {
    if (contact.left_out.empty()) continue;
    const std::string whose =
        contact.object ? input.objects[*contact.object].name : std::string("no object");
    result.notes.push_back(
        "the contact at t = " + std::to_string(contact.episode.begin).substr(0, 6) + " s (" +
        whose + ") is left out: " + contact.left_out);
  }
}

}  // namespace

std::optional<Error> missing_streams(const IdentificationInput& input) {
  if (input.t_force.size() < 100) {
    return Error{.message = "identification needs the tool's force, and there is none",
                 .file = "wrench.csv",
                 .hint = "record it with the header t,fx,fy,fz,tx,ty,tz"};
  }
  if (input.t_tool.size() < 20) {
    return Error{.message = "identification needs the tool's motion, and there is none",
                 .file = "tool.csv",
                 .hint = "record it with the header t,x,y,z,qx,qy,qz,qw"};
  }
  const double begin = std::max(input.t_force.front(), input.t_tool.front());
  const double end = std::min(input.t_force.back(), input.t_tool.back());
  if (end - begin < 0.5) {
    return Error{.message = "force and tool were not recorded at the same time",
                 .file = "wrench.csv",
                 .hint = "give both the one clock of the recording"};
  }
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
  if (const auto error = missing_streams(input)) return *error;
  if (input.objects.empty()) {
    return Error{.message = "no object is known that the tool could have touched",
                 .file = "recording.yaml",
                 .place = "objects",
                 .hint = "name them there with mesh and pose, or give --scene"};
  }
  Identification result;
  result.goal = goal;
  result.known = input.known;
  result.left_out = input.left_out;
  const Prepared prepared = prepare(input, result);
  const PathView tip(input.t_tool, prepared.p_base_tip);
  if (prepared.found.contacts.empty()) return nothing_touched(input, tip);
  if (auto error = contradiction(prepared.found, tip)) {
    error->file = "wrench.csv";
    return *error;
  }
  ObjectPlaces places(input.objects);
  result.contacts =
      attribute_contacts(input, prepared.found, prepared.t_force, tip, prepared.bad, places);
  result.tool_to_camera = camera_offset(input, result.contacts);

  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    ObjectIdentification& found = result.objects.emplace_back(begin_object(object, input.known));
    const bool knows_contact = found.parameters.contact_stiffness.has_value();
    if (goal == IdentificationGoal::contact || !knows_contact) {
      identify_contact_of(result.contacts, i, found);
    }
    if (goal == IdentificationGoal::friction) {
      identify_friction_of(result.contacts, i, object.mass, found);
      identify_turning_of(result.contacts, i, object, tip, input.tool_radius, found);
      if (const auto error = wrong_unit(object, found)) return *error;
    }
    state_findings(goal, object, found);
  }
  note_contacts(result, input);
  return result;
}

}  // namespace pcavr
