// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {

/// The laws of a contact between a tool and a body along one direction. Pure functions: any thread
/// may call any function here; nothing allocates or throws.
///
/// Signs: the penetration x [m] is positive in contact, and a positive force [N] pushes the body
/// away from the tool (and the tool out of the body).

/// F = k x + b x'. The force jumps at impact, and would pull at separation.
struct KelvinVoigt {
  double stiffness = 0.0;  ///< k [N/m], >= 0
  double damping = 0.0;    ///< b [N s/m], >= 0
};

/// F = m x'' + b x' + k x [Paper C, eq. 2]. Linear in its parameters, so easy to identify.
struct MassDamperSpring {
  double mass = 0.0;       ///< m [kg], the material that moves with the tool, >= 0
  double damping = 0.0;    ///< b [N s/m], >= 0
  double stiffness = 0.0;  ///< k [N/m], >= 0
};

/// HuntCrossley as an alternative is F = k x^n + lambda x^n x' for n = 1, too.
using ContactLaw = std::variant<KelvinVoigt, MassDamperSpring, HuntCrossley>;

/// The penetration of the tool into the body, and its derivatives.
struct ContactMotion {
  double penetration = 0.0;   ///< x [m], > 0 in contact
  double rate = 0.0;          ///< x' [m/s], > 0 while it increases
  double acceleration = 0.0;  ///< x'' [m/s^2]; only MassDamperSpring uses it
};

/// The force that may be rendered [N]: 0 out of contact, and never a pull.
[[nodiscard]] double contact_force(const ContactLaw& law, const ContactMotion& motion) noexcept;

/// The force by the formula [N], for fitting: it may pull. 0 out of contact.
[[nodiscard]] double unclamped_contact_force(const ContactLaw& law,
                                             const ContactMotion& motion) noexcept;

/// Whether all parameters are finite, none negative, the stiffness positive and the exponent >= 1.
[[nodiscard]] bool is_physical(const ContactLaw& law) noexcept;

}  // namespace pcavr
