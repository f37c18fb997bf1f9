// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "startup_message.hpp"

#include "pcavr/base/core/utf8.hpp"
#include "pcavr/serve/qr_code.hpp"

namespace pcavr::app {
namespace {

/// Easier to read and to type; the server accepts the code with or without the hyphen.
std::string hyphenated(const std::string& code) {
  return code.substr(0, code.size() / 2) + '-' + code.substr(code.size() / 2);
}

std::string headset_instructions(const StartupInfo& info) {
  const std::string port = std::to_string(info.port);
  const std::string scheme = info.is_tls ? "https" : "http";
  std::string text = "to connect a headset's browser, use one of\n";
  if (info.is_local) {
    text += "  network    restart with " + info.host_option +
            " 0.0.0.0 --tls, then type the code shown\n";
  } else if (!info.has_network) {
    text +=
        "  network    this machine has no address: connect it to the headset's network, restart\n";
  } else {
    text += "  network    open " + info.addresses.front() +
            " there, accept the certificate, type the code\n";
  }
  if (info.is_at_localhost) {
    text += "  cable      adb reverse tcp:" + port + " tcp:" + port + ", then " + scheme +
            "://localhost:" + port + "/ there\n";
  } else {
    text += "  cable      restart without " + info.host_option +
            ", then follow the instructions shown\n";
  }
  if (info.takes_certificate) {
    text += "  your own   --host ADDRESS --certificate FILE --key FILE, both PEM\n";
  }
  return text;
}

}  // namespace

std::string startup_message(const StartupInfo& info) {
  std::string text;
  for (const std::string& address : info.addresses) {
    text += (text.empty() ? "open       " : "or         ") + address + '\n';
  }
  if (!info.code.empty()) {
    text += "code       " + hyphenated(info.code) +
            "   pairing code, entered once per browser, not on this machine\n";
  }
  if (!info.code.empty() && info.is_terminal && info.has_network) {
    text += "scan       opens the page with the code entered\n" +
            qr_code_for_terminal(info.addresses.front() + "#code=" + info.code);
  }
  if (!info.fingerprint.empty()) text += "SHA-256    " + info.fingerprint + '\n';
  text += "scene      " + printable(info.scene) + ", " + std::to_string(info.triangles) +
          " collision triangles; objects:";
  for (const std::string& object : info.objects) text += ' ' + printable(object);
  if (info.objects.empty()) text += " none";
  text += info.mode == "replay" ? "\ntool       moves as recorded\n"
                                : "\ntool       moved by " + printable(info.device) + "\n";
  return text + headset_instructions(info) + "press Ctrl-C to stop\n";
}

nlohmann::ordered_json startup_json(const StartupInfo& info) {
  return {{"port", info.port},     {"addresses", info.addresses},
          {"code", info.code},     {"fingerprint", info.fingerprint},
          {"scene", info.scene},   {"mode", info.mode},
          {"device", info.device}, {"objects", info.objects}};
}

}  // namespace pcavr::app
