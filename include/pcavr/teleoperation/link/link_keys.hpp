// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pcavr/base/core/expected.hpp"

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

/// Creates a key pair in two new files, both or none; creates the folder if it is missing. Where
/// only the .key exists, which contains both halves, its .pub is made again. An Error if the .pub
/// exists, or both, or if the name is not plain (letters, digits, '-', '_', '.').
[[nodiscard]] Expected<LinkKeyFiles> generate_link_keys(const std::filesystem::path& folder,
                                                        std::string_view name);

/// A .key file; an Error if others than its owner may read it.
[[nodiscard]] Expected<LinkKeys> read_link_keys(const std::filesystem::path& file);
/// A .pub file.
[[nodiscard]] Expected<std::string> read_public_link_key(const std::filesystem::path& file);
/// The key in the content of a .pub file; empty if it is not one.
[[nodiscard]] std::string public_link_key_in(std::string_view content);

}  // namespace pcavr
