// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/random.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"

namespace pcavr {

using Contacts = std::vector<std::shared_ptr<const Contact>>;

/// The contacts with object `index`, each with the path and the poses around it.
inline Contacts with_motion(const std::vector<Contact>& contacts, std::size_t index,
                            const std::vector<double>& t_tool,
                            const std::vector<Eigen::Vector3d>& p_base_tip,
                            const std::vector<TrackedPose>& tracked) {
  constexpr double kMargin = 0.3;  // [s] of the path before and after a contact
  Contacts result;
  for (const Contact& contact : contacts) {
    if (contact.object != index) continue;
    auto one = std::make_shared<Contact>(contact);
    const auto is_near = [&](double t) {
      return t >= contact.begin - kMargin && t <= contact.end + kMargin;
    };
    const double from = result.empty() ? 0.0 : result.back()->t_tool.back();
    for (std::size_t i = 0; i < t_tool.size(); ++i) {
      if (!is_near(t_tool[i]) || t_tool[i] <= from) continue;
      one->t_tool.push_back(t_tool[i]);
      one->p_base_tip.push_back(p_base_tip[i]);
    }
    for (const TrackedPose& pose : tracked) {
      if (is_near(pose.t) && pose.t > from) one->tracked.push_back(pose);
    }
    result.push_back(std::move(one));
  }
  return result;
}

/// Each parameter's value and std, as text with all digits.
inline std::string digits_of(const ObjectIdentification& found) {
  std::string text;
  for (const ParameterFinding& row : found.findings) {
    text += row.name + ' ' + std::to_string(row.is_excited);
    for (const double value : {row.value, row.std.value_or(-1.0)}) {
      text += ' ' + std::to_string(std::bit_cast<std::uint64_t>(value));
    }
    text += '\n';
  }
  return text;
}

/// The contacts in a random order.
inline Contacts shuffled(Contacts contacts, Random& random) {
  for (std::size_t i = contacts.size(); i > 1; --i) {
    const auto other = static_cast<std::size_t>(random.uniform() * static_cast<double>(i));
    std::swap(contacts[i - 1], contacts[other]);
  }
  return contacts;
}

}  // namespace pcavr
