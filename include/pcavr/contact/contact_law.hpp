// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

namespace pcavr {

/// The laws of a contact between a tool and a body along one direction. Plain values: any thread
/// may call any function here; nothing allocates or throws.
///
/// Signs: the penetration x [m] is positive in contact, and the force [N] is what the tool feels as
/// resistance, and the body as a push.

/// F = k x + b x'. Jumps at impact, and would pull at separation.
struct KelvinVoigt {
  double stiffness = 0.0;  ///< k [N/m], >= 0
  double damping = 0.0;    ///< b [N s/m], >= 0
};

/// F = m x'' + b x' + k x [Paper C, eq. 2]. Linear in its parameters, so easy to identify.
struct MassDamperSpring {
  double mass = 0.0;       ///< m [kg], the material that moves along, >= 0
  double damping = 0.0;    ///< b [N s/m], >= 0
  double stiffness = 0.0;  ///< k [N/m], >= 0
};

/// F = k x^n + lambda x^n x' [Hunt & Crossley 1975; paper B, eq. 1]. Neither jumps nor pulls while
/// the two part more slowly than k / lambda.
struct HuntCrossley {
  double stiffness = 0.0;  ///< k [N/m^n], >= 0
  double damping = 0.0;    ///< lambda [N s/m^(n+1)], >= 0
  double exponent = 1.5;   ///< n, >= 1; 1.5 for spheres [Hertz 1882]
};

using ContactLaw = std::variant<KelvinVoigt, MassDamperSpring, HuntCrossley>;

/// How the tool stands to the body.
struct ContactMotion {
  double penetration = 0.0;   ///< x [m], > 0 in contact
  double rate = 0.0;          ///< x' [m/s], > 0 while it deepens
  double acceleration = 0.0;  ///< x'' [m/s^2]; only MassDamperSpring looks at it
};

/// The force that may be rendered [N]: 0 out of contact, and never a pull.
[[nodiscard]] double contact_force(const ContactLaw& law, const ContactMotion& motion) noexcept;

/// The law as it is written [N], for fitting: it may pull. 0 out of contact.
[[nodiscard]] double unclamped_contact_force(const ContactLaw& law,
                                             const ContactMotion& motion) noexcept;

/// Whether all parameters are finite, none negative, the stiffness positive and the exponent >= 1.
[[nodiscard]] bool is_physical(const ContactLaw& law) noexcept;

}  // namespace pcavr
