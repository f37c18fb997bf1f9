// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/identification/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/signals.hpp"
#include "pcavr/physics/identification/smoothed_values.hpp"

#include "physics/identification/derivative_noise.hpp"
#include "physics/identification/first_bias.hpp"
#include "physics/identification/impact_motion.hpp"
#include "physics/identification/rests.hpp"
#include "physics/identification/touch.hpp"

namespace pcavr {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

// Half widths of the smoothing that a contact's slow rise extends beyond its threshold.
constexpr double kRiseHalfWidths = 5.0;
// Stds of the smoothed speed's noise above which an object slides: once in 30 000 samples by
// chance.
constexpr double kSpeedStds = 4.0;
// Share of the speed at which sliding begins: below it, sliding has ended (hysteresis).
constexpr double kSlideEndShare = 0.5;

/// Removes spikes, axis by axis.
Vectors despike(std::span<const Eigen::Vector3d> force, const SpikeOptions& options,
                Segmentation& result) {
  Vectors clean(force.begin(), force.end());
  for (int k = 0; k < 3; ++k) {
    const DespikedSignal signal = remove_spikes(axis_of(force, k), options);
    result.spikes += signal.spikes.size();
    result.noise = std::max(result.noise, estimate_noise_std(signal.values));
    for (std::size_t i = 0; i < clean.size(); ++i) clean[i][k] = signal.values[i];
  }
  return clean;
}

/// Size of the smoothed force; at ends and gaps, where it `is_known` not, 0.
std::vector<double> smooth_size(std::span<const double> t, const Vectors& force, double half_width,
                                std::vector<bool>& is_known) {
  std::vector<double> size(t.size(), 0.0);
  for (int k = 0; k < 3; ++k) {
    const std::vector<SmoothedSample> samples = smooth_values(t, axis_of(force, k), t, half_width);
    for (std::size_t i = 0; i < t.size(); ++i) {
      size[i] += samples[i].value * samples[i].value;
      is_known[i] = samples[i].is_valid;
    }
  }
  for (double& value : size) value = std::sqrt(value);
  return size;
}

/// Intervals above the threshold with hysteresis; short gaps closed, short intervals dropped.
std::vector<SampleRange> find_contacts(std::span<const double> t, const std::vector<double>& size,
                                       double enter, double leave, double min_duration) {
  std::vector<SampleRange> found;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (size[i] <= enter) continue;
    SampleRange range{i, i};
    while (range.begin > 0 && size[range.begin - 1] > leave) --range.begin;
    while (range.end < t.size() && size[range.end] > leave) ++range.end;
    i = range.end;
    if (!found.empty() && t[range.begin] - t[found.back().end - 1] < min_duration) {
      found.back().end = range.end;
    } else {
      found.push_back(range);
    }
  }
  std::erase_if(found,
                [&](const SampleRange& r) { return t[r.end - 1] - t[r.begin] < min_duration; });
  return found;
}

/// Finds slides by the object's speed along the push: the tool's speed less that of the
/// penetration, which is small during sliding, so that a linear stiffness is accurate enough.
std::vector<SlideInterval> find_slides(const Contact& contact, const SegmentationOptions& options) {
  std::vector<SlideInterval> slides;
  const Breakaway& breakaway = contact.breakaway;
  if (!breakaway.is_found || breakaway.stiffness <= 0.0) return slides;
  std::vector<double> object(contact.t.size());
  for (std::size_t i = 0; i < object.size(); ++i) {
    object[i] = contact.tool[i] - contact.force[i] / breakaway.stiffness;
  }
  const double interval = mean_interval(contact.t);
  const double half_width = std::max(options.slide_half_width, 3.0 * interval);
  const double noise = derivative_noise(estimate_noise_std(object), half_width, interval).rate;
  const double fast = std::max(options.slide_speed, kSpeedStds * noise);
  const std::vector<SmoothedSample> x = smooth(contact.t, object, contact.t, half_width);
  bool is_sliding = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double at = contact.t[i];
    if (at < breakaway.t_contact || at > contact.end || !x[i].is_valid) continue;
    // Before the alarm the force follows the line: a speed is only the line's misfit.
    const bool begins = !is_sliding && at >= breakaway.t_alarm && x[i].rate > fast;
    if (begins) {
      std::size_t first = i;  // back to where the speed exceeded its noise
      while (first > 0 && x[first - 1].is_valid && x[first - 1].rate > kSlideEndShare * fast)
        --first;
      slides.push_back({contact.t[first], at});
    }
    is_sliding = begins || (is_sliding && x[i].rate > kSlideEndShare * fast);
    if (is_sliding) slides.back().end = at;
  }
  std::erase_if(slides,
                [&](const SlideInterval& s) { return s.end - s.begin < options.min_duration; });
  return slides;
}

/// The filtered recording, in which contacts are searched.
struct Cleaned {
  std::span<const double> t;
  const Vectors& force;             ///< [N] base
  const std::vector<double>& size;  ///< [N] of the smoothed force
  PathView tip;
  double half_width;  ///< [s] of the smoothing
  double enter;       ///< [N] a force above is contact
  double free_time;   ///< [s] see SegmentationOptions
};

struct TipNoise {
  double own = 0.0;           ///< [m] std of the tip's samples
  double interpolated = 0.0;  ///< where it is interpolated: two neighbours average out
};

/// Noise of the tip along `direction` at the times `t`. Differences of the interpolated signal
/// would show a smaller one, or none where the tip's rate is lower than the force's.
std::optional<TipNoise> noise_of(const PathView& tip, const Eigen::Vector3d& direction,
                                 const std::vector<double>& t) {
  constexpr std::ptrdiff_t kMinSamples = 20;
  if (t.empty()) return std::nullopt;
  const std::span<const double> t_tip = tip.t();
  const auto first = std::lower_bound(t_tip.begin(), t_tip.end(), t.front());
  const auto last = std::upper_bound(first, t_tip.end(), t.back());
  if (last - first < kMinSamples) return std::nullopt;
  std::vector<double> samples;
  std::size_t at_sample = 0;
  for (auto at = first; at != last; ++at) {
    samples.push_back(tip.at(*at, at_sample).dot(direction));
  }
  double share = 0.0;  // of the samples' variance
  auto next = first;
  for (const double at : t) {
    while (next != t_tip.end() && *next < at) ++next;
    if (next == t_tip.begin() || next == t_tip.end()) {
      share += 1.0;
      continue;
    }
    const double weight = (at - *(next - 1)) / (*next - *(next - 1));
    share += weight * weight + (1.0 - weight) * (1.0 - weight);
  }
  const double own = estimate_noise_std(samples);
  return TipNoise{own, own * std::sqrt(share / static_cast<double>(t.size()))};
}

/// Tool and force along `direction` at the force's timestamps in [from, to].
struct Along {
  std::vector<double> t, tool, force;
  Vectors force_base;
  std::optional<TipNoise> noise;

  Along(const Cleaned& all, const Eigen::Vector3d& direction, double from, double to) {
    const auto begin =
        std::lower_bound(all.t.begin(), all.t.end(), std::max(from, all.tip.t().front()));
    const auto end = std::upper_bound(begin, all.t.end(), std::min(to, all.tip.t().back()));
    t.assign(begin, end);
    const auto first_force = all.force.begin() + (begin - all.t.begin());
    force_base.assign(first_force, first_force + std::ssize(t));
    tool.reserve(t.size());
    force.reserve(t.size());
    std::size_t next = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      tool.push_back(all.tip.at(t[i], next).dot(direction));
      force.push_back(force_base[i].dot(direction));
    }
    noise = noise_of(all.tip, direction, t);
  }
  /// Moves the series to the contact.
  void move_to(Contact& contact) {
    contact.t = std::move(t);
    contact.tool = std::move(tool);
    contact.force = std::move(force);
    contact.force_base = std::move(force_base);
    if (!noise) return;
    contact.tip_noise = noise->own;
    contact.tool_noise = noise->interpolated;
  }
};

/// Extrapolates begin and end to where the tool met and left the surface. The fits may use the free
/// time up to the neighbouring contacts.
void refine_limits(const Cleaned& all, double free_from, double free_to, Contact& contact) {
  const Along along(all, contact.direction_base, std::max(free_from, contact.begin - all.free_time),
                    std::min(free_to, contact.end + all.free_time));
  const std::size_t count = along.t.size();
  if (count == 0) return;
  const TouchSignals signals{along.t, along.force,
                             smooth_values(along.t, along.tool, along.t, all.half_width),
                             smooth_values(along.t, along.force, along.t, all.half_width)};
  std::size_t first = count, last = 0, peak = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const SmoothedSample& force = signals.smooth_force[i];
    if (!force.is_valid || along.t[i] < contact.begin || along.t[i] > contact.end) continue;
    if (force.value > all.enter) {
      first = std::min(first, i);
      last = i;
    }
    if (force.value > signals.smooth_force[peak].value) peak = i;
  }
  if (first >= last) return;
  contact.begin = std::min(contact.begin, touch_instant(signals, 0, first, peak));
  contact.end = std::max(contact.end, separation_instant(signals, peak, last, count - 1));
}

Contact describe(const Cleaned& all, const SampleRange& range, double free_from, double free_to,
                 const SegmentationOptions& options) {
  Contact contact;
  contact.begin = all.t[range.begin];
  contact.end = all.t[range.end - 1];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = range.begin; i < range.end; ++i) {
    sum += all.force[i];
    contact.peak_force = std::max(contact.peak_force, all.size[i]);
  }
  contact.direction_base = sum.normalized();
  const bool is_press = std::abs(sum.z()) > sum.head<2>().norm();
  Along along(all, contact.direction_base, contact.begin - options.margin,
              contact.end + options.margin);
  along.move_to(contact);
  refine_limits(all, free_from, free_to, contact);
  if (is_press) {
    contact.kind = ContactKind::press;
    return contact;
  }
  contact.breakaway = find_breakaway(contact.series(), options.breakaway);
  contact.slides = find_slides(contact, options);
  contact.kind = contact.slides.empty() ? ContactKind::push : ContactKind::slide;
  return contact;
}

/// The force without its bias, with spikes.
Vectors without_bias(std::span<const Eigen::Vector3d> force, const Vectors& bias) {
  Vectors result(force.begin(), force.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= bias[i];
  return result;
}

/// An impact at samples `range`, and its motion.
struct RangedImpact {
  SampleRange range;
  FoundImpact found;
};

/// Impacts among the pulses of the unfiltered force. A contact of `contacts` that is one is removed
/// from there; pulses within other contacts are not examined.
std::vector<RangedImpact> find_impacts(std::span<const double> t, const Vectors& raw, double noise,
                                       const PathView& tip, const SegmentationOptions& options,
                                       std::vector<SampleRange>& contacts) {
  std::vector<RangedImpact> impacts;
  for (const ForcePulse& pulse : find_pulses(t, raw, noise, options)) {
    // The next contacts on either side bound the free flight.
    double free_from = t.front(), free_to = t.back();
    auto same = contacts.end();
    bool is_part = false;
    for (auto contact = contacts.begin(); contact != contacts.end(); ++contact) {
      const bool is_apart = contact->end <= pulse.begin || contact->begin >= pulse.end;
      if (contact->end <= pulse.begin) free_from = t[contact->end - 1];
      if (contact->begin >= pulse.end) free_to = std::min(free_to, t[contact->begin]);
      if (is_apart) continue;
      // Smoothing makes a contact longer than its pulse, by its own width at both ends.
      const double duration = t[contact->end - 1] - t[contact->begin];
      is_part |= duration > options.max_impact + 4.0 * options.half_width;
      same = contact;
    }
    if (is_part) continue;
    const auto found = find_impact(pulse, t, raw, tip, free_from, free_to, noise, options);
    if (!found) continue;
    impacts.push_back({{pulse.begin, pulse.end}, *found});
    if (same != contacts.end()) contacts.erase(same);
  }
  return impacts;
}

Contact describe_impact(const Cleaned& all, const RangedImpact& impact,
                        const SegmentationOptions& options) {
  Contact contact;
  contact.begin = all.t[impact.range.begin];
  contact.end = all.t[impact.range.end - 1];
  contact.direction_base = impact.found.direction_base;
  const Eigen::Vector3d& direction = contact.direction_base;
  contact.kind =
      std::abs(direction.z()) > direction.head<2>().norm() ? ContactKind::press : ContactKind::push;
  Along along(all, direction, contact.begin - options.margin, contact.end + options.margin);
  along.move_to(contact);
  for (std::size_t i = 0; i < contact.t.size(); ++i) {
    if (contact.t[i] < contact.begin || contact.t[i] > contact.end) continue;
    contact.peak_force = std::max(contact.peak_force, contact.force[i]);
  }
  contact.impact = impact.found.motion;
  return contact;
}

}  // namespace

Segmentation segment_contacts(std::span<const double> t_force,
                              std::span<const Eigen::Vector3d> force_base,
                              std::span<const double> t_tool,
                              std::span<const Eigen::Vector3d> p_base_tip,
                              const SegmentationOptions& options) {
  PCAVR_REQUIRE(t_force.size() == force_base.size() && t_tool.size() == p_base_tip.size());
  Segmentation result;
  if (t_force.size() < 20 || t_tool.size() < 2) return result;
  const double interval = mean_interval(t_force);
  const double half_width = std::max(options.half_width, 3.0 * interval);
  const Vectors clean = despike(force_base, options.spikes, result);
  // Three axes add up: the magnitude of pure noise is rarely above sqrt(3) stds.
  const double smooth_noise =
      std::sqrt(3.0) * result.noise / std::sqrt(correlated_samples(half_width, interval));
  const double enter = std::max(options.enter_threshold * smooth_noise, options.min_force);
  const PathView tip(t_tool, p_base_tip);
  result.bias_base =
      first_bias(t_force, clean, tip, enter, options.max_drift, options.max_cable_stiffness);

  std::vector<SampleRange> contacts;
  std::vector<RangedImpact> impacts;
  std::vector<double> size;
  // Two passes: the drift is estimated anew between the contacts of the first.
  for (int pass = 0; pass < 2; ++pass) {
    result.force_base = clean;
    for (std::size_t i = 0; i < clean.size(); ++i) result.force_base[i] -= result.bias_base[i];
    std::vector<bool> is_free(t_force.size(), true);
    size = smooth_size(t_force, result.force_base, half_width, is_free);
    contacts =
        find_contacts(t_force, size, enter, options.leave_share * enter, options.min_duration);
    const Vectors raw = without_bias(force_base, result.bias_base);
    impacts = find_impacts(t_force, raw, result.noise, tip, options, contacts);
    // The spikes of an impact are its force.
    for (const RangedImpact& impact : impacts) {
      for (std::size_t i = impact.range.begin; i < impact.range.end; ++i) {
        result.force_base[i] = raw[i];
      }
    }
    if (pass == 1) break;
    // In gaps a contact may go on.
    const auto exclude = [&](const SampleRange& range) {
      // The smoothing and the slow rise of a contact extend beyond its threshold.
      const double from = t_force[range.begin] - kRiseHalfWidths * half_width;
      const double to = t_force[range.end - 1] + kRiseHalfWidths * half_width;
      for (std::size_t i = 0; i < is_free.size(); ++i) {
        if (t_force[i] >= from && t_force[i] <= to) is_free[i] = false;
      }
    };
    for (const SampleRange& range : contacts) exclude(range);
    exclude_rests(t_force, result.force_base, contacts, result.noise, options.max_drift, is_free);
    for (const RangedImpact& impact : impacts) exclude(impact.range);
    result.bias_base = track_bias(t_force, clean, is_free, options.bias_half_width);
  }
  const Cleaned all{t_force, result.force_base, size, tip, half_width, enter, options.free_time};
  // The neighbours bound a contact's free time, impacts as well.
  std::vector<SampleRange> occupied = contacts;
  for (const RangedImpact& impact : impacts) occupied.push_back(impact.range);
  for (const SampleRange& contact : contacts) {
    double free_from = t_force.front(), free_to = t_force.back();
    for (const SampleRange& other : occupied) {
      if (other.end <= contact.begin) free_from = std::max(free_from, t_force[other.end]);
      if (other.begin >= contact.end) free_to = std::min(free_to, t_force[other.begin]);
    }
    result.contacts.push_back(describe(all, contact, free_from, free_to, options));
  }
  for (const RangedImpact& impact : impacts) {
    result.contacts.push_back(describe_impact(all, impact, options));
  }
  std::stable_sort(result.contacts.begin(), result.contacts.end(),
                   [](const auto& a, const auto& b) { return a.begin < b.begin; });
  return result;
}

}  // namespace pcavr
