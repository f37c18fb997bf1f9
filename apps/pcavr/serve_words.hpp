// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pcavr::app {

/// What is said once a server answers.
struct ServeFacts {
  std::vector<std::string> addresses;  ///< "http://127.0.0.1:8080/", the first the best
  std::uint16_t port = 0;
  std::string scene;
  std::string mode;  ///< "live" or "replay"
  std::string device;
  std::vector<std::string> objects;
  std::size_t triangles = 0;
  std::string code = {};         ///< empty where nobody needs one
  std::string fingerprint = {};  ///< of the certificate; empty without TLS
  bool is_local = true;          ///< this machine alone can reach it
  bool is_at_localhost = true;   ///< a cable ends there
  bool is_tls = false;
};

/// For a person, the three ways to get a headset in among it.
[[nodiscard]] std::string ready_words(const ServeFacts& facts);
/// For a program: one line.
[[nodiscard]] nlohmann::ordered_json ready_json(const ServeFacts& facts);

}  // namespace pcavr::app
