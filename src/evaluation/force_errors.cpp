// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "force_errors.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

constexpr Duration kBetweenContacts = std::chrono::milliseconds(50);

void add(const ForceSample& sample, ForceErrorList& errors) {
  const double difference = sample.rendered - sample.measured;
  errors.difference.push_back(difference);
  if (sample.measured >= kMinRelativeForce) {
    errors.relative.push_back(std::abs(difference) / sample.measured);
  }
}

}  // namespace

std::vector<double> magnitudes(const ForceErrorList& errors) {
  std::vector<double> values;
  values.reserve(errors.difference.size());
  for (const double difference : errors.difference) values.push_back(std::abs(difference));
  return values;
}

ForceErrors force_errors(const std::vector<ForceSample>& samples, const PhaseTimeline& timeline) {
  ForceErrors errors;
  for (const ForceSample& sample : samples) {
    add(sample, errors.all);
    const std::optional<Phase> phase = phase_at(timeline, sample.stamp);
    if (!phase) continue;
    add(sample, errors.by_phase.at(static_cast<std::size_t>(*phase)));
    if (*phase != Phase::free) add(sample, errors.in_contact);
  }
  return errors;
}

std::vector<ContactPeak> contact_peaks(const std::vector<ForceSample>& samples) {
  std::vector<ContactPeak> contacts;
  for (const ForceSample& sample : samples) {
    if (contacts.empty() || sample.stamp - contacts.back().end > kBetweenContacts) {
      contacts.push_back({sample.stamp, sample.stamp, sample.measured, sample.rendered});
    }
    ContactPeak& contact = contacts.back();
    contact.end = sample.stamp;
    contact.measured = std::max(contact.measured, sample.measured);
    contact.rendered = std::max(contact.rendered, sample.rendered);
  }
  std::erase_if(contacts,
                [](const ContactPeak& contact) { return contact.measured < kMinRelativeForce; });
  return contacts;
}

std::optional<double> approach_speed(const Trajectory& T_base_tool, Stamp contact) {
  constexpr Duration kBefore = std::chrono::milliseconds(50);
  const std::optional<Pose> from = T_base_tool.at(contact + -kBefore);
  const std::optional<Pose> to = T_base_tool.at(contact);
  if (!from || !to) return std::nullopt;
  return translation_distance(*from, *to) / to_seconds(kBefore);
}

}  // namespace pcavr
