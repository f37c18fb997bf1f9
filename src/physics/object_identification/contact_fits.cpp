// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "physics/object_identification/contact_fits.hpp"

#include <utility>

namespace pcavr {
namespace {

void append(std::span<const double> values, std::vector<double>& inputs) {
  inputs.push_back(static_cast<double>(values.size()));
  inputs.insert(inputs.end(), values.begin(), values.end());
}

void append(std::span<const ForceMotion> contacts, std::vector<double>& inputs) {
  constexpr double kNoNoise = -1.0;  // where it is to be estimated
  inputs.push_back(static_cast<double>(contacts.size()));
  for (const ForceMotion& contact : contacts) {
    append(contact.t, inputs);
    append(contact.tool, inputs);
    append(contact.force, inputs);
    inputs.push_back(contact.tool_noise.value_or(kNoNoise));
  }
}

}  // namespace

ContactIdentification ContactFits::fit(std::span<const ForceMotion> contacts,
                                       const ContactFitOptions& options,
                                       std::span<const ForceMotion> local) {
  std::vector<double> inputs{options.is_surface_shared ? 1.0 : 0.0, options.exponent.value_or(0.0),
                             options.exponent_std};
  append(contacts, inputs);
  append(local, inputs);
  {
    const std::lock_guard lock(mutex_);
    for (const Entry& entry : entries_) {
      if (entry.inputs == inputs) return entry.found;
    }
  }
  ContactIdentification found = identify_contact(contacts, options, local);
  const std::lock_guard lock(mutex_);
  entries_[oldest_] = {std::move(inputs), found};
  oldest_ = (oldest_ + 1) % entries_.size();
  return found;
}

}  // namespace pcavr
