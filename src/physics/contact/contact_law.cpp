// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/contact/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {
namespace {

double force(const KelvinVoigt& law, const ContactMotion& motion) noexcept {
  return law.stiffness * motion.penetration + law.damping * motion.rate;
}

double force(const MassDamperSpring& law, const ContactMotion& motion) noexcept {
  return law.mass * motion.acceleration + law.damping * motion.rate +
         law.stiffness * motion.penetration;
}

// The law of any exponent. Where parameter files say 1 and mean Kelvin-Voigt, that is an
// alternative of its own here.
double force(const HuntCrossley& law, const ContactMotion& motion) noexcept {
  return penetration_power(motion.penetration, law.exponent) *
         (law.stiffness + law.damping * motion.rate);
}

bool all_at_least_zero(std::initializer_list<double> values) noexcept {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isfinite(value) && value >= 0.0; });
}

}  // namespace

double unclamped_contact_force(const ContactLaw& law, const ContactMotion& motion) noexcept {
  if (!(motion.penetration > 0.0)) return 0.0;
  if (const auto* kelvin_voigt = std::get_if<KelvinVoigt>(&law)) {
    return force(*kelvin_voigt, motion);
  }
  if (const auto* linear = std::get_if<MassDamperSpring>(&law)) return force(*linear, motion);
  return force(*std::get_if<HuntCrossley>(&law), motion);
}

double contact_force(const ContactLaw& law, const ContactMotion& motion) noexcept {
  return std::max(0.0, unclamped_contact_force(law, motion));
}

bool is_physical(const ContactLaw& law) noexcept {
  if (const auto* kelvin_voigt = std::get_if<KelvinVoigt>(&law)) {
    return all_at_least_zero({kelvin_voigt->stiffness, kelvin_voigt->damping}) &&
           kelvin_voigt->stiffness > 0.0;
  }
  if (const auto* linear = std::get_if<MassDamperSpring>(&law)) {
    return all_at_least_zero({linear->mass, linear->damping, linear->stiffness}) &&
           linear->stiffness > 0.0;
  }
  const auto& hunt_crossley = *std::get_if<HuntCrossley>(&law);
  return all_at_least_zero({hunt_crossley.stiffness, hunt_crossley.damping}) &&
         hunt_crossley.stiffness > 0.0 && std::isfinite(hunt_crossley.exponent) &&
         hunt_crossley.exponent >= 1.0;
}

}  // namespace pcavr
