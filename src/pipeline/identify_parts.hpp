// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/identification/path_view.hpp"
#include "pcavr/pipeline/identify.hpp"
#include "pcavr/turning/body_motion.hpp"

namespace pcavr {

/// The steps of identify().

void forget_contact(ObjectParameters& parameters);
/// Removes a contact law that is not a result (ObjectIdentification::is_contact_off_centre).
void withhold_contact_off_centre(ObjectIdentification& result);

/// Presses, faces and impacts, and the estimators' comparison.
void identify_contact_of(std::vector<IdentifiedContact>& contacts, std::size_t object,
                         const PathView& tip, const IdentificationOptions& options,
                         ObjectIdentification& result);
/// Where no contact law was found, nor withheld: the stiffness by the tip's displacement while
/// pushes are loaded, under the exponent of a spherical tip. The object creeps meanwhile, so that
/// it is too soft, by up to a half; what would be assumed instead knows nothing of the object.
void assume_contact_by_loading(std::vector<IdentifiedContact>& contacts, std::size_t object,
                               ObjectIdentification& result);
/// Whether `assume_contact_by_loading` gave the contact law, in this or an earlier identification.
[[nodiscard]] bool is_contact_assumed(const ObjectParameters& parameters);
/// Where the presses met the surface, beside the CAD body's at its first pose: the law is rendered
/// from there. For presses on one flat face.
void identify_surface_offset(std::vector<IdentifiedContact>& contacts, std::size_t index,
                             const IdentifiableObject& object, double tool_radius,
                             const PathView& tip, ObjectIdentification& result);
/// `found` is the identification from these presses.
[[nodiscard]] std::vector<EstimatorTrace> compare_estimators(std::span<const ForceMotion> presses,
                                                             const ContactIdentification& found,
                                                             const EstimatorOptions<3>& options);
/// Restitution of every impact; the damping where presses gave none, and the stiffness likewise.
/// `damping_law`: see IdentificationOptions.
void identify_impacts(const std::vector<IdentifiedContact>& contacts, std::size_t object,
                      std::optional<DampingLaw> damping_law, ObjectIdentification& result);

/// The penetration at F_M by the contact law that was found, with its std beyond the forces that it
/// was found by.
void state_penetration(const ContactFitOptions& options, ObjectIdentification& result);

/// Where presses gave the contact law: the line that it predicts for each push, as a check of the
/// push's own line; a note where they disagree.
void check_press_lines(std::vector<IdentifiedContact>& contacts, std::size_t object,
                       const BreakawayOptions& options, ObjectIdentification& result);

}  // namespace pcavr
