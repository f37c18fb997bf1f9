// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/recording/manifest.hpp"

namespace pcavr {

/// As the public function, and checks that the files that the manifest names are in `folder`,
/// unless it is empty.
[[nodiscard]] Expected<Manifest> parse_manifest(const std::string& text, const std::string& file,
                                                const std::filesystem::path& folder);

class YamlValue;

/// Fails through `key` where `name` can't be an object's name, because files bear it.
void expect_object_name(const std::string& name, const YamlValue& key);

}  // namespace pcavr
