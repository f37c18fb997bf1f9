// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pcavr::app {

/// Message that `pcavr serve` and `pcavr operator-site` print once the server accepts connections.
struct StartupInfo {
  std::vector<std::string> addresses;  ///< "http://127.0.0.1:8080/", the preferred one first
  std::uint16_t port = 0;
  std::string scene;
  std::string mode;  ///< "live" or "replay"
  std::string device;
  std::vector<std::string> objects;
  std::size_t triangles = 0;
  std::string code = {};         ///< pairing code; empty where none is needed
  bool is_terminal = false;      ///< a QR code is readable
  std::string fingerprint = {};  ///< of the certificate; empty without TLS
  bool is_local = true;          ///< reachable from this machine only
  bool has_network = true;       ///< this machine has an address that others reach
  bool is_at_localhost = true;   ///< listens on localhost, which adb reverse forwards to
  bool is_tls = false;
  std::string host_option = "--host";
  bool takes_certificate = true;  ///< --certificate and --key
};

/// Human-readable, with the three ways to connect a headset.
[[nodiscard]] std::string startup_message(const StartupInfo& info);
/// Machine-readable: one line.
[[nodiscard]] nlohmann::ordered_json startup_json(const StartupInfo& info);

}  // namespace pcavr::app
