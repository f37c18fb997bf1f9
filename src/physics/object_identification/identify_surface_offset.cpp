// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "pcavr/physics/inputs/touch.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

constexpr double kMaxGap = 0.003;      // [m] at the touch: beyond, the object was elsewhere
constexpr double kSameNormal = 0.999;  // cosine: flat faces only
constexpr double kMaxOffset = 0.001;   // [m] more is a wrong pose

}  // namespace

void identify_surface_offset(std::vector<Contact>& contacts, std::size_t index,
                             const IdentifiableObject& object, const BodySurface& surface,
                             double tool_radius, const PathView& tip,
                             ObjectIdentification& result) {
  result.parameters.contact_surface_offset.reset();
  const ContactFit& fit = result.presses.best();
  if (!fit.is_valid || result.is_exponent_given || result.impact_findings.gives_stiffness) return;
  auto presses = contacts_of(contacts, index, true);
  if (!result.is_movable) {
    const auto pushes = contacts_of(contacts, index, false);
    presses.insert(presses.end(), pushes.begin(), pushes.end());
  }
  Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < result.presses.touched.size(); ++k) {
    const Contact& contact = *presses[result.presses.touched[k]];
    const Eigen::Vector3d p_base_tip = tip.at(contact.begin);
    const Touch touch = surface.touch(object.T_base_object, p_base_tip, tool_radius);
    if (!(std::abs(touch.gap) < kMaxGap)) continue;
    if (touch.inward_base.dot(contact.direction_base) < kSameNormal) return;
    if (count == 0.0) normal_object = touch.normal_object;
    if (touch.normal_object.dot(normal_object) < kSameNormal) return;
    // Coordinates along the press: of the CAD surface, less that of the fitted law.
    sum += p_base_tip.dot(contact.direction_base) + touch.gap - fit.surface[k];
    count += 1.0;
  }
  if (count == 0.0) return;
  const double offset = sum / count;
  if (std::abs(offset) > kMaxOffset) {
    result.notes.push_back(fmt::format(
        "the surface that the presses met is {:+.1f} mm from the CAD body's: check pose, mesh and "
        "tool radius",
        1e3 * offset));
    return;
  }
  result.parameters.contact_surface_offset = offset * normal_object;
}

}  // namespace pcavr
