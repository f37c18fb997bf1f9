// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "force_errors.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

void add(const ForceSample& sample, double min_relative_force, ForceErrorList& errors) {
  const double difference = sample.rendered - sample.measured;
  errors.difference.push_back(difference);
  if (sample.measured >= min_relative_force) {
    errors.relative.push_back(std::abs(difference) / sample.measured);
  }
}

/// Moving means of both forces. Each is summed anew: running sums would add rounding errors, by
/// which a plateau would have its maximum anywhere.
std::vector<ForceSample> averaged(const std::vector<ForceSample>& samples, double half_width) {
  const Duration reach = duration_from_seconds(half_width);
  std::vector<ForceSample> means = samples;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    while (samples[i].stamp - samples[begin].stamp > reach) ++begin;
    double measured = 0.0, rendered = 0.0, count = 0.0;
    for (std::size_t k = begin; k < samples.size(); ++k) {
      if (samples[k].stamp - samples[i].stamp > reach) break;
      measured += samples[k].measured;
      rendered += samples[k].rendered;
      count += 1.0;
    }
    means[i].measured = measured / count;
    means[i].rendered = rendered / count;
  }
  return means;
}

}  // namespace

std::string_view to_string(ContactTask task) {
  switch (task) {
    case ContactTask::push:
      return "push";
    case ContactTask::press:
      return "press";
    case ContactTask::slotting:
      return "slotting";
    case ContactTask::unknown:
      break;
  }
  return "unknown";
}

std::vector<double> magnitudes(const ForceErrorList& errors) {
  std::vector<double> values;
  values.reserve(errors.difference.size());
  for (const double difference : errors.difference) values.push_back(std::abs(difference));
  return values;
}

ForceErrors force_errors(const std::vector<ForceSample>& samples, const PhaseTimeline& timeline,
                         const ForceErrorOptions& options) {
  const double min_force = options.min_relative_force;
  ForceErrors errors;
  for (const ForceSample& sample : samples) {
    add(sample, min_force, errors.all);
    const std::optional<Phase> phase = phase_at(timeline, sample.stamp);
    if (!phase) continue;
    add(sample, min_force, errors.by_phase.at(static_cast<std::size_t>(*phase)));
    if (*phase != Phase::free) add(sample, min_force, errors.in_contact);
  }
  return errors;
}

std::vector<ContactPeak> contact_peaks(const std::vector<ForceSample>& samples,
                                       const ForceErrorOptions& options) {
  const Duration gap = duration_from_seconds(options.contact_gap);
  std::vector<ContactPeak> contacts;
  for (const ForceSample& sample : averaged(samples, options.peak_half_width)) {
    if (contacts.empty() || sample.stamp - contacts.back().end > gap) {
      contacts.push_back(
          {sample.stamp, sample.stamp, sample.stamp, sample.measured, sample.rendered});
    }
    ContactPeak& contact = contacts.back();
    contact.end = sample.stamp;
    if (sample.measured > contact.measured) {
      contact.measured = sample.measured;
      contact.peak = sample.stamp;
    }
    contact.rendered = std::max(contact.rendered, sample.rendered);
  }
  std::erase_if(contacts, [&](const ContactPeak& contact) {
    return contact.measured < options.min_relative_force;
  });
  return contacts;
}

bool is_soft_press(const ContactPeak& contact) {
  return contact.task == ContactTask::press && contact.travel.value_or(0.0) > kSoftTravel;
}

std::optional<double> travel_to_peak(const Trajectory& T_base_tool, const ContactPeak& contact) {
  const std::optional<Pose> from = T_base_tool.at(contact.begin);
  const std::optional<Pose> to = T_base_tool.at(contact.peak);
  if (!from || !to) return std::nullopt;
  return translation_distance(*from, *to);
}

std::optional<double> approach_speed(const Trajectory& T_base_tool, Stamp contact,
                                     const ForceErrorOptions& options) {
  const Duration before = duration_from_seconds(options.approach_time);
  const std::optional<Pose> from = T_base_tool.at(contact + -before);
  const std::optional<Pose> to = T_base_tool.at(contact);
  if (!from || !to) return std::nullopt;
  return translation_distance(*from, *to) / to_seconds(before);
}

}  // namespace pcavr
