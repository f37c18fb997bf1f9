// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// A Curve25519 key pair of a site, each half as 40 characters of Z85 [ZeroMQ RFC 32], which is how
/// its files contain them.
struct LinkKeys {
  std::string public_key;
  std::string secret_key;
};

struct LinkKeyFiles {
  std::filesystem::path secret_file;  ///< FOLDER/NAME.key, mode 0600
  std::filesystem::path public_file;  ///< FOLDER/NAME.pub
};

/// Creates a key pair in two new files; creates the folder if it is missing. An Error if one of the
/// files exists, or if the name is not plain (letters, digits, '-', '_', '.').
[[nodiscard]] Expected<LinkKeyFiles> generate_link_keys(const std::filesystem::path& folder,
                                                        std::string_view name);

/// A .key file; an Error if others than its owner may read it.
[[nodiscard]] Expected<LinkKeys> read_link_keys(const std::filesystem::path& file);
/// A .pub file.
[[nodiscard]] Expected<std::string> read_public_link_key(const std::filesystem::path& file);

/// The name (of the .pub file in the folder) of an authorised public key; nothing if there is no
/// such file. Reads the folder each time: a deleted file is revoked at once.
[[nodiscard]] std::optional<std::string> find_authorized(const std::filesystem::path& folder,
                                                         std::string_view public_key);

}  // namespace pcavr
