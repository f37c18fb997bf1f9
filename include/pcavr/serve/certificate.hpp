// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/core/expected.hpp"

namespace pcavr {

/// PEM files.
struct TlsFiles {
  std::filesystem::path certificate;  ///< with its chain, the server's own first
  std::filesystem::path key;
};

/// This machine's addresses on its networks, as numbers; loopback left out.
[[nodiscard]] std::vector<std::string> machine_addresses();
/// By which it may be asked for: its name, and that with ".local".
[[nodiscard]] std::vector<std::string> machine_names();

/// $XDG_DATA_HOME/pcavr, or ~/.local/share/pcavr.
[[nodiscard]] std::filesystem::path data_folder();

/// A certificate that this machine signs for itself, for localhost, its names and its addresses:
/// the one that is kept in `folder` where it still serves for all of them and another week, else a
/// new one for 397 days (more than that, browsers refuse). The key is its owner's alone to read.
[[nodiscard]] Expected<TlsFiles> own_certificate(const std::filesystem::path& folder);

struct CertificateFacts {
  std::vector<std::string> names;  ///< that it is for; addresses as numbers
  std::string fingerprint;         ///< SHA-256, as browsers show it: "AB:CD:..."
  double days_left = 0.0;
};
[[nodiscard]] Expected<CertificateFacts> read_certificate(const std::filesystem::path& file);

}  // namespace pcavr
