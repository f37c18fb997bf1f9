// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// Does the same as the public function, and checks that the files in the manifest exist in
/// `folder`, unless that is empty.
[[nodiscard]] Expected<Manifest> parse_manifest(const std::string& text, const std::string& file,
                                                const std::filesystem::path& folder);

class YamlValue;

namespace ranges {

inline constexpr InputRange kDepthOffset{"depth offset", -1.0, 1.0, "m",
                                         "no sensor is off by more where it measures"};
inline constexpr InputRange kMeshUnit{"unit of a mesh", 1e-6, 1e3, "m",
                                      "from a micrometre to a kilometre"};

}  // namespace ranges

// Parts of a manifest, which calibrations have, too. All fail at the value that is wrong.

/// A map of t [m] and q (x y z w).
[[nodiscard]] Pose pose_of(const YamlValue& value);
/// [m] of a mesh's coordinates: m, cm, mm, in, or a number.
[[nodiscard]] double mesh_unit_of(const YamlValue& value);
/// A tag; whether its object is declared is not checked.
[[nodiscard]] MarkerEntry marker_of(const YamlValue& value);
/// Adds it to the manifest; fails where it is there already, and where its object is not declared.
void add_marker(const YamlValue& value, Manifest& manifest);

/// Calls key.fail() where `name` can't be an object's name, because files are named after it.
void expect_object_name(const std::string& name, const YamlValue& key);

}  // namespace pcavr
