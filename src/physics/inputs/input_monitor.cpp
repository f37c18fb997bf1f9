// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/input_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "physics/inputs/accumulated.hpp"

namespace pcavr {
namespace {

/// A stream may be later than the others by this [s] before its samples are missed.
constexpr double kMaxLatency = 5.0;
/// [s] of free time between a contact and the end of a window.
constexpr double kFreeTime = 0.5;
/// Minimum length of a window, as a share of the full one.
constexpr double kMinShare = 0.5;
/// [s] of tracking around a window, for the interpolation at its ends.
constexpr double kTrackingMargin = 1.0;

struct IndexRange {
  std::size_t begin = 0, count = 0;
};

/// The range of the stamps in [from, to).
IndexRange range_of(std::span<const double> t, double from, double to) {
  const auto begin = std::lower_bound(t.begin(), t.end(), from);
  const auto end = std::lower_bound(begin, t.end(), to);
  return {static_cast<std::size_t>(begin - t.begin()), static_cast<std::size_t>(end - begin)};
}

/// The samples of `series` in [from, to), with the bodies as they are known.
InputSeries part_of(const InputSeries& series, const std::vector<InputBody>& bodies, double from,
                    double to) {
  InputSeries part = series;
  const IndexRange tool = range_of(series.t_tool, from, to);
  part.t_tool = series.t_tool.subspan(tool.begin, tool.count);
  part.p_base_tip = series.p_base_tip.subspan(tool.begin, tool.count);
  if (!series.q_base_tool.empty()) {
    part.q_base_tool = series.q_base_tool.subspan(tool.begin, tool.count);
  }
  const IndexRange force = range_of(series.t_force, from, to);
  part.t_force = series.t_force.subspan(force.begin, force.count);
  part.force_base = series.force_base.subspan(force.begin, force.count);
  const auto is_before = [](const TrackedPose& pose, double t) { return pose.t < t; };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::span<const TrackedPose> tracked = series.bodies[i].tracked;
    const auto begin =
        std::lower_bound(tracked.begin(), tracked.end(), from - kTrackingMargin, is_before);
    const auto end = std::lower_bound(begin, tracked.end(), to + kTrackingMargin, is_before);
    part.bodies[i] = bodies[i];
    part.bodies[i].tracked = {begin, end};
  }
  return part;
}

/// The end for the window [from, to): half a second away from all contacts, unless that would make
/// it much shorter.
double end_of_window(const InputSeries& series, double from, double to,
                     const InputOptions& options) {
  const InputSeries part = part_of(series, series.bodies, from, to + kFreeTime);
  if (part.t_force.size() < 2 || part.t_tool.size() < 2) return to;
  const Segmentation found = segment_contacts(part.t_force, part.force_base, part.t_tool,
                                              part.p_base_tip, options.segmentation);
  double end = to;
  for (auto contact = found.contacts.rbegin(); contact != found.contacts.rend(); ++contact) {
    if (contact->begin - kFreeTime > end) continue;
    if (contact->end + kFreeTime <= end) break;
    end = contact->begin - kFreeTime;
  }
  return end - from > kMinShare * options.window ? end : to;
}

double first_stamp(const InputSeries& series) {
  double first = std::numeric_limits<double>::infinity();
  if (!series.t_tool.empty()) first = series.t_tool.front();
  if (!series.t_force.empty()) first = std::min(first, series.t_force.front());
  return first;
}

double last_stamp(const InputSeries& series) {
  double last = -std::numeric_limits<double>::infinity();
  if (!series.t_tool.empty()) last = series.t_tool.back();
  if (!series.t_force.empty()) last = std::max(last, series.t_force.back());
  return last;
}

/// Analyses windows one after the other.
class WindowSequence {
 public:
  WindowSequence(const std::vector<InputBody>& bodies, const InputOptions& options,
                 ContactSink sink)
      : options_(options), sink_(std::move(sink)), accumulated_(bodies) {
    for (const InputBody& body : bodies) surfaces_.emplace_back(*body.model);
  }

  /// Analyses every window of `series` that is complete. Samples before begin() are not needed
  /// again.
  void advance(const InputSeries& series) {
    if (!std::isfinite(begin_)) begin_ = first_stamp(series);
    while (last_stamp(series) >= begin_ + options_.window + kMaxLatency) {
      const double end = end_of_window(series, begin_, begin_ + options_.window, options_);
      add(series, end, accumulated_, sink_);
      begin_ = end;
    }
  }
  /// The findings with the incomplete window at the end; its contacts go to `sink`.
  [[nodiscard]] InputFindings conclude(const InputSeries& series, const ContactSink& sink) const {
    AccumulatedFindings all = accumulated_;
    if (std::isfinite(first_stamp(series))) {
      add(series, std::numeric_limits<double>::infinity(), all, sink);
    }
    return all.conclude();
  }
  [[nodiscard]] double begin() const { return begin_; }
  [[nodiscard]] const ContactSink& sink() const { return sink_; }

 private:
  void add(const InputSeries& series, double end, AccumulatedFindings& to,
           const ContactSink& sink) const {
    WindowFindings window =
        analyse_window(part_of(series, to.bodies(), begin_, end), surfaces_, to.prior(), options_);
    to.add(window);
    if (!sink) return;
    for (Contact& contact : window.contacts) sink(std::move(contact));
  }

  InputOptions options_;
  ContactSink sink_;
  std::vector<BodySurface> surfaces_;
  AccumulatedFindings accumulated_;
  double begin_ = -std::numeric_limits<double>::infinity();
};

bool is_next(double t, const std::vector<double>& stamps) {
  return std::isfinite(t) && (stamps.empty() || t > stamps.back());
}

template <typename Value>
void erase_first(std::size_t count, std::vector<Value>& values) {
  values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

struct InputMonitor::State {
  State(std::vector<InputBody> known, double radius, const InputOptions& options, ContactSink sink)
      : bodies(std::move(known)),
        tool_radius(radius),
        window(options.window),
        tracked(bodies.size()),
        sequence(bodies, options, std::move(sink)) {}

  [[nodiscard]] InputSeries series() const {
    InputSeries all{bodies, tool_radius, t_tool, p_base_tip, q_base_tool, t_force, force_base};
    for (std::size_t i = 0; i < bodies.size(); ++i) all.bodies[i].tracked = tracked[i];
    return all;
  }

  void advance() {
    sequence.advance(series());
    const double begin = sequence.begin();
    const std::size_t tool =
        range_of(t_tool, -std::numeric_limits<double>::infinity(), begin).count;
    erase_first(tool, t_tool);
    erase_first(tool, p_base_tip);
    if (!q_base_tool.empty()) erase_first(tool, q_base_tool);
    const std::size_t force =
        range_of(t_force, -std::numeric_limits<double>::infinity(), begin).count;
    erase_first(force, t_force);
    erase_first(force, force_base);
    for (std::vector<TrackedPose>& poses : tracked) {
      const auto old = std::find_if(poses.begin(), poses.end(), [&](const TrackedPose& pose) {
        return pose.t >= begin - kTrackingMargin;
      });
      poses.erase(poses.begin(), old);
    }
  }
  /// Analyses complete windows once there may be one.
  void advance_at(double t) {
    first = std::min(first, t);
    const double begin = std::isfinite(sequence.begin()) ? sequence.begin() : first;
    if (t >= begin + window + kMaxLatency) advance();
  }

  std::vector<InputBody> bodies;
  double tool_radius;
  double window;  ///< [s]
  std::vector<double> t_tool, t_force;
  std::vector<Eigen::Vector3d> p_base_tip, force_base;
  std::vector<Eigen::Quaterniond> q_base_tool;
  std::vector<std::vector<TrackedPose>> tracked;
  double first = std::numeric_limits<double>::infinity();
  WindowSequence sequence;
};

InputMonitor::InputMonitor(std::vector<InputBody> bodies, double tool_radius,
                           const InputOptions& options, ContactSink sink)
    : state_(std::make_unique<State>(std::move(bodies), tool_radius, options, std::move(sink))) {}
InputMonitor::~InputMonitor() = default;
InputMonitor::InputMonitor(InputMonitor&&) noexcept = default;
InputMonitor& InputMonitor::operator=(InputMonitor&&) noexcept = default;

void InputMonitor::add_tool(double t, const Eigen::Vector3d& p_base_tip,
                            const std::optional<Eigen::Quaterniond>& q_base_tool) {
  State& state = *state_;
  if (!is_next(t, state.t_tool) || t < state.sequence.begin()) return;
  PCAVR_REQUIRE(state.q_base_tool.size() == (q_base_tool ? state.t_tool.size() : 0U));
  state.t_tool.push_back(t);
  state.p_base_tip.push_back(p_base_tip);
  if (q_base_tool) state.q_base_tool.push_back(*q_base_tool);
  state.advance_at(t);
}

void InputMonitor::add_force(double t, const Eigen::Vector3d& force_base) {
  State& state = *state_;
  if (!is_next(t, state.t_force) || t < state.sequence.begin()) return;
  state.t_force.push_back(t);
  state.force_base.push_back(force_base);
  state.advance_at(t);
}

void InputMonitor::add_tracked(std::size_t body, const TrackedPose& pose) {
  PCAVR_REQUIRE(body < state_->tracked.size(), body, state_->tracked.size());
  std::vector<TrackedPose>& tracked = state_->tracked[body];
  if (tracked.empty() || pose.t > tracked.back().t) tracked.push_back(pose);
}

InputFindings InputMonitor::findings() const {
  return state_->sequence.conclude(state_->series(), {});
}

InputFindings InputMonitor::finish() {
  return state_->sequence.conclude(state_->series(), state_->sequence.sink());
}

InputFindings examine_inputs(const InputSeries& series, const InputOptions& options,
                             const ContactSink& sink) {
  PCAVR_REQUIRE(series.t_tool.size() == series.p_base_tip.size());
  PCAVR_REQUIRE(series.t_force.size() == series.force_base.size());
  PCAVR_REQUIRE(series.q_base_tool.empty() || series.q_base_tool.size() == series.t_tool.size());
  WindowSequence sequence(series.bodies, options, sink);
  sequence.advance(series);
  return sequence.conclude(series, sink);
}

}  // namespace pcavr
