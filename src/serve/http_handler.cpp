// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "http_handler.hpp"

#include <algorithm>
#include <cctype>
#include <functional>

#include <arpa/inet.h>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/qr_code.hpp"

#include "content_text.hpp"
#include "gzip.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr char kCookie[] = "pcavr_session=";
// Limit against decompression bombs: a scene's mesh of 5 million triangles is 200 MB.
constexpr std::size_t kMaxDecompressedBytes = std::size_t{1} << 30;

HttpResponse json_response(unsigned status, const ordered_json& json) {
  return {status,
          {{"Cache-Control", "no-store"}},
          std::make_shared<const Content>(Content{kJsonMedia, json_text(json) + '\n', false})};
}

/// "host:port" without the port; an IPv6 address without its brackets. Empty where it is neither:
/// of "host:1@other" a browser would go to the other.
std::string name_of_host(const std::string& host) {
  const bool has_brackets = host.starts_with('[');
  const std::size_t found = has_brackets ? host.find(']') : host.find(':');
  if (has_brackets && found == host.npos) return {};
  const std::size_t end = std::min(found, host.size());
  const std::string rest = host.substr(has_brackets ? end + 1 : end);
  const bool is_port = rest.empty() || (rest.size() > 1 && rest.size() <= 6 && rest[0] == ':' &&
                                        rest.find_first_not_of("0123456789", 1) == rest.npos);
  if (!is_port) return {};
  return has_brackets ? host.substr(1, end - 1) : host.substr(0, end);
}

bool is_address(const std::string& name) {
  in6_addr address{};
  return ::inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

bool equals_ignoring_case(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

/// `known` may begin with "*.", as a certificate's names do: a wildcard for one label.
bool is_host(const std::string& name, const std::string& known) {
  if (!known.starts_with("*.")) return equals_ignoring_case(name, known);
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && equals_ignoring_case(name.substr(dot), known.substr(1));
}

/// A page that this machine serves, at any port: a viewer that runs here.
bool is_on_this_machine(const std::string& origin) {
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string::npos) return false;
  const std::string name = name_of_host(origin.substr(scheme + 3));
  return name == "localhost" || name == "127.0.0.1" || name == "::1";
}

HttpResponse unknown_host() {
  return HttpHandler::error_response(421, "unknown host: use the address that the server printed");
}

std::string token_in(const std::string& cookie) {
  const std::size_t found = cookie.find(kCookie);
  if (found == std::string::npos) return {};
  const std::size_t begin = found + sizeof kCookie - 1;
  return cookie.substr(begin, cookie.find(';', begin) - begin);
}

std::string etag_of(const Content& content) {
  return fmt::format("\"{:x}-{:x}\"", std::hash<std::string>{}(content.body), content.body.size());
}

std::string path_of(const std::string& target) {
  return target.substr(0, target.find_first_of("?#"));
}

}  // namespace

HttpHandler::HttpHandler(ServerInfo info, const ContentSource& scene, std::filesystem::path page,
                         Pairing pairing)
    : info_(std::move(info)),
      scene_(scene),
      page_(std::move(page)),
      pairing_(std::move(pairing)),
      code_(info_.needs_pairing ? pairing_.code() : std::string()) {}

HttpResponse HttpHandler::error_response(unsigned status, const std::string& reason) {
  return json_response(status, {{"error", reason}});
}

HttpResponse HttpHandler::redirect_to_https(const HttpRequest& request) const {
  if (!is_ours(request.host)) return unknown_host();
  HttpResponse response = error_response(308, "this port requires https");
  // A target that is no path would be read as the end of the host.
  const std::string path = request.target.starts_with('/') ? request.target : "/";
  response.headers.emplace_back("Location", "https://" + request.host + path);
  return response;
}

/// An address, or a name of this server: a page of another site can't have a browser send it.
bool HttpHandler::is_ours(const std::string& host) const {
  const std::string name = name_of_host(host);
  return is_address(name) || equals_ignoring_case(name, "localhost") ||
         std::any_of(info_.host_names.begin(), info_.host_names.end(),
                     [&](const std::string& known) { return is_host(name, known); });
}

bool HttpHandler::is_paired(const HttpRequest& request) const {
  return !info_.needs_pairing || request.is_loopback ||
         pairing_.is_paired(token_in(request.cookie));
}

/// Rejects cross-site requests (CSRF) by `Origin`, and DNS rebinding by `Host`: a page of another
/// site that a browser has loaded must not reach this server.
std::optional<HttpResponse> HttpHandler::reject_cross_origin(const HttpRequest& request) const {
  if (!is_ours(request.host)) return unknown_host();
  const std::string own = (request.is_encrypted ? "https://" : "http://") + request.host;
  if (!request.viewer_protocol.empty() && request.is_loopback &&
      is_on_this_machine(request.origin)) {
    return std::nullopt;
  }
  if (!request.origin.empty() && !equals_ignoring_case(request.origin, own)) {
    return error_response(403, "cross-origin request");
  }
  return std::nullopt;
}

std::optional<HttpResponse> HttpHandler::reject_upgrade(const HttpRequest& request) const {
  if (auto rejected = reject_cross_origin(request)) return rejected;
  if (!is_paired(request))
    return error_response(401, "not paired: POST the code to /api/pair first");
  if (!request.viewer_protocol.empty() && path_of(request.target) == "/") return std::nullopt;
  if (path_of(request.target) != "/live") return error_response(404, "the WebSocket is at /live");
  return std::nullopt;
}

std::string HttpHandler::address_with_code(const HttpRequest& request) const {
  const std::string name = name_of_host(request.host);
  const bool is_local =
      equals_ignoring_case(name, "localhost") || name.starts_with("127.") || name == "::1";
  if (code_.empty() || is_local || !is_paired(request)) return {};
  return (request.is_encrypted ? "https://" : "http://") + request.host + "/#code=" + code_;
}

HttpResponse HttpHandler::code_picture(const HttpRequest& request) const {
  const std::string address = address_with_code(request);
  if (address.empty()) return error_response(404, "no address with a code for other machines");
  HttpResponse response;
  response.headers.emplace_back("Cache-Control", "no-store");
  response.content =
      std::make_shared<const Content>(Content{"image/svg+xml", qr_code_svg(address), false});
  return response;
}

HttpResponse HttpHandler::session(const HttpRequest& request) const {
  return json_response(200, {{"protocol", kLiveProtocolVersion},
                             {"version", info_.version},
                             {"paired", is_paired(request)},
                             {"mode", info_.is_replay ? "replay" : "live"},
                             {"code_picture", !address_with_code(request).empty()},
                             {"scene", info_.scene}});
}

HttpResponse HttpHandler::pair(const HttpRequest& request) {
  const auto json = ordered_json::parse(request.body, nullptr, false);
  if (!json.is_object() || !json.contains("code") || !json["code"].is_string()) {
    return error_response(400, "expected {\"code\": \"...\"}");
  }
  const Expected<Pairing::Answer> answer =
      pairing_.pair(json["code"].get<std::string>(), request.address, LiveWorld::clock());
  if (!answer) return error_response(500, answer.error().to_string());
  if (answer->outcome == Pairing::Outcome::too_many_attempts) {
    return error_response(429, "too many attempts: wait a minute");
  }
  if (answer->outcome == Pairing::Outcome::wrong) return error_response(403, "wrong code");
  HttpResponse paired = json_response(200, {{"paired", true}});
  paired.headers.emplace_back("Set-Cookie", kCookie + answer->token +
                                                "; Path=/; HttpOnly; SameSite=Strict" +
                                                (request.is_encrypted ? "; Secure" : ""));
  return paired;
}

HttpResponse HttpHandler::fetch(const ContentSource& source, const std::string& path,
                                const HttpRequest& request) const {
  const Expected<std::shared_ptr<const Content>> found = source.find(path);
  if (!found) return error_response(500, found.error().to_string());
  if (!*found) return error_response(404, "not found");
  const std::string tag = etag_of(**found);
  HttpResponse response;
  response.headers.emplace_back("ETag", tag);
  response.headers.emplace_back("Vary", "Accept-Encoding");
  // The names of built assets contain a hash of their content.
  response.headers.emplace_back("Cache-Control", path.starts_with("/assets/")
                                                     ? "public, max-age=31536000, immutable"
                                                     : "no-cache");
  if (request.if_none_match.find(tag) != std::string::npos) {
    response.status = 304;
    return response;
  }
  response.content = *found;
  if (!response.content->is_gzipped) return response;
  if (request.accepts_gzip) {
    response.headers.emplace_back("Content-Encoding", "gzip");
    return response;
  }
  std::optional<std::string> plain = gunzip(response.content->body, kMaxDecompressedBytes);
  if (!plain) return error_response(500, "can't decompress " + path);
  response.content = std::make_shared<const Content>(
      Content{response.content->media_type, std::move(*plain), false});
  return response;
}

HttpResponse HttpHandler::respond(const HttpRequest& request) {
  if (auto rejected = reject_cross_origin(request)) return *rejected;
  const std::string path = path_of(request.target);
  if (path == "/api/pair" && request.method == "POST") return pair(request);
  if (request.method != "GET" && request.method != "HEAD") {
    return error_response(405, "only GET and HEAD are allowed, and POST at /api/pair");
  }
  if (path == "/api/session") return session(request);
  if (path == "/live") return error_response(426, "/live requires a WebSocket upgrade");
  const bool is_scene = path.starts_with("/api/") || path.starts_with("/scene/");
  if (!is_scene) return fetch(page_, path, request);
  if (!is_paired(request))
    return error_response(401, "not paired: POST the code to /api/pair first");
  if (path == "/api/code.svg") return code_picture(request);
  return fetch(scene_, path, request);
}

}  // namespace pcavr
