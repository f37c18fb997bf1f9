// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/content_id.hpp"
#include "pcavr/physics/inputs/force_scale.hpp"
#include "pcavr/physics/inputs/input_monitor.hpp"
#include "pcavr/physics/inputs/tip_path.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "contact_motion.hpp"
#include "series_of.hpp"

namespace pcavr {

InputSeries series_of(const IdentificationInput& input) {
  InputSeries series{.tool_radius = input.tool_radius,
                     .t_tool = input.t_tool,
                     .p_base_tip = input.p_base_tip,
                     .q_base_tool = input.q_base_tool,
                     .t_force = input.t_force,
                     .force_base = input.force_base};
  for (const IdentifiableObject& object : input.objects) {
    // The weight of an immovable body does not bound the force on it.
    series.bodies.push_back({object.name, &object.model, object.T_base_object,
                             object.is_movable ? object.mass : std::nullopt, object.tracked,
                             object.is_movable});
  }
  return series;
}

namespace {

/// The std of a contact's `tool` where the tip has an error that all samples share.
std::vector<double> tip_std_of(const IdentificationInput& input, const Contact& contact) {
  std::vector<double> stds;
  if (input.tip_covariance_base.empty()) return stds;
  stds.reserve(contact.t.size());
  for (const double t : contact.t) {
    const auto next = std::lower_bound(input.t_tool.begin(), std::prev(input.t_tool.end()), t);
    const auto row = static_cast<std::size_t>(next - input.t_tool.begin());
    const Eigen::Vector3d& along = contact.direction_base;
    const double variance = along.dot(input.tip_covariance_base[row] * along);
    stds.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return stds;
}

/// segment_contacts finds none in fewer.
constexpr std::size_t kMinContactSamples = 20;

/// A stream in which no contact can be found.
std::optional<Error> too_few(std::size_t samples, const std::string& what, const std::string& file,
                             const std::string& columns) {
  if (samples >= kMinContactSamples) return std::nullopt;
  const std::string needed = "identification needs the tool's " + what;
  if (samples == 0) {
    return Error{.message = needed + ", but the recording has none",
                 .file = file,
                 .hint = "record it with the header t," + columns};
  }
  return Error{.message = needed + " in " + std::to_string(kMinContactSamples) +
                          " samples, but the recording has " + std::to_string(samples),
               .file = file,
               .hint = "record for longer, with free motion before and after the contact"};
}

/// Contacts that are left out are noted one by one up to this number; all are counted by reason.
constexpr std::size_t kMaxContactNotes = 10;

void note_contacts(Identification& result, const IdentificationInput& input) {
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    const bool is_touched =
        std::any_of(result.contacts.begin(), result.contacts.end(),
                    [&](const Contact& contact) { return contact.object == i; });
    if (!is_touched)
      result.objects[i].notes.push_back(input.objects[i].is_movable
                                            ? "was never touched: record a press and a push"
                                            : "was never touched: record a press");
  }
  std::size_t left_out = 0;
  for (const Contact& contact : result.contacts) {
    if (contact.left_out.empty() || ++left_out > kMaxContactNotes) continue;
    const std::string owner =
        contact.object ? input.objects[*contact.object].name : std::string("no object");
    result.notes.push_back("the contact at " + at_time(contact.begin) + " (" + owner +
                           ") is not used: " + contact.left_out);
  }
  if (left_out <= kMaxContactNotes) return;
  result.notes.push_back(std::to_string(left_out - kMaxContactNotes) +
                         " more contacts are not used, counted by reason below");
}

void warn(std::vector<std::string> warnings, Identification& result) {
  for (std::string& warning : warnings) {
    result.notes.push_back(warning);
    result.warnings.push_back(std::move(warning));
  }
}

/// By its force: two recordings of one sensor never have the same noise.
std::string content_of(const IdentificationInput& input) {
  const std::uint64_t times = fnv1a(std::as_bytes(std::span(input.t_force)));
  return content_id(fnv1a(std::as_bytes(std::span(input.force_base)), times));
}

/// Puts an object's contacts, with what each showed, where they are in order of time.
void replace_contacts(std::vector<Contact>&& found, std::size_t object,
                      std::vector<Contact>& contacts) {
  auto next = std::make_move_iterator(found.begin());
  for (Contact& contact : contacts) {
    if (contact.object == object) contact = *next++;
  }
}

/// The friction at the tip is the tangent of the force's angle to the surface's normal: a turn of
/// the force by a std adds that of the tangent. Along the motion it changes a force in second
/// order.
void add_direction_std(double turn_std, ObjectIdentification& found) {
  std::optional<ParameterValue>& friction = found.parameters.tool_friction_coefficient;
  if (!(turn_std > 0.0) || !friction || !friction->std || found.tool_friction_contacts == 0) return;
  const double slope = 1.0 + friction->value * friction->value;
  friction->std = std::hypot(*friction->std, slope * turn_std);
  found.notes.push_back(fmt::format(
      "the std of the tip's friction contains that of the force's direction, {:.2f} degrees",
      turn_std * 180.0 / std::numbers::pi));
}

}  // namespace

std::optional<Error> missing_streams(const IdentificationInput& input) {
  if (const auto error = too_few(input.t_force.size(), "force", "wrench.csv", "fx,fy,fz,tx,ty,tz"))
    return error;
  if (const auto error = too_few(input.t_tool.size(), "motion", "tool.csv", "x,y,z,qx,qy,qz,qw"))
    return error;
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

Expected<Identification> identify(const IdentificationInput& input, IdentificationGoal goal,
                                  const IdentificationOptions& options) {
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
  result.inputs = examine_inputs(series_of(input), options.inputs, [&result](Contact&& contact) {
    result.contacts.push_back({std::move(contact)});
  });
  if (result.inputs.fault) return result.inputs.fault->error;
  if (result.inputs.no_contact) return *result.inputs.no_contact;
  result.notes = input.notes;
  result.notes.insert(result.notes.end(), result.inputs.notes.begin(), result.inputs.notes.end());
  result.warnings = result.inputs.warnings;
  for (Contact& contact : result.contacts) {
    contact.tip_std = tip_std_of(input, contact);
  }
  const TipPath clean = clean_tip_path(input.t_tool, input.p_base_tip, options.inputs);

  std::vector<WeighedObject> weighed;
  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    const auto known = input.known.find(object.name);
    ObjectIdentifier identifier(object,
                                known == input.known.end() ? ObjectParameters() : known->second,
                                input.tool_radius, goal, options);
    identifier.set_suspected_turn(result.inputs.suspected_turn);
    const std::vector<TrackedPose> tracked = on_clock(object.tracked, result.inputs.camera_shift());
    for (auto& contact : contacts_with_motion(result.contacts, i, clean, tracked)) {
      identifier.add(std::move(contact));
    }
    ObjectIdentifier::Result found = identifier.result();
    add_direction_std(input.force_direction_std, found.object);
    if (goal == IdentificationGoal::friction && object.is_movable && object.mass)
      weighed.push_back({object.name, *object.mass, found.object.sliding.mass});
    if (!found.contacts.empty()) add_recordings({content_of(input)}, found.object);
    replace_contacts(std::move(found.contacts), i, result.contacts);
    result.objects.push_back(std::move(found.object));
  }
  ScaleFindings scale = check_force_scale(weighed);
  if (scale.fault) return scale.fault->error;
  warn(std::move(scale.warnings), result);
  if (goal == IdentificationGoal::friction)
    result.notes.insert(result.notes.end(), scale.notes.begin(), scale.notes.end());
  note_contacts(result, input);
  return result;
}

}  // namespace pcavr
