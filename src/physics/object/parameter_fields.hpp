// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr::parameter_file {

inline constexpr InputRange kRestitution{"restitution", 1e-3, 1.0, "1",
                                         "by definition; at 0 no damping is large enough"};
inline constexpr InputRange kImpactSpeed{"impact speed", 1e-4, 100.0, "m/s",
                                         "from a tip at rest to more than any arm"};

inline constexpr char kFormatKey[] = "format";
inline constexpr char kFormat[] = "pcavr-parameters/2";

/// Name of the law of a damping that was not computed from a restitution.
inline constexpr char kFittedDamping[] = "fitted";

/// One key, the member that stores its value, and the permitted range.
struct Field {
  const char* key;
  std::optional<ParameterValue> ObjectParameters::*member;
  InputRange range;
};

inline constexpr std::array kFields{
    Field{"mass", &ObjectParameters::mass, ranges::kMass},
    Field{"inertial_mass", &ObjectParameters::inertial_mass, ranges::kMass},
    Field{"limiting_static_friction", &ObjectParameters::limiting_static_friction,
          ranges::kStaticFriction},
    Field{"limiting_static_friction_scatter", &ObjectParameters::limiting_static_friction_scatter,
          ranges::kParameterStd},
    Field{"sliding_friction_coefficient", &ObjectParameters::sliding_friction_coefficient,
          ranges::kFrictionCoefficient},
    Field{"viscous_friction", &ObjectParameters::viscous_friction, ranges::kViscousFriction},
    Field{"friction_radius", &ObjectParameters::friction_radius, ranges::kFrictionRadius},
    Field{"tool_friction_coefficient", &ObjectParameters::tool_friction_coefficient,
          ranges::kToolFriction},
    Field{"loading_rate", &ObjectParameters::loading_rate, ranges::kLoadingRate},
};

inline constexpr std::array kContactFields{
    Field{"stiffness", &ObjectParameters::contact_stiffness, ranges::kStiffness},
    Field{"damping", &ObjectParameters::contact_damping, ranges::kDamping},
    Field{"exponent", &ObjectParameters::contact_exponent, ranges::kExponent},
    Field{"mass", &ObjectParameters::contact_mass, ranges::kMass},
    Field{"restitution", &ObjectParameters::contact_restitution, kRestitution},
    Field{"impact_speed", &ObjectParameters::contact_impact_speed, kImpactSpeed},
};

[[nodiscard]] inline std::string std_key(const Field& field) {
  return std::string(field.key) + "_std";
}

/// The row of a key, "contact.stiffness" for the key stiffness of contact; null for one that is not
/// in the file.
[[nodiscard]] const Field* field_of_key(std::string_view key);

}  // namespace pcavr::parameter_file
