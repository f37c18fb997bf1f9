// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/object_identification/object_identifier.hpp"

namespace pcavr {

class ContactFits;

/// The steps of ObjectIdentifier::result().

void forget_contact(ObjectParameters& parameters);
/// Removes a contact law that is not a result (ObjectIdentification::is_contact_off_centre).
void withhold_contact_off_centre(ObjectIdentification& result);

/// Presses, faces and impacts, and the estimators' comparison. `fits`: of the same options before.
void identify_contact_of(std::vector<Contact>& contacts, std::size_t object, const PathView& tip,
                         const IdentificationOptions& options, ContactFits& fits,
                         ObjectIdentification& result);
/// Estimates the stiffness by the tip's displacement while pushes are loaded, under the exponent of
/// a spherical tip, if no contact law was found, nor withheld. The object creeps meanwhile, so that
/// the estimate is too soft, by up to a half; what would be assumed instead knows nothing of the
/// object.
void assume_contact_by_loading(std::vector<Contact>& contacts, std::size_t object,
                               ObjectIdentification& result);
/// Whether `assume_contact_by_loading` gave the contact law, in this or an earlier identification.
[[nodiscard]] bool is_contact_assumed(const ObjectParameters& parameters);
/// Identifies the offset of the surface that the presses met from the CAD body's at its first pose:
/// the law is rendered from there. For presses on one flat face.
void identify_surface_offset(std::vector<Contact>& contacts, std::size_t index,
                             const IdentifiableObject& object, const BodySurface& surface,
                             double tool_radius, const PathView& tip, ObjectIdentification& result);
/// `found` is the identification from these presses.
[[nodiscard]] std::vector<EstimatorTrace> compare_estimators(std::span<const ForceMotion> presses,
                                                             const ContactIdentification& found,
                                                             const EstimatorOptions<3>& options);
/// Restitution of every impact; the damping where presses gave none, and the stiffness likewise.
/// `damping_law`: see IdentificationOptions.
void identify_impacts(const std::vector<Contact>& contacts, std::size_t object,
                      std::optional<DampingLaw> damping_law, ObjectIdentification& result);

/// The penetration at F_M by the contact law that was found, with its std beyond the forces that it
/// was found by.
void state_penetration(const ContactFitOptions& options, ObjectIdentification& result);

/// Checks each push's own line against the one that the contact law predicts, if presses gave the
/// law; adds a note where they disagree.
void check_press_lines(std::vector<Contact>& contacts, std::size_t object,
                       const BreakawayOptions& options, ObjectIdentification& result);

/// Where the force seems turned by up to `suspected_turn` [rad] and no more than a warning says so:
/// withholds the friction at the tip that was identified, as a turn looks like it, and widens the
/// stds of what the force along the motion gave, by what the turn would change it. `known`: before.
void doubt_force_direction(double suspected_turn, const ObjectParameters& known,
                           ObjectIdentification& result);

/// Where the mass by force and acceleration differs from the weighed one by more than chance,
/// widens the stds of what the force gave by what another scale of it, or another mass, would
/// change. `known`: before.
void doubt_force_scale(const IdentifiableObject& object, const ObjectParameters& known,
                       ObjectIdentification& result);

/// Fills the table of parameters: value, std, and where a parameter is not identified, the motion
/// that would identify it. `slid` [s]: how long pushes moved the object.
void state_findings(IdentificationGoal goal, const IdentifiableObject& object, double slid,
                    ObjectIdentification& found);

}  // namespace pcavr
