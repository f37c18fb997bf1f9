// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/serve/content.hpp"

#include "page_files.hpp"
#include "pairing.hpp"

namespace pcavr {

struct HttpRequest {
  std::string method = {};  ///< upper case
  std::string target = {};  ///< as received
  std::string host = {};
  std::string origin = {};  ///< empty: no such header
  std::string cookie = {};
  std::string if_none_match = {};  ///< If-None-Match
  std::string body = {};
  std::string address = {};  ///< of the client
  bool accepts_gzip = false;
  bool is_loopback = false;  ///< the client is on this machine
  bool is_encrypted = false;
  std::string viewer_protocol = {};  ///< of an upgrade to a read-only one; empty: a page's
};

struct HttpResponse {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::shared_ptr<const Content> content;  ///< may be empty
};

/// The server's identity and access rules.
struct ServerInfo {
  std::string version;
  std::string scene;
  bool is_replay = false;
  std::vector<std::string> host_names;  ///< allowed in `Host`, besides IP addresses
  bool needs_pairing = false;           ///< of clients on other machines
};

/// Handles HTTP requests, without sockets: access control and routing. Thread-safe.
class HttpHandler {
 public:
  /// Keeps a reference to `scene`, which must outlive it.
  HttpHandler(ServerInfo info, const ContentSource& scene, std::filesystem::path page,
              Pairing pairing);

  [[nodiscard]] HttpResponse respond(const HttpRequest& request);
  /// The error response to a WebSocket upgrade request; empty if the upgrade is allowed.
  [[nodiscard]] std::optional<HttpResponse> reject_upgrade(const HttpRequest& request) const;
  /// The response to plain HTTP on a TLS port: to the same path, where `Host` is this server.
  [[nodiscard]] HttpResponse redirect_to_https(const HttpRequest& request) const;
  /// A JSON body with the reason.
  [[nodiscard]] static HttpResponse error_response(unsigned status, const std::string& reason);

  /// The pairing code; empty if no pairing is needed.
  [[nodiscard]] const std::string& code() const { return code_; }

 private:
  [[nodiscard]] std::optional<HttpResponse> reject_cross_origin(const HttpRequest& request) const;
  [[nodiscard]] bool is_ours(const std::string& host) const;
  [[nodiscard]] bool is_paired(const HttpRequest& request) const;
  /// The address that opens the page on another machine with the code entered: the one by which
  /// this client came. Empty where it is that of this machine alone, or no code is needed.
  [[nodiscard]] std::string address_with_code(const HttpRequest& request) const;
  [[nodiscard]] HttpResponse code_picture(const HttpRequest& request) const;
  [[nodiscard]] HttpResponse session(const HttpRequest& request) const;
  [[nodiscard]] HttpResponse pair(const HttpRequest& request);
  [[nodiscard]] HttpResponse fetch(const ContentSource& source, const std::string& path,
                                   const HttpRequest& request) const;

  ServerInfo info_;
  const ContentSource& scene_;
  PageFiles page_;
  Pairing pairing_;
  std::string code_;
};

}  // namespace pcavr
