// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pcavr/base/core/expected.hpp"

namespace pcavr {

/// Certificate and private key as PEM files.
struct TlsFiles {
  std::filesystem::path certificate;  ///< with its chain, the server's own first
  std::filesystem::path key;
};

/// The IP addresses of this machine's network interfaces, without loopback.
[[nodiscard]] std::vector<std::string> machine_addresses();
/// The names of this machine: its host name, alone and with ".local" (mDNS).
[[nodiscard]] std::vector<std::string> machine_names();

/// $XDG_DATA_HOME/pcavr, or ~/.local/share/pcavr.
[[nodiscard]] std::filesystem::path data_folder();

/// A self-signed certificate for localhost, this machine's names and its addresses. Loads the one
/// in `folder` if it covers all of them and is valid for another week, else creates one for 397
/// days (browsers reject longer ones). Only the owner can read the key (mode 0600).
[[nodiscard]] Expected<TlsFiles> load_or_create_certificate(const std::filesystem::path& folder);

struct CertificateInfo {
  std::vector<std::string> names;  ///< subject alternative names: DNS names and IP addresses
  std::string fingerprint;         ///< SHA-256, as browsers show it: "AB:CD:..."
  double days_left = 0.0;
};
[[nodiscard]] Expected<CertificateInfo> read_certificate(const std::filesystem::path& file);

}  // namespace pcavr
