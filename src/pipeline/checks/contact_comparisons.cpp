// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "contact_comparisons.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/inputs/contact_clocks.hpp"
#include "pcavr/physics/inputs/force_scale.hpp"
#include "pcavr/physics/inputs/input_monitor.hpp"
#include "pcavr/physics/inputs/touch.hpp"
#include "pcavr/pipeline/identify.hpp"

#include "clock_checks.hpp"
#include "consistency_text.hpp"
#include "force_at_rest.hpp"
#include "input_comparisons.hpp"
#include "pipeline/identify/series_of.hpp"

namespace pcavr {
namespace {

constexpr char kContacts[] = "tool and force against the objects";
constexpr char kDistance[] = "distance from the tip to the object at contact";
constexpr char kDirection[] = "angle between force and sliding direction";
constexpr char kForceClock[] = "clock of wrench.csv against tool.csv";
constexpr char kTrackingClock[] = "clock of the tracking against tool.csv";

/// Contacts of which none is at an object that are a fault.
constexpr std::size_t kMinContacts = 2;
/// [m] A shorter slide has no certain direction.
constexpr double kMinSlide = 5e-3;
/// [rad] The friction at the tip and a lever about the centre of mass turn the force as far; beyond
/// it, a force that is mounted wrongly and a tip that slides along the face look alike.
constexpr double kMaxSlideAngle = 0.35;
/// [s] Less than a frame of most cameras, and what a contact's compression looks like.
constexpr double kMinTrackDelay = 0.010;
constexpr double kMinTrackStds = 3.0;
constexpr double kMinRowShare = 0.25;  ///< of the longer interval between two rows

/// The contacts of a recording, and what the series show about themselves.
struct SeenContacts {
  const IdentificationInput& input;
  InputFindings found = {};
  std::vector<Contact> contacts = {};

  [[nodiscard]] PathView tip() const { return {input.t_tool, input.p_base_tip}; }
  [[nodiscard]] std::size_t at_no_object() const {
    return static_cast<std::size_t>(std::count_if(
        contacts.begin(), contacts.end(), [](const auto& contact) { return !contact.object; }));
  }
};

/// A line of the series' notes as a finding: what follows the first semicolon is the hint.
ConsistencyFinding finding_of(const std::string& note) {
  const std::size_t end = note.find("; ");
  return {.file = "tool, force and tracking",
          .message = note.substr(0, end),
          .hint = end == note.npos ? "check the stream at that time" : note.substr(end + 2)};
}

/// [m] from the tip to the nearest object's surface as the contact begins; nothing beyond 0.2 m.
std::optional<double> nearest_gap(const SeenContacts& seen, const Contact& contact) {
  double gap = HUGE_VAL;
  for (const IdentifiableObject& object : seen.input.objects) {
    const Pose T_base_object =
        object.tracked.empty() ? object.T_base_object : pose_at(object.tracked, contact.begin);
    gap = std::min(gap,
                   BodySurface(object.model)
                       .touch(T_base_object, seen.tip().at(contact.begin), seen.input.tool_radius)
                       .gap);
  }
  return std::isfinite(gap) ? std::optional(gap) : std::nullopt;
}

/// "-0.2 to 1.3 mm, median 0.1 mm".
std::string millimetres_text(const std::vector<double>& lengths) {
  const auto [first, last] = std::minmax_element(lengths.begin(), lengths.end());
  return fmt::format("{:.1f} to {:.1f} mm, median {:.1f} mm", 1e3 * *first, 1e3 * *last,
                     1e3 * median(lengths));
}

void compare_distances(const SeenContacts& seen, std::vector<InputComparison>& comparisons) {
  for (std::size_t i = 0; i < seen.input.objects.size(); ++i) {
    const std::string& name = seen.input.objects[i].name;
    std::vector<double> gaps;
    for (const Contact& contact : seen.contacts) {
      if (contact.object == i) gaps.push_back(contact.gap);
    }
    comparisons.push_back(
        gaps.empty()
            ? failed_comparison("pose of " + name, "no contact is at its surface")
            : comparison_of(kDistance, fmt::format("{}: {} contacts at its surface, {}", name,
                                                   gaps.size(), millimetres_text(gaps))));
  }
  const std::size_t elsewhere = seen.at_no_object();
  if (elsewhere == 0 || elsewhere == seen.contacts.size()) return;
  std::vector<double> gaps;
  for (const Contact& contact : seen.contacts) {
    if (contact.object) continue;
    if (const auto gap = nearest_gap(seen, contact)) gaps.push_back(*gap);
  }
  comparisons.push_back(failed_comparison(
      kContacts, fmt::format("{} more contacts are at no object{}", elsewhere,
                             gaps.empty() ? "" : "; the nearest is " + millimetres_text(gaps))));
}

/// Motion of the object's centre of mass while it slides, or of the tip where it is not tracked
/// [m].
Eigen::Vector2d displacement(const SeenContacts& seen, const IdentifiableObject& object,
                             const SlideInterval& slide) {
  if (object.tracked.empty()) {
    return (seen.tip().at(slide.end) - seen.tip().at(slide.begin)).head<2>();
  }
  const Eigen::Vector3d& centre = object.model.centre_of_mass_object;
  return (pose_at(object.tracked, slide.end) * centre -
          pose_at(object.tracked, slide.begin) * centre)
      .head<2>();
}

/// The force's mean in the plane over the slide [N].
Eigen::Vector2d mean_force(const Contact& contact, const SlideInterval& slide) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < contact.force_base.size(); ++i) {
    const double t = contact.t[i];
    if (t >= slide.begin && t <= slide.end) sum += contact.force_base[i].head<2>();
  }
  return sum;
}

void compare_directions(const SeenContacts& seen, std::vector<InputComparison>& comparisons) {
  std::vector<double> angles;
  for (const Contact& contact : seen.contacts) {
    if (!contact.object || !contact.left_out.empty()) continue;
    for (const SlideInterval& slide : contact.slides) {
      const Eigen::Vector2d motion = displacement(seen, seen.input.objects[*contact.object], slide);
      const Eigen::Vector2d force = mean_force(contact, slide);
      if (motion.norm() < kMinSlide || force.isZero()) continue;
      angles.push_back(std::acos(std::clamp(motion.normalized().dot(force.normalized()), -1., 1.)));
    }
  }
  if (angles.empty()) {
    comparisons.push_back(failed_comparison(kDirection, "no object slides by 5 mm in a contact"));
    return;
  }
  const double middle = median(angles);
  const std::string figure =
      fmt::format("median {}, at most {} in {} slides", degrees(middle),
                  degrees(*std::max_element(angles.begin(), angles.end())), angles.size());
  comparisons.push_back(
      middle <= kMaxSlideAngle
          ? comparison_of(kDirection, figure)
          : failed_comparison(kDirection, figure + ": the tip slides along the face or beside the "
                                                   "centre, or the force is turned"));
}

/// [s] An offset below is one of the rows' phases: no clock is better known than its rows.
double min_row_offset(const SeenContacts& seen) {
  return kMinRowShare *
         std::max(mean_interval(seen.input.t_tool), mean_interval(seen.input.t_force));
}

/// Adds a clock's offset, which is a warning where it is significant and more than `min_offset`
/// [s].
void compare_clock(const char* what, const char* file, const TimeOffset& offset, bool is_applied,
                   double min_offset, const std::string& unknown,
                   std::vector<InputComparison>& comparisons,
                   std::vector<ConsistencyFinding>& findings) {
  if (!offset.is_known) {
    comparisons.push_back(failed_comparison(what, "the offset is not observable: " + unknown));
    return;
  }
  const std::string figure =
      fmt::format("{:.1f} +- {:.1f} ms", 1e3 * offset.offset, 1e3 * offset.std);
  if (!is_applied || std::abs(offset.offset) < min_offset) {
    comparisons.push_back(comparison_of(what, figure + (is_applied ? ", taken off" : "")));
    return;
  }
  findings.push_back({.file = file,
                      .message = "its stamps are " + figure +
                                 " later than those of tool.csv; "
                                 "identify and replay take this off",
                      .hint = "synchronise the clocks, or record the sensor's own stamps"});
}

void compare_clocks(const SeenContacts& seen, std::vector<InputComparison>& comparisons,
                    std::vector<ConsistencyFinding>& findings) {
  compare_clock(kForceClock, "wrench.csv", seen.found.tool_to_force,
                seen.found.is_force_offset_applied, min_row_offset(seen),
                "no press, release or loading shows it", comparisons, findings);
  const bool is_tracked = std::any_of(seen.input.objects.begin(), seen.input.objects.end(),
                                      [](const auto& object) { return !object.tracked.empty(); });
  compare_clock(kTrackingClock, "tracked", seen.found.tool_to_camera,
                seen.found.is_camera_offset_applied, 0.0,
                is_tracked ? "no slide of a tracked object shows it" : "there are no tracked poses",
                comparisons, findings);
}

/// Adds a body's tracking that has another delay than that of all, which `identify` takes off.
void compare_track(const std::string& name, const TrackDelays& track, double of_all,
                   std::vector<ConsistencyFinding>& findings) {
  const TimeOffset& own = track.offset;
  const double late = own.offset - of_all;
  const bool is_certain = own.is_known || track.may_be_shifted;
  if (!is_certain || std::abs(late) < std::max(kMinTrackDelay, kMinTrackStds * own.std)) return;
  const std::string figure =
      fmt::format("{:.0f} +- {:.0f} ms", 1e3 * std::abs(own.offset), 1e3 * own.std);
  const char* which = own.offset > 0.0 ? "later" : "earlier";
  findings.push_back(
      own.is_known
          ? ConsistencyFinding{.file = name,
                               .message = fmt::format(
                                   "its stamps are {} {} than those of tool.csv; {:.0f} ms are "
                                   "taken off the tracking of all objects",
                                   figure, which, 1e3 * of_all),
                               .hint = "synchronise the clocks; each stream of poses may have its "
                                       "own"}
          : ConsistencyFinding{.file = name,
                               .message = fmt::format(
                                   "the face moves {} {} than the tip that pushes it, or is off as "
                                   "long as it slides: its motion does not show which",
                                   figure, which),
                               .hint = "synchronise the clocks; check mesh, tool's tip and tracked "
                                       "frame"});
}

/// A clock that was set, or drifts, by the delays of single contacts.
void compare_delays(const std::string& what, const std::string& file,
                    std::span<const ContactDelay> delays, std::vector<InputComparison>& comparisons,
                    std::vector<ConsistencyFinding>& findings) {
  const std::string over_time = what + " over time";
  if (delays.size() < 2) {
    comparisons.push_back(failed_comparison(
        over_time, fmt::format("{} contact shows a delay: a step or a drift would not show",
                               delays.empty() ? "no" : "only one")));
    return;
  }
  const DelayChange change = find_delay_change(delays);
  if (change.step) {
    const DelayStep& step = *change.step;
    findings.push_back(
        {.file = file,
         .message = fmt::format("its clock, or that of tool.csv, was set between t = {:.3f} and "
                                "{:.3f} s: from then on its stamps are {:.0f} +- {:.0f} ms {}",
                                step.after, step.before, 1e3 * std::abs(step.size), 1e3 * step.std,
                                step.size > 0.0 ? "later" : "earlier"),
         .hint = "stamp all streams by one clock, and do not let it be set during a recording"});
  } else if (change.drift) {
    findings.push_back(
        {.file = file,
         .message = fmt::format("its clock drifts against that of tool.csv by {:.0f} +- {:.0f} ppm",
                                1e6 * change.drift->rate, 1e6 * change.drift->std),
         .hint = "stamp all streams by one clock"});
  } else {
    std::string figure = fmt::format("no step of {:.0f} ms or more by {} contacts",
                                     1e3 * change.min_step, delays.size());
    if (const auto drift = fit_delay_drift(delays)) {
      figure += fmt::format(", drift of {:.0f} +- {:.0f} ppm", 1e6 * drift->rate, 1e6 * drift->std);
    }
    comparisons.push_back(comparison_of(over_time, std::move(figure)));
  }
}

void compare_clocks_over_time(const SeenContacts& seen, const InputSeries& series,
                              std::vector<InputComparison>& comparisons,
                              std::vector<ConsistencyFinding>& findings) {
  const ContactDelays delays = contact_delays(series, seen.contacts, InputOptions());
  compare_delays(kForceClock, "wrench.csv", delays.force, comparisons, findings);
  if (delays.tracks.empty()) compare_delays(kTrackingClock, "tracked", {}, comparisons, findings);
  for (const TrackDelays& track : delays.tracks) {
    const std::string name = "tracking of " + seen.input.objects[track.body].name;
    compare_track(name, track, seen.found.camera_shift(), findings);
    compare_delays("clock of the " + name + " against tool.csv", name, track.contacts, comparisons,
                   findings);
  }
}

/// Only pushes that excite an object's mass show the scale: `identify` compares it then.
void compare_masses(const SeenContacts& seen, std::vector<InputComparison>& comparisons) {
  for (const IdentifiableObject& object : seen.input.objects) {
    const std::string reason = object.mass ? "identify compares it with " + object.name +
                                                 "'s weighed mass, where pushes excite the mass"
                                           : "the mass of " + object.name + " is not known";
    comparisons.push_back(
        failed_comparison("the force's scale", reason + "; " + kForceScaleEffect));
  }
}

void add_fault(const Error& error, std::vector<ConsistencyFinding>& findings) {
  findings.push_back({.severity = FindingSeverity::contradiction,
                      .file = error.file.empty() ? "wrench.csv" : error.file,
                      .place = error.place,
                      .message = error.message,
                      .hint = error.hint});
}

/// Single contacts may be with the table; all of them are not.
void check_elsewhere(const SeenContacts& seen, std::vector<ConsistencyFinding>& findings) {
  const std::size_t elsewhere = seen.at_no_object();
  if (elsewhere < kMinContacts || elsewhere != seen.found.contacts) return;
  std::string notes;
  for (const std::string& note : seen.found.notes) notes += "; " + note;
  findings.push_back({.file = "recording.yaml",
                      .place = "objects",
                      .message = fmt::format("none of the tool's {} contacts is at an object's "
                                             "surface{}",
                                             elsewhere, notes),
                      .hint = "check the objects' poses and the tool's path: both are in base"});
}

}  // namespace

std::vector<InputComparison> compare_contacts(const Recording& recording,
                                              const PerceptionOptions& options,
                                              std::vector<ConsistencyFinding>& findings) {
  if (recording.tool.empty() || recording.wrench.empty()) {
    return {failed_comparison(kContacts, recording.tool.empty() ? "no tool.csv" : "no wrench.csv")};
  }
  if (const std::optional<Error> slow = check_rates(recording)) {
    return {failed_comparison(kContacts, slow->message + "; " + slow->hint)};
  }
  const auto input = identification_input(recording, {.perception = options});
  if (!input) {
    return {failed_comparison(kContacts,
                              input.error().message + " (build, then pcavr identify --scene)")};
  }
  if (const auto missing = missing_streams(*input)) {
    return {failed_comparison(kContacts, missing->message)};
  }
  if (input->objects.empty()) {
    return {compare_force_at_rest(*input, findings),
            failed_comparison(kContacts, "no object has a mesh and a pose")};
  }
  SeenContacts seen{.input = *input};
  const InputSeries series = series_of(*input);
  seen.found = examine_inputs(series, InputOptions(), [&](Contact&& contact) {
    seen.contacts.push_back(std::move(contact));
  });
  if (seen.found.fault) {
    add_fault(seen.found.fault->error, findings);
    std::vector<InputComparison> comparisons{
        failed_comparison("contacts, clocks and force at rest", "the fault comes first")};
    compare_clocks_over_time(seen, series, comparisons, findings);
    return comparisons;
  }
  if (seen.found.no_contact) {
    return {compare_force_at_rest(*input, findings),
            failed_comparison(kContacts, seen.found.no_contact->message)};
  }
  for (const std::string& note : seen.found.notes) findings.push_back(finding_of(note));
  std::vector<InputComparison> comparisons{compare_force_at_rest(*input, findings)};
  compare_distances(seen, comparisons);
  compare_masses(seen, comparisons);
  compare_directions(seen, comparisons);
  compare_clocks(seen, comparisons, findings);
  compare_clocks_over_time(seen, series, comparisons, findings);
  check_elsewhere(seen, findings);
  return comparisons;
}

}  // namespace pcavr
