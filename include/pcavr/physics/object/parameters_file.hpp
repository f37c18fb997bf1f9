// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/object/object_parameters.hpp"

namespace pcavr {

/// Reads a parameter file: by object, the keys of `truth/parameters.yaml`, each with its standard
/// deviation as KEY_std, and what the values rest on (ParameterSources). Any key may be absent; so
/// may `format`, pcavr-parameters/2, in files of older versions. Strict: unknown keys, and numbers
/// that are not finite, negative or out of range (a mass of 0, an exponent below 1) are Errors with
/// their line.
[[nodiscard]] Expected<ParameterTable> read_parameters(const std::filesystem::path& file);

/// Checks and reads the text of such a file; `file` names it in errors.
[[nodiscard]] Expected<ParameterTable> parse_parameters(const std::string& text,
                                                        const std::string& file);

/// The YAML text, the inverse of parse_parameters. `comment` lines come first.
[[nodiscard]] std::string format_parameters(const ParameterTable& table,
                                            const std::string& comment = {});

/// The member of a key of the file, "contact.stiffness" for the key stiffness of contact; null for
/// a key without a value and a standard deviation.
[[nodiscard]] std::optional<ParameterValue>* find_parameter(std::string_view key,
                                                            ObjectParameters& parameters);

/// The known parameters of an object as pairs of key and value, in the file's order: the file's
/// keys, and contact_stiffness, contact_damping and contact_exponent. Without the limit surface.
[[nodiscard]] std::vector<std::pair<std::string, ParameterValue>> list_parameters(
    const ObjectParameters& parameters);

}  // namespace pcavr
