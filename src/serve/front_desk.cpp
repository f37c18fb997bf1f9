// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "front_desk.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <functional>

#include <arpa/inet.h>

#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/live_world.hpp"

#include "content_text.hpp"
#include "core/json_text.hpp"
#include "gzip.hpp"

namespace pcavr {
namespace {

using nlohmann::ordered_json;

constexpr char kCookie[] = "pcavr_session=";
// What a compressed file may become: a scene's mesh of 5 million triangles is 200 MB.
constexpr std::size_t kMaxUnpacked = std::size_t{1} << 30;

HttpAnswer json_answer(unsigned status, const ordered_json& json) {
  return {status,
          {{"Cache-Control", "no-store"}},
          std::make_shared<const Content>(Content{kJsonMedia, json_text(json) + '\n', false})};
}

/// "host:port" without the port; an IPv6 address without its brackets.
std::string name_of_host(const std::string& host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.find(':'));
}

bool is_address(const std::string& name) {
  in6_addr place{};
  return ::inet_pton(AF_INET, name.c_str(), &place) == 1 ||
         ::inet_pton(AF_INET6, name.c_str(), &place) == 1;
}

bool is_same_word(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
    return std::tolower(x) == std::tolower(y);
  });
}

/// `known` may begin with "*.", as a certificate's names do: any one word there.
bool is_host(const std::string& name, const std::string& known) {
  if (!known.starts_with("*.")) return is_same_word(name, known);
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && is_same_word(name.substr(dot), known.substr(1));
}

std::string token_in(const std::string& cookie) {
  const std::size_t place = cookie.find(kCookie);
  if (place == std::string::npos) return {};
  const std::size_t begin = place + sizeof kCookie - 1;
  return cookie.substr(begin, cookie.find(';', begin) - begin);
}

std::string tag_of(const Content& content) {
  char tag[40];
  std::snprintf(tag, sizeof tag, "\"%zx-%zx\"", std::hash<std::string>{}(content.body),
                content.body.size());
  return tag;
}

std::string path_of(const std::string& target) {
  return target.substr(0, target.find_first_of("?#"));
}

}  // namespace

FrontDesk::FrontDesk(HouseFacts facts, const ContentSource& scene, std::filesystem::path page,
                     Pairing pairing)
    : facts_(std::move(facts)),
      scene_(scene),
      page_(std::move(page)),
      pairing_(std::move(pairing)),
      code_(facts_.needs_pairing ? pairing_.code() : std::string()) {}

HttpAnswer FrontDesk::refusal(unsigned status, const std::string& why) {
  return json_answer(status, {{"error", why}});
}

HttpAnswer FrontDesk::send_to_tls(const HttpRequest& request) {
  HttpAnswer answer = refusal(308, "this port speaks https");
  answer.headers.emplace_back("Location", "https://" + request.host + request.target);
  return answer;
}

bool FrontDesk::is_paired(const HttpRequest& request) const {
  return !facts_.needs_pairing || request.is_loopback ||
         pairing_.is_paired(token_in(request.cookie));
}

/// A page of another site that a browser was led to, under our address or under a name of its own
/// that it had point here.
std::optional<HttpAnswer> FrontDesk::refuse_stranger(const HttpRequest& request) const {
  const std::string name = name_of_host(request.host);
  const bool is_ours = is_address(name) || is_same_word(name, "localhost") ||
                       std::any_of(facts_.host_names.begin(), facts_.host_names.end(),
                                   [&](const std::string& known) { return is_host(name, known); });
  if (!is_ours) return refusal(421, "no such host here: use the address that the server printed");
  const std::string own = (request.is_encrypted ? "https://" : "http://") + request.host;
  if (!request.origin.empty() && !is_same_word(request.origin, own)) {
    return refusal(403, "asked from a page of another site");
  }
  return std::nullopt;
}

std::optional<HttpAnswer> FrontDesk::refuse_live(const HttpRequest& request) const {
  if (auto refused = refuse_stranger(request)) return refused;
  if (!is_paired(request)) return refusal(401, "not paired: POST the code to /api/pair first");
  if (path_of(request.target) != "/live") return refusal(404, "the WebSocket is at /live");
  return std::nullopt;
}

HttpAnswer FrontDesk::session(const HttpRequest& request) const {
  return json_answer(200, {{"protocol", kLiveProtocol},
                           {"version", facts_.version},
                           {"paired", is_paired(request)},
                           {"mode", facts_.is_replay ? "replay" : "live"},
                           {"scene", facts_.scene}});
}

HttpAnswer FrontDesk::pair(const HttpRequest& request) {
  const auto json = ordered_json::parse(request.body, nullptr, false);
  if (!json.is_object() || !json.contains("code") || !json["code"].is_string()) {
    return refusal(400, "expected {\"code\": \"...\"}");
  }
  const Expected<Pairing::Answer> answer =
      pairing_.pair(json["code"].get<std::string>(), request.address, LiveWorld::clock());
  if (!answer) return refusal(500, answer.error().to_string());
  if (answer->outcome == Pairing::Outcome::too_many_tries) {
    return refusal(429, "too many tries: wait a minute");
  }
  if (answer->outcome == Pairing::Outcome::wrong) return refusal(403, "not the code");
  HttpAnswer paired = json_answer(200, {{"paired", true}});
  paired.headers.emplace_back("Set-Cookie", kCookie + answer->token +
                                                "; Path=/; HttpOnly; SameSite=Strict" +
                                                (request.is_encrypted ? "; Secure" : ""));
  return paired;
}

HttpAnswer FrontDesk::fetch(const ContentSource& source, const std::string& path,
                            const HttpRequest& request) const {
  const Expected<std::shared_ptr<const Content>> found = source.find(path);
  if (!found) return refusal(500, found.error().to_string());
  if (!*found) return refusal(404, "there is nothing here");
  const std::string tag = tag_of(**found);
  HttpAnswer answer;
  answer.headers.emplace_back("ETag", tag);
  answer.headers.emplace_back("Vary", "Accept-Encoding");
  // The names of built assets carry a hash of what is in them.
  answer.headers.emplace_back("Cache-Control", path.starts_with("/assets/")
                                                   ? "public, max-age=31536000, immutable"
                                                   : "no-cache");
  if (request.known_tag.find(tag) != std::string::npos) {
    answer.status = 304;
    return answer;
  }
  answer.content = *found;
  if (!answer.content->is_gzipped) return answer;
  if (request.accepts_gzip) {
    answer.headers.emplace_back("Content-Encoding", "gzip");
    return answer;
  }
  std::optional<std::string> plain = gunzip(answer.content->body, kMaxUnpacked);
  if (!plain) return refusal(500, "can't take apart what is compressed: " + path);
  answer.content = std::make_shared<const Content>(
      Content{answer.content->media_type, std::move(*plain), false});
  return answer;
}

HttpAnswer FrontDesk::answer(const HttpRequest& request) {
  if (auto refused = refuse_stranger(request)) return *refused;
  const std::string path = path_of(request.target);
  if (path == "/api/pair" && request.method == "POST") return pair(request);
  if (request.method != "GET" && request.method != "HEAD") {
    return refusal(405, "only GET and HEAD, and POST at /api/pair");
  }
  if (path == "/api/session") return session(request);
  if (path == "/live") return refusal(426, "this is a WebSocket");
  const bool is_scene = path.starts_with("/api/") || path.starts_with("/scene/");
  if (!is_scene) return fetch(page_, path, request);
  if (!is_paired(request)) return refusal(401, "not paired: POST the code to /api/pair first");
  return fetch(scene_, path, request);
}

}  // namespace pcavr
