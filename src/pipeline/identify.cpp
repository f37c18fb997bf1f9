// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/identify.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pcavr/inputs/input_monitor.hpp"
#include "pcavr/inputs/tip_path.hpp"
#include "pcavr/recording/stream_clocks.hpp"

#include "identify_findings.hpp"
#include "identify_parts.hpp"

namespace pcavr {
namespace {

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

/// The poses of an object on the tool's clock.
std::vector<TrackedPose> on_clock(std::vector<TrackedPose> tracked, double offset) {
  for (TrackedPose& pose : tracked) pose.t -= offset;
  return tracked;
}

ObjectIdentification begin_object(const IdentifiableObject& object, const ParameterTable& known) {
  ObjectIdentification result;
  result.name = object.name;
  result.is_movable = object.is_movable;
  if (const auto entry = known.find(object.name); entry != known.end()) {
    result.parameters = entry->second;
  }
  if (!result.parameters.mass && object.mass)
    result.parameters.mass = ParameterValue{*object.mass, {}};
  return result;
}

/// A press under which the object slides or turns, as in an oblique hole, shows no contact law: the
/// tip's path is not its penetration.
void leave_out_moved_presses(std::vector<IdentifiedContact>& contacts, std::size_t index,
                             const std::vector<TrackedPose>& tracked, const PathView& tip) {
  constexpr double kMaxMotion = 0.001;  // [m] where the tip is; tracking has some tenths of that
  if (tracked.empty()) return;
  for (IdentifiedContact& contact : contacts) {
    const ContactEpisode& episode = contact.episode;
    const bool is_press = episode.kind == ContactKind::press && !episode.impact;
    if (contact.object != index || !is_press || !contact.left_out.empty()) continue;
    const Pose T_base_before = pose_at(tracked, episode.begin);
    const Pose T_base_after = pose_at(tracked, episode.end);
    const Eigen::Vector3d p_base = tip.at(episode.begin);
    const Eigen::Vector3d p_base_after = T_base_after * (T_base_before.inverse() * p_base);
    if ((p_base_after - p_base).norm() > kMaxMotion) {
      contact.left_out = "the object moves under the press";
    }
  }
}

/// The std of a contact's `tool` where the tip has an error that all samples share.
std::vector<double> tip_std_of(const IdentificationInput& input, const ContactEpisode& episode) {
  std::vector<double> stds;
  if (input.tip_covariance_base.empty()) return stds;
  stds.reserve(episode.t.size());
  for (const double t : episode.t) {
    const auto next = std::lower_bound(input.t_tool.begin(), std::prev(input.t_tool.end()), t);
    const auto row = static_cast<std::size_t>(next - input.t_tool.begin());
    const Eigen::Vector3d& along = episode.direction_base;
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
                    [&](const IdentifiedContact& contact) { return contact.object == i; });
    if (!is_touched)
      result.objects[i].notes.push_back(input.objects[i].is_movable
                                            ? "was never touched: record a press and a push"
                                            : "was never touched: record a press");
  }
  std::size_t left_out = 0;
  for (const IdentifiedContact& contact : result.contacts) {
    if (contact.left_out.empty() || ++left_out > kMaxContactNotes) continue;
    const std::string owner =
        contact.object ? input.objects[*contact.object].name : std::string("no object");
    result.notes.push_back("the contact at " + at_time(contact.episode.begin) + " (" + owner +
                           ") is not used: " + contact.left_out);
  }
  if (left_out <= kMaxContactNotes) return;
  result.notes.push_back(std::to_string(left_out - kMaxContactNotes) +
                         " more contacts are not used, counted by reason below");
}

/// [s] In all slides of the pushes with an object.
double sliding_duration(std::vector<IdentifiedContact>& contacts, std::size_t object) {
  double duration = 0.0;
  for (const IdentifiedContact* push : contacts_of(contacts, object, false)) {
    for (const SlideInterval& slide : push->episode.slides) duration += slide.end - slide.begin;
  }
  return duration;
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
  result.inputs = examine_inputs(
      series_of(input), options.inputs,
      [&result](AttributedContact&& contact) { result.contacts.push_back({std::move(contact)}); });
  if (result.inputs.fault) return result.inputs.fault->error;
  if (result.inputs.no_contact) return *result.inputs.no_contact;
  result.notes = result.inputs.notes;
  for (IdentifiedContact& contact : result.contacts) {
    contact.tip_std = tip_std_of(input, contact.episode);
  }
  const TipPath clean = clean_tip_path(input.t_tool, input.p_base_tip, options.inputs);
  const PathView tip(clean.t, clean.p_base);

  for (std::size_t i = 0; i < input.objects.size(); ++i) {
    const IdentifiableObject& object = input.objects[i];
    ObjectIdentification& found = result.objects.emplace_back(begin_object(object, input.known));
    const std::vector<TrackedPose> tracked = on_clock(object.tracked, result.inputs.camera_shift());
    const BodyMotion motion{object.model, tracked};
    identify_tool_friction_of(result.contacts, i, motion, tip, input.tool_radius, found);
    if (object.is_movable) leave_out_moved_presses(result.contacts, i, tracked, tip);
    if (is_contact_assumed(found.parameters)) forget_contact(found.parameters);
    const bool has_contact_law = found.parameters.contact_stiffness.has_value();
    if (goal == IdentificationGoal::contact || !has_contact_law) {
      identify_contact_of(result.contacts, i, tip, options, found);
      identify_surface_offset(result.contacts, i, object, input.tool_radius, tip, found);
    }
    if (goal == IdentificationGoal::friction && object.is_movable) {
      identify_friction_of(result.contacts, i, object.mass, motion, tip, input.tool_radius, options,
                           found);
      check_press_lines(result.contacts, i, options.inputs.segmentation.breakaway, found);
      if (object.mass) {
        const auto fault = force_unit_fault(object.name, *object.mass, found.sliding.mass);
        if (fault) return fault->error;
      }
    }
    withhold_contact_off_centre(found);
    if (object.is_movable) assume_contact_by_loading(result.contacts, i, found);
    state_penetration(options.contact_fit, found);
    state_findings(goal, object, sliding_duration(result.contacts, i), found);
  }
  note_contacts(result, input);
  return result;
}

}  // namespace pcavr
