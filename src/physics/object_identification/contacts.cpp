// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "pcavr/physics/object_identification/object_identification.hpp"

namespace pcavr {
namespace {

constexpr double kMinDampingStds = 2.0;  // a damping farther below 0 is a fit's error

}  // namespace

ParameterValue as_value(const IdentifiedParameter& parameter) {
  return {parameter.value, parameter.std};
}

std::optional<ParameterValue> damping_of(const ContactFit& fit) {
  const IdentifiedParameter& damping = fit.damping;
  // A damping that is 0 within its std may come out negative.
  if (!(damping.value > -kMinDampingStds * damping.std)) return std::nullopt;
  if (damping.is_excited) return ParameterValue{std::max(0.0, damping.value), damping.std};
  if (!(damping.std > 0.0) || !std::isfinite(damping.std)) return std::nullopt;
  // The damping is not identified, but bounded. A default, which knows the body's mass alone, was
  // up to 30 times too large on stiff bodies, and the peaks of fast presses up to 36 % too high.
  return ParameterValue{std::max(damping.std, damping.value), damping.std};
}

std::vector<Contact*> contacts_of(std::vector<Contact>& contacts, std::size_t object,
                                  bool presses) {
  std::vector<Contact*> chosen;
  for (Contact& contact : contacts) {
    const bool is_press = contact.kind == ContactKind::press;
    const bool is_usable = contact.left_out.empty() && !contact.impact;
    if (contact.object == object && is_usable && is_press == presses) {
      chosen.push_back(&contact);
    }
  }
  return chosen;
}

const FaceContact* face_of_law(const ObjectIdentification& found) {
  const FaceContact* most = nullptr;
  for (const FaceContact& face : found.faces) {
    if (face.is_usable && (most == nullptr || face.pushes > most->pushes)) most = &face;
  }
  return most;
}

void add_recordings(const std::vector<std::string>& recordings, ObjectIdentification& result) {
  std::vector<std::string>& all = result.parameters.sources.recordings;
  for (std::vector<std::string>* list : {&result.recordings, &all}) {
    list->insert(list->end(), recordings.begin(), recordings.end());
    std::ranges::sort(*list);
    list->erase(std::unique(list->begin(), list->end()), list->end());
  }
}

bool is_centred(const Contact* push) { return std::abs(push->lever) <= kMaxCentredLever; }

double curvature_std(const ContactIdentification& presses, const ContactFit& fit, double force) {
  const ContactFit& curved = presses.hunt_crossley;
  const bool is_linear = fit.regressor == ContactRegressor::mass_damper_spring;
  if (!is_linear || !curved.is_valid) return 0.0;
  const double linear_depth = force / fit.stiffness.value;
  const double depth = std::pow(force / curved.stiffness.value, 1.0 / curved.exponent.value);
  return std::abs(std::log(depth / linear_depth));
}

}  // namespace pcavr
