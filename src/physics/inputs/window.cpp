// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/inputs/window.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "physics/inputs/attribution.hpp"
#include "physics/inputs/clock_offsets.hpp"
#include "physics/inputs/clock_shift.hpp"
#include "physics/inputs/free_force.hpp"
#include "physics/inputs/stream_gaps.hpp"
#include "physics/inputs/touch_closure.hpp"

namespace pcavr {
namespace {

constexpr double kMaxTouchDelay = 1.0;  // [s] of the force; more is searched as a fault
/// [s] Smaller delays are searched by the contact law, which is more precise.
constexpr double kMinTouchDelay = 0.2;
constexpr double kMaxTouchStd = 0.05;     // [s] of a delay by touches that is corrected
constexpr double kMaxDisagreement = 4.0;  // in stds of two estimates of one delay
constexpr int kFilterRefinements = 3;     // each leaves a tenth of the delay's error or less
constexpr double kMaxFilterStds = 3.0;    // of a filter's delay by noise
/// [s] Of a delay that drifts: one off by 2 ms makes a mass by accelerations some per cent wrong.
constexpr double kMaxDelayStd = 0.002;
constexpr double kAroundGap = 0.2;  // [s] a contact that is found so near may lie in the gap

TimeOffset more_certain(const TimeOffset& known, const TimeOffset& found) {
  const bool is_better = found.is_known && (!known.is_known || found.std < known.std);
  return is_better ? found : known;
}

/// A part of a stream on the tool's clock, and its contacts.
struct Prepared {
  InputSeries series;  ///< refers to the members below where an offset is applied
  TipPath tip;
  std::vector<double> t_force_without_drift;
  std::vector<double> t_force;
  std::vector<Eigen::Vector3d> force_base;  ///< without what there is far from all bodies
  std::vector<Eigen::Vector3d> force_before_filter;
  std::vector<std::vector<TrackedPose>> tracked;
  Segmentation found;

  [[nodiscard]] PathView path() const { return {tip.t, tip.p_base}; }
};

void segment(const InputOptions& options, Prepared& prepared) {
  prepared.found = segment_contacts(prepared.series.t_force, prepared.series.force_base,
                                    prepared.tip.t, prepared.tip.p_base, options.segmentation);
}

void take_free_force_off(const std::vector<BodySurface>& surfaces, Prepared& prepared,
                         WindowFindings& result) {
  InputSeries& series = prepared.series;
  if (prepared.tip.t.empty() || series.t_force.empty()) return;
  const std::optional<Eigen::Vector3d> free =
      free_force(series, prepared.path(), BodyPoses(series.bodies, surfaces));
  if (!free) return;
  result.free_force = free->norm();
  prepared.force_base.assign(series.force_base.begin(), series.force_base.end());
  for (Eigen::Vector3d& force : prepared.force_base) force -= *free;
  series.force_base = prepared.force_base;
}

/// The force as it was before a low pass, by the stamps as measured.
void undo_force_filter(const InputSeries& measured, const InputOptions& options, Prepared& prepared,
                       const ForceFilter& filter) {
  InputSeries& series = prepared.series;
  const bool is_shifted = !prepared.force_base.empty();
  const std::span<const Eigen::Vector3d> behind =
      is_shifted ? std::span<const Eigen::Vector3d>(prepared.force_base) : measured.force_base;
  series.t_force = measured.t_force;
  prepared.force_before_filter = without_filter(filter, series.t_force, behind);
  series.force_base = prepared.force_before_filter;
  segment(options, prepared);
}

void find_and_undo_force_filter(const InputSeries& measured, const WindowPrior& prior,
                                const InputOptions& options, Prepared& prepared,
                                WindowFindings& result) {
  const InputSeries& series = prepared.series;
  if (series.t_force.size() < 2) return;
  FilterFinding finding = find_force_filter(series.t_force, series.force_base, prepared.found);
  result.has_unknown_filter = finding.is_of_unknown_kind;
  result.force_filter = std::move(finding.filter);
  if (!result.force_filter) result.force_filter = prior.force_filter;
  if (result.force_filter) undo_force_filter(measured, options, prepared, *result.force_filter);
}

/// `end` [s]: of all streams.
void add_gaps(std::span<const double> t, double end, std::vector<StreamGap>& gaps) {
  for (const StreamGap& gap : stream_gaps(t)) {
    gaps.push_back({gap.begin - kAroundGap, gap.end + kAroundGap});
  }
  if (end > t.back() + kAroundGap) gaps.push_back({t.back(), end});
}

std::vector<StreamGap> gaps_of(const Prepared& prepared) {
  const std::span<const double> t_tool = prepared.tip.t;
  const std::span<const double> t_force = prepared.series.t_force;
  if (t_tool.empty() || t_force.empty()) return {};
  double end = std::max(t_tool.back(), t_force.back());
  for (const InputBody& body : prepared.series.bodies) {
    if (!body.tracked.empty()) end = std::max(end, body.tracked.back().t);
  }
  std::vector<StreamGap> gaps;
  add_gaps(t_tool, end, gaps);
  add_gaps(t_force, end, gaps);
  return gaps;
}

/// The clocks of such contacts would be seen shifted by what is interpolated.
bool is_near_gap(const std::vector<StreamGap>& gaps, const Contact& contact) {
  return std::any_of(gaps.begin(), gaps.end(), [&](const StreamGap& gap) {
    return gap.begin <= contact.end && gap.end >= contact.begin;
  });
}

/// [s] The shortest impact; empty where there is none. Its force and the reversal of the tool are
/// found together as they are stamped, so the clocks differ by less than it lasts.
std::optional<double> shortest_impact(const Segmentation& found) {
  std::optional<double> shortest;
  for (const Contact& contact : found.contacts) {
    if (!contact.impact) continue;
    const double duration = contact.end - contact.begin;
    shortest = std::min(shortest.value_or(duration), duration);
  }
  return shortest;
}

/// The contacts whose clocks are not shifted by what is interpolated in gaps.
Segmentation without_gaps(const Prepared& prepared) {
  Segmentation whole = prepared.found;
  std::erase_if(whole.contacts, [gaps = gaps_of(prepared)](const Contact& contact) {
    return is_near_gap(gaps, contact);
  });
  return whole;
}

void shift_force(double offset, const InputOptions& options, Prepared& prepared) {
  std::vector<double> shifted(prepared.series.t_force.begin(), prepared.series.t_force.end());
  for (double& t : shifted) t -= offset;
  prepared.t_force = std::move(shifted);
  prepared.series.t_force = prepared.t_force;
  segment(options, prepared);
}

/// A delay that force_offset does not search: about the one by touches.
TimeOffset find_large_force_offset(const TimeOffset& rough, const InputOptions& options,
                                   Prepared& prepared) {
  const std::span<const double> measured = prepared.series.t_force;
  shift_force(rough.offset, options, prepared);
  TimeOffset fine = force_offset(without_gaps(prepared), prepared.series.t_force, prepared.path());
  prepared.series.t_force = measured;
  segment(options, prepared);
  if (!fine.is_known || std::abs(fine.offset) > kMaxDisagreement * rough.std) {
    fine = rough;
    fine.is_known = rough.std < kMaxTouchStd;  // else it is a fault
    return fine;
  }
  fine.offset += rough.offset;
  return fine;
}

/// Finds the offset by touches, by the contact law, or by correlation. The offset that one of them
/// finds counts as not known where the touches contradict it.
TimeOffset find_force_offset(const std::vector<BodySurface>& surfaces, bool is_known_before,
                             const InputOptions& options, Prepared& prepared,
                             WindowFindings& result) {
  const BodyPoses poses(prepared.series.bodies, surfaces);
  const Segmentation whole = without_gaps(prepared);
  const TouchClosure& touches = result.touch_closure =
      touch_closure(whole, prepared.series, prepared.path(), poses, kMaxTouchDelay);
  if (touches.is_decisive && std::abs(touches.delay.offset) > kMinTouchDelay) {
    return find_large_force_offset(touches.delay, options, prepared);
  }
  TimeOffset found = force_offset(whole, prepared.series.t_force, prepared.path());
  const bool is_precise = touches.delay.std < kMaxTouchStd;
  if (!found.is_known && touches.is_decisive && is_precise) return touches.delay;
  if (!found.is_known && !is_known_before && !prepared.found.contacts.empty()) {
    const TimeOffset rough = penetration_offset(prepared.series, prepared.path(), poses);
    if (rough.is_known) found = rough;
  }
  const double difference = std::abs(found.offset - touches.delay.offset);
  if (touches.delay.is_known &&
      difference > kMaxDisagreement * std::hypot(found.std, touches.delay.std)) {
    found.is_known = false;
  }
  return found;
}

/// Takes off a delay that changes with time: this window's, or that of the one before.
void undo_force_drift(const WindowPrior& prior, const InputOptions& options, Prepared& prepared,
                      WindowFindings& result) {
  result.force_drift = find_drift(press_delays(without_gaps(prepared), prepared.path()));
  if (!result.force_drift) result.force_drift = prior.force_drift;
  if (!result.force_drift) return;
  const std::span<const double> measured = prepared.series.t_force;
  prepared.t_force_without_drift.assign(measured.begin(), measured.end());
  for (double& t : prepared.t_force_without_drift) t -= result.force_drift->delay(t);
  prepared.series.t_force = prepared.t_force_without_drift;
  segment(options, prepared);
}

/// Estimates the force's offset and, where it is significant, applies it.
void put_force_on_clock(const std::vector<BodySurface>& surfaces, const WindowPrior& prior,
                        const InputOptions& options, Prepared& prepared, WindowFindings& result) {
  TimeOffset found;
  if (!prepared.tip.t.empty()) {
    undo_force_drift(prior, options, prepared, result);
    found = find_force_offset(surfaces, prior.tool_to_force.is_known, options, prepared, result);
  }
  const std::optional<double> impact = shortest_impact(prepared.found);
  if (impact && std::abs(found.offset) > *impact) found.is_known = false;
  // What is left of a delay that drifts is not that of another window.
  const bool is_same = prior.tool_to_force.is_known && !result.force_drift;
  result.tool_to_force = is_same ? more_certain(prior.tool_to_force, found) : found;
  result.is_force_offset_applied =
      is_significant(result.tool_to_force, options.min_force_offset, options);
  if (!result.is_force_offset_applied) return;
  shift_force(result.tool_to_force.offset, options, prepared);
}

/// The filter whose delay is that by the contacts, where it is more certain than `by_noise`: what
/// they leave of the delay is within the std by noise.
std::optional<ForceFilter> filter_by_contacts(const ForceFilter& by_noise,
                                              const WindowFindings& found) {
  const TimeOffset& left = found.tool_to_force;
  if (found.force_drift || !left.is_known || left.std > by_noise.std) return std::nullopt;
  if (std::abs(left.offset) < left.std) return std::nullopt;
  const double delay = found.force_filter->delay + left.offset;
  if (std::abs(delay - by_noise.delay) > kMaxFilterStds * by_noise.std) return std::nullopt;
  return filter_with_delay(*found.force_filter, delay, left.std);
}

void refine_force_filter(const InputSeries& measured, const std::vector<BodySurface>& surfaces,
                         const WindowPrior& prior, const InputOptions& options, Prepared& prepared,
                         WindowFindings& result) {
  if (!result.force_filter) return;
  const ForceFilter by_noise = *result.force_filter;
  for (int i = 0; i < kFilterRefinements; ++i) {
    const std::optional<ForceFilter> better = filter_by_contacts(by_noise, result);
    if (!better) return;
    result.force_filter = better;
    undo_force_filter(measured, options, prepared, *better);
    put_force_on_clock(surfaces, prior, options, prepared, result);
  }
}

std::vector<UnusableInterval> unusable_intervals(const Prepared& prepared,
                                                 const WindowFindings& result) {
  std::vector<UnusableInterval> bad = prepared.tip.bad;
  for (const SaturatedInterval& interval : result.saturated) {
    bad.push_back({interval.begin, interval.end, "force sensor saturated"});
  }
  if (!result.force_drift || prepared.series.t_force.empty()) return bad;
  const double known = kMaxDelayStd / result.force_drift->rate_std;
  const double first = prepared.series.t_force.front(), last = prepared.series.t_force.back();
  const std::string reason = "the force's clock drifts, and its delay is not known there";
  bad.push_back({first, result.force_drift->at - known, reason});
  bad.push_back({result.force_drift->at + known, last, reason});
  std::erase_if(bad, [](const UnusableInterval& at) { return at.begin >= at.end; });
  return bad;
}

void attribute(const Prepared& prepared, const InputOptions& options, BodyPoses& poses,
               WindowFindings& result) {
  result.contacts = attribute_contacts(prepared.series, prepared.found.contacts, prepared.path(),
                                       unusable_intervals(prepared, result), options, poses);
  result.evidence = gather_evidence(prepared.series, result.contacts, prepared.path(), poses);
}

TimeOffset find_camera_offset(const Prepared& prepared, const std::vector<BodySurface>& surfaces,
                              const InputOptions& options, const WindowFindings& result) {
  // Contacts whose force points elsewhere belong to another body, or have a fault.
  std::vector<Contact> sound = result.contacts;
  leave_out_misdirected(result.evidence, sound);
  const std::vector<StreamGap> gaps = gaps_of(prepared);
  std::erase_if(sound, [&](const Contact& contact) { return is_near_gap(gaps, contact); });
  TimeOffset offset = camera_offset(prepared.series, surfaces, prepared.path(), sound,
                                    options.segmentation.slide_half_width);
  // Slides that do not determine it are not known any better without their force.
  if (offset.is_known || offset.std > 0.0) return offset;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    offset =
        more_certain(offset, motion_offset(prepared.series.bodies[i], surfaces[i], prepared.path(),
                                           prepared.tip.p_base, prepared.series.tool_radius));
  }
  return offset;
}

/// Shifts the tracked poses by the camera's offset.
void put_tracking_on_clock(double offset, Prepared& prepared) {
  for (InputBody& body : prepared.series.bodies) {
    std::vector<TrackedPose>& tracked =
        prepared.tracked.emplace_back(body.tracked.begin(), body.tracked.end());
    for (TrackedPose& pose : tracked) pose.t -= offset;
  }
  for (std::size_t i = 0; i < prepared.series.bodies.size(); ++i) {
    prepared.series.bodies[i].tracked = prepared.tracked[i];
  }
}

std::optional<InputFault> find_clock_fault(const InputSeries& measured, const Prepared& prepared,
                                           const BodyPoses& poses, const WindowFindings& result) {
  if (prepared.tip.t.empty() || measured.t_force.empty()) return std::nullopt;
  const TouchClosure& touches = result.touch_closure;
  if (touches.fits_as_written) return std::nullopt;
  const bool is_large = std::abs(touches.delay.offset) > kMinTouchDelay;
  if (touches.is_decisive && is_large && !result.is_force_offset_applied) {
    return touch_fault(touches.delay);
  }
  // This check uses the data as written: the offset has been searched in a smaller range.
  return clock_fault(measured, prepared.found, prepared.path(), poses);
}

std::vector<FrictionRatios> friction_of(const InputSeries& series,
                                        const std::vector<Contact>& contacts,
                                        const BodyPoses& poses) {
  std::vector<FrictionRatios> friction(series.bodies.size());
  for (std::size_t i = 0; i < friction.size(); ++i) {
    friction[i].is_weighed = series.bodies[i].mass.has_value();
  }
  for (const Contact& contact : contacts) {
    if (!contact.object || !contact.left_out.empty()) continue;
    if (const auto ratio = friction_ratio(series, contact, poses)) {
      friction[*contact.object].ratios.push_back(*ratio);
    }
  }
  return friction;
}

void describe_signals(const Prepared& prepared, WindowFindings& result) {
  result.tool_outliers = prepared.tip.outliers;
  result.first_outlier = prepared.tip.first_outlier;
  result.jumps = prepared.tip.jumps;
  result.force_spikes = prepared.found.spikes;
  result.force_noise = prepared.found.noise;
  for (const Eigen::Vector3d& bias : prepared.found.bias_base) {
    result.max_drift = std::max(result.max_drift, bias.norm());
  }
}

}  // namespace

WindowFindings analyse_window(const InputSeries& measured, const std::vector<BodySurface>& surfaces,
                              const WindowPrior& prior, const InputOptions& options) {
  WindowFindings result;
  Prepared prepared;
  prepared.series = measured;
  prepared.tip = clean_tip_path(measured.t_tool, measured.p_base_tip, options);
  take_free_force_off(surfaces, prepared, result);
  segment(options, prepared);
  find_and_undo_force_filter(measured, prior, options, prepared, result);
  put_force_on_clock(surfaces, prior, options, prepared, result);
  refine_force_filter(measured, surfaces, prior, options, prepared, result);
  result.saturated = find_saturation(prepared.series.t_force, measured.force_base);
  describe_signals(prepared, result);
  std::optional<BodyPoses> poses;
  poses.emplace(prepared.series.bodies, surfaces);
  attribute(prepared, options, *poses, result);
  // The force's clock is checked before the tracking's offset, which is wrong where that clock is.
  result.clock_fault = find_clock_fault(measured, prepared, *poses, result);
  result.tool_to_camera = more_certain(
      prior.tool_to_camera, prepared.tip.t.empty()
                                ? TimeOffset{}
                                : find_camera_offset(prepared, surfaces, options, result));
  result.is_camera_offset_applied =
      is_significant(result.tool_to_camera, options.min_camera_offset, options);
  if (result.is_camera_offset_applied) {
    put_tracking_on_clock(result.tool_to_camera.offset, prepared);
    poses.emplace(prepared.series.bodies, surfaces);
    attribute(prepared, options, *poses, result);
  }
  const double end = prepared.tip.t.empty() ? 0.0 : prepared.tip.t.back();
  for (std::size_t i = 0; i < measured.bodies.size(); ++i) {
    result.T_base_objects_end.push_back(poses->at(i, end));
  }
  result.placement = placement_of(prepared.series, result.contacts, prepared.path(), *poses);
  if (prepared.tip.t.empty() || measured.t_force.empty()) return result;
  result.touches = count_unit_touches(prepared.series, result.contacts, result.evidence,
                                      prepared.path(), *poses);
  leave_out_misdirected(result.evidence, result.contacts);
  result.friction = friction_of(prepared.series, result.contacts, *poses);
  const bool has_contacts = prior.has_contacts || !result.contacts.empty();
  if (!has_contacts) {
    result.approaches = approaches_of(prepared.series, prepared.path(), *poses);
  }
  return result;
}

}  // namespace pcavr
