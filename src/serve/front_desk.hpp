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
  std::string method = {};  ///< in capitals
  std::string target = {};  ///< as it came
  std::string host = {};
  std::string origin = {};  ///< empty: none was named
  std::string cookie = {};
  std::string known_tag = {};  ///< If-None-Match
  std::string body = {};
  std::string address = {};  ///< of who asks
  bool accepts_gzip = false;
  bool is_loopback = false;  ///< asked from this machine
  bool is_encrypted = false;
};

struct HttpAnswer {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> headers;
  std::shared_ptr<const Content> content;  ///< may be empty
};

/// What the front desk knows of the house.
struct HouseFacts {
  std::string version;
  std::string scene;
  bool is_replay = false;
  std::vector<std::string> host_names;  ///< by which it may be asked for, besides addresses
  bool needs_pairing = false;           ///< of who does not ask from this machine
};

/// Answers to HTTP, without a socket: who may see what, and where it is. Thread-safe.
class FrontDesk {
 public:
  /// Keeps a reference to `scene`, which must outlive it.
  FrontDesk(HouseFacts facts, const ContentSource& scene, std::filesystem::path page,
            Pairing pairing);

  [[nodiscard]] HttpAnswer answer(const HttpRequest& request);
  /// What to say instead of opening a WebSocket; nothing where it may be opened.
  [[nodiscard]] std::optional<HttpAnswer> refuse_live(const HttpRequest& request) const;
  /// For plain HTTP on a port that wants TLS.
  [[nodiscard]] static HttpAnswer send_to_tls(const HttpRequest& request);
  /// A line for a person and for a program.
  [[nodiscard]] static HttpAnswer refusal(unsigned status, const std::string& why);

  /// Empty where nobody needs one.
  [[nodiscard]] const std::string& code() const { return code_; }

 private:
  [[nodiscard]] std::optional<HttpAnswer> refuse_stranger(const HttpRequest& request) const;
  [[nodiscard]] bool is_paired(const HttpRequest& request) const;
  [[nodiscard]] HttpAnswer session(const HttpRequest& request) const;
  [[nodiscard]] HttpAnswer pair(const HttpRequest& request);
  [[nodiscard]] HttpAnswer fetch(const ContentSource& source, const std::string& path,
                                 const HttpRequest& request) const;

  HouseFacts facts_;
  const ContentSource& scene_;
  PageFiles page_;
  Pairing pairing_;
  std::string code_;
};

}  // namespace pcavr
