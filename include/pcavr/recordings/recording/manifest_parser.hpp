// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "pcavr/recordings/recording/manifest.hpp"

namespace pcavr {

/// Does the same as the public function, and checks that the files in the manifest exist in
/// `folder`, unless that is empty.
[[nodiscard]] Expected<Manifest> parse_manifest(const std::string& text, const std::string& file,
                                                const std::filesystem::path& folder);

class YamlValue;

/// Calls key.fail() where `name` can't be an object's name, because files are named after it.
void expect_object_name(const std::string& name, const YamlValue& key);

}  // namespace pcavr
