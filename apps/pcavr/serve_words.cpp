// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve_words.hpp"

namespace pcavr::app {
namespace {

/// Easier to read out and to type; the server takes it with or without the hyphen.
std::string in_halves(const std::string& code) {
  return code.substr(0, code.size() / 2) + '-' + code.substr(code.size() / 2);
}

std::string headset_words(const ServeFacts& facts) {
  const std::string port = std::to_string(facts.port);
  const std::string scheme = facts.is_tls ? "https" : "http";
  std::string words = "a headset's browser gets in by one of\n";
  if (facts.is_local) {
    words += "  network    end this, add --host 0.0.0.0 --tls, and type the code shown then\n";
  } else {
    words += "  network    open " + facts.addresses.front() +
             " there, accept the certificate, type the code\n";
  }
  if (facts.is_at_localhost) {
    words += "  cable      adb reverse tcp:" + port + " tcp:" + port + ", then " + scheme +
             "://localhost:" + port + "/ there\n";
  } else {
    words += "  cable      end this, leave --host away, and do as is said then\n";
  }
  words += "  your own   --host ADDRESS --certificate FILE --key FILE, both PEM\n";
  return words;
}

}  // namespace

std::string ready_words(const ServeFacts& facts) {
  std::string words;
  for (const std::string& address : facts.addresses) {
    words += (words.empty() ? "open       " : "or         ") + address + '\n';
  }
  if (!facts.code.empty()) {
    words += "code       " + in_halves(facts.code) + "   asked for once, not on this machine\n";
  }
  if (!facts.fingerprint.empty()) words += "SHA-256    " + facts.fingerprint + '\n';
  words += "scene      " + facts.scene + ", " + std::to_string(facts.triangles) +
           " triangles to feel; movable:";
  for (const std::string& object : facts.objects) words += ' ' + object;
  if (facts.objects.empty()) words += " nothing";
  words += "\ntool       moved by " + facts.device + "\n";
  return words + headset_words(facts) + "Ctrl-C ends it\n";
}

nlohmann::ordered_json ready_json(const ServeFacts& facts) {
  return {{"port", facts.port},     {"addresses", facts.addresses},
          {"code", facts.code},     {"fingerprint", facts.fingerprint},
          {"scene", facts.scene},   {"mode", facts.mode},
          {"device", facts.device}, {"objects", facts.objects}};
}

}  // namespace pcavr::app
