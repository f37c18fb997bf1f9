// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "pcavr/base/core/median.hpp"
#include "pcavr/physics/contact/hunt_crossley.hpp"
#include "pcavr/physics/prediction/body_physics.hpp"

#include "physics/object_identification/identification_steps.hpp"

namespace pcavr {
namespace {

// Shares of the force of sliding between which the tip's displacement is measured: below, noise
// decides, and above, the object creeps.
constexpr double kFrom = 0.2, kTo = 0.8;
constexpr double kExponent = 1.5;  // of a spherical tip on a flat face [Hertz]
constexpr std::size_t kMinPushes = 3;
// A displacement below so many stds of the tip's noise is not seen.
constexpr double kMinDisplacementStds = 2.0;

/// The contact that a push is loaded through.
struct Loading {
  double force = 0.0;        ///< [N] of the slide
  double penetration = 0.0;  ///< [m] there
};

/// Share of the penetration at a share of the force.
double depth_share(double force_share) { return std::pow(force_share, 1.0 / kExponent); }

std::optional<Loading> loading_of(const Contact& push) {
  std::vector<double> forces;
  for (std::size_t i = 0; i < push.t.size(); ++i) {
    if (push.t[i] >= push.begin && push.t[i] <= push.end) forces.push_back(push.force[i]);
  }
  if (forces.empty()) return std::nullopt;
  const double level = median(std::move(forces));
  const auto loaded = std::find_if(push.force.begin(), push.force.end(),
                                   [&](double force) { return force >= kTo * level; });
  if (!(level > 0.0) || loaded == push.force.end()) return std::nullopt;
  const auto to = static_cast<std::size_t>(loaded - push.force.begin());
  std::size_t from = to;
  while (from > 0 && push.force[from] > kFrom * level) --from;
  const double seen = kMinDisplacementStds * push.tip_noise.value_or(0.0);
  const double displacement = std::max(push.tool[to] - push.tool[from], seen);
  if (!(displacement > 0.0)) return std::nullopt;
  return Loading{level, displacement / (depth_share(kTo) - depth_share(kFrom))};
}

}  // namespace

bool is_contact_assumed(const ObjectParameters& parameters) {
  const std::vector<std::string>& given = parameters.sources.given;
  return parameters.contact_stiffness && !parameters.contact_stiffness->std &&
         std::find(given.begin(), given.end(), "contact.stiffness") != given.end();
}

void assume_contact_by_loading(std::vector<Contact>& contacts, std::size_t object,
                               ObjectIdentification& result) {
  ObjectParameters& parameters = result.parameters;
  if (parameters.contact_stiffness || result.is_contact_off_centre) return;
  std::vector<double> forces, penetrations;
  for (const Contact* push : contacts_of(contacts, object, false)) {
    const std::optional<Loading> loading = loading_of(*push);
    if (!loading) continue;
    forces.push_back(loading->force);
    penetrations.push_back(loading->penetration);
  }
  if (forces.size() < kMinPushes) return;
  const double penetration = median(std::move(penetrations));
  // The object moves under the load, too: the displacement is the contact's at most. One above what
  // the prediction assumes anyway, as of fast pushes, says nothing of the contact.
  if (penetration > PhysicsDefaults().penetration) return;
  parameters.contact_stiffness =
      ParameterValue{median(std::move(forces)) / penetration_power(penetration, kExponent), {}};
  parameters.contact_exponent = ParameterValue{kExponent, {}};
  parameters.contact_damping.reset();
  result.notes.push_back(
      fmt::format("contact law assumed, not identified: by the tip's displacement while pushes are "
                  "loaded, {:.2f} mm, in which the object may creep, too; press along z to "
                  "identify it",
                  1e3 * penetration));
}

}  // namespace pcavr
