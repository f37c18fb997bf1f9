// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/http_handler.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/serve/qr_code.hpp"

#include "serve/gzip.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

class OneFile final : public ContentSource {
 public:
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const override {
    if (path == "/scene/bad.glb") return Error{.message = "the disk is gone"};
    if (path != "/scene/a.glb") return std::shared_ptr<const Content>();
    return std::make_shared<const Content>(Content{"model/gltf-binary", gzip("a mesh"), true});
  }
};

class HttpHandlerTest : public testing::Test {
 protected:
  HttpHandlerTest() {
    const auto put = [&](const char* name, const std::string& text) {
      std::filesystem::create_directories((page_.path() / name).parent_path());
      EXPECT_TRUE(write_file(page_.path() / name, text));
    };
    put("index.html", "<title>pcavr</title>");
    put("assets/main-1a2b.js", std::string(1000, ' '));
    put(".secret", "no");
    EXPECT_TRUE(write_file(outside_.path() / "secret.txt", "no"));
    std::filesystem::create_symlink(outside_.path() / "secret.txt", page_.path() / "link.txt");
  }

  HttpHandler make_handler(bool needs_pairing = true) {
    return HttpHandler({"1.2.3", "table", false, {"workbench", "*.example.org"}, needs_pairing},
                       scene_, page_.path(), std::move(Pairing::create()).value());
  }
  static HttpRequest get(const std::string& target) {
    return {.method = "GET",
            .target = target,
            .host = "192.168.1.5:8080",
            .address = "192.168.1.9",
            .accepts_gzip = true,
            .is_encrypted = true};
  }
  static std::string header(const HttpResponse& response, const std::string& name) {
    for (const auto& [key, value] : response.headers) {
      if (key == name) return value;
    }
    return {};
  }
  static HttpResponse pair(HttpHandler& handler, const std::string& code) {
    HttpRequest request = get("/api/pair");
    request.method = "POST";
    request.body = R"({"code": ")" + code + "\"}";
    return handler.respond(request);
  }

  TemporaryFolder page_;
  TemporaryFolder outside_;
  OneFile scene_;
};

TEST_F(HttpHandlerTest, UnpairedClientGetsThePageButNotTheScene) {
  HttpHandler handler = make_handler();
  EXPECT_EQ(handler.respond(get("/")).status, 200U);
  EXPECT_EQ(handler.respond(get("/index.html?x=1")).status, 200U);
  EXPECT_EQ(handler.respond(get("/assets/main-1a2b.js")).status, 200U);
  const HttpResponse session = handler.respond(get("/api/session"));
  EXPECT_NE(session.content->body.find("\"paired\":false"), std::string::npos);
  for (const char* path : {"/scene/a.glb", "/api/scene.json", "/api/replay.bin", "/api/x"}) {
    EXPECT_EQ(handler.respond(get(path)).status, 401U) << path;
  }
  EXPECT_EQ(handler.reject_upgrade(get("/live"))->status, 401U);
}

TEST_F(HttpHandlerTest, TheCodeGivesACookieThatGrantsAccess) {
  HttpHandler handler = make_handler();
  EXPECT_EQ(pair(handler, "WRONG1").status, 403U);
  std::string code = handler.code();
  for (char& c : code) c = static_cast<char>(std::tolower(c));
  const HttpResponse paired = pair(handler, code.substr(0, 3) + "-" + code.substr(3));
  ASSERT_EQ(paired.status, 200U);
  const std::string cookie = header(paired, "Set-Cookie");
  for (const char* attribute : {"HttpOnly", "SameSite=Strict", "Secure"}) {
    EXPECT_NE(cookie.find(attribute), std::string::npos) << attribute;
  }
  HttpRequest request = get("/scene/a.glb");
  request.cookie = "other=1; " + cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(handler.respond(request).status, 200U);
  request.target = "/live";
  EXPECT_FALSE(handler.reject_upgrade(request));
  request.cookie.back() = request.cookie.back() == '0' ? '1' : '0';
  EXPECT_EQ(handler.reject_upgrade(request)->status, 401U);
}

TEST_F(HttpHandlerTest, RejectsTheRightCodeAfterFiveAttemptsInAMinute) {
  HttpHandler handler = make_handler();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(pair(handler, "WRONG1").status, 403U);
  EXPECT_EQ(pair(handler, handler.code()).status, 429U);
}

TEST_F(HttpHandlerTest, MalformedPairingIsABadRequest) {
  HttpHandler handler = make_handler();
  HttpRequest request = get("/api/pair");
  request.method = "POST";
  for (const char* body : {"", "{", "[]", "{\"code\": 5}", "{\"kode\": \"\"}"}) {
    request.body = body;
    EXPECT_EQ(handler.respond(request).status, 400U) << body;
  }
}

TEST_F(HttpHandlerTest, LoopbackClientsArePaired) {
  HttpHandler handler = make_handler();
  HttpRequest request = get("/scene/a.glb");
  request.is_loopback = true;
  EXPECT_EQ(handler.respond(request).status, 200U);
  EXPECT_EQ(make_handler(false).respond(get("/scene/a.glb")).status, 200U);
  EXPECT_TRUE(make_handler(false).code().empty());
}

TEST_F(HttpHandlerTest, OnlyAPairedClientGetsTheCodeAsAPicture) {
  HttpHandler handler = make_handler();
  HttpRequest picture = get("/api/code.svg");
  EXPECT_EQ(handler.respond(picture).status, 401U);
  const auto offers = [&](HttpRequest request) {
    request.target = "/api/session";
    return handler.respond(request).content->body.find("\"code_picture\":true") !=
           std::string::npos;
  };
  EXPECT_FALSE(offers(picture));
  const std::string cookie = header(pair(handler, handler.code()), "Set-Cookie");
  picture.cookie = cookie.substr(0, cookie.find(';'));
  EXPECT_TRUE(offers(picture));
  const HttpResponse found = handler.respond(picture);
  ASSERT_EQ(found.status, 200U);
  EXPECT_EQ(found.content->media_type, "image/svg+xml");
  EXPECT_EQ(header(found, "Cache-Control"), "no-store");
  EXPECT_EQ(found.content->body, qr_code_svg("https://192.168.1.5:8080/#code=" + handler.code()));
  // Another machine cannot use an address of this one alone.
  for (const char* host : {"localhost:8080", "127.0.0.1:8080", "[::1]:8080"}) {
    picture.host = host;
    EXPECT_FALSE(offers(picture)) << host;
    EXPECT_EQ(handler.respond(picture).status, 404U) << host;
  }
}

TEST_F(HttpHandlerTest, RejectsCrossOriginRequests) {
  HttpHandler handler = make_handler(false);
  HttpRequest request = get("/scene/a.glb");
  for (const char* origin : {"https://evil.example", "null", "http://192.168.1.5:8080",
                             "https://192.168.1.5:8081", "https://192.168.1.5:8080.evil.example"}) {
    request.origin = origin;
    EXPECT_EQ(handler.respond(request).status, 403U) << origin;
    EXPECT_TRUE(handler.reject_upgrade(request)) << origin;
  }
  request.origin = "https://192.168.1.5:8080";
  EXPECT_EQ(handler.respond(request).status, 200U);
}

TEST_F(HttpHandlerTest, ViewersOfThisMachineMayComeFromAnyOfItsPorts) {
  const HttpHandler handler = make_handler();
  HttpRequest request = get("/");
  request.viewer_protocol = "foxglove.sdk.v1";
  EXPECT_EQ(handler.reject_upgrade(request)->status, 401U) << "not paired";
  request.is_loopback = true;
  EXPECT_FALSE(handler.reject_upgrade(request));
  for (const char* origin : {"http://localhost:8080", "http://127.0.0.1", "https://[::1]:1"}) {
    request.origin = origin;
    EXPECT_FALSE(handler.reject_upgrade(request)) << origin;
  }
  for (const char* origin : {"https://evil.example", "http://localhost.evil.example:80", "null",
                             "http://localhost:80@evil.example", "file://", "http://127.0.0.1.x"}) {
    request.origin = origin;
    EXPECT_EQ(handler.reject_upgrade(request)->status, 403U) << origin;
  }
  request.origin = "http://localhost:8080";
  request.is_loopback = false;
  EXPECT_EQ(handler.reject_upgrade(request)->status, 403U) << "another machine";
  request.is_loopback = true;
  request.viewer_protocol.clear();
  request.target = "/live";
  EXPECT_EQ(handler.reject_upgrade(request)->status, 403U) << "a page commands the tool";
}

TEST_F(HttpHandlerTest, RejectsUnknownHostsAgainstDnsRebinding) {
  HttpHandler handler = make_handler(false);
  HttpRequest request = get("/");
  for (const char* host : {"evil.example:8080", "", "localhost.evil.example", "x.y.example.org"}) {
    request.host = host;
    EXPECT_EQ(handler.respond(request).status, 421U) << host;
  }
  for (const char* host : {"localhost", "LOCALHOST:8080", "[::1]:8080", "10.0.0.1", "workbench:1",
                           "lab.example.org:8080"}) {
    request.host = host;
    EXPECT_EQ(handler.respond(request).status, 200U) << host;
  }
}

TEST_F(HttpHandlerTest, NoFileOutsideThePageIsFound) {
  HttpHandler handler = make_handler(false);
  for (const char* path :
       {"/../secret.txt", "/assets/../../secret.txt", "/.secret", "/link.txt", "//etc/passwd",
        "/%2e%2e/secret.txt", "/assets", "/assets/", "/nothing.js", "", "etc/passwd"}) {
    EXPECT_EQ(handler.respond(get(path)).status, 404U) << path;
  }
}

TEST_F(HttpHandlerTest, DecompressesForClientsWithoutGzip) {
  HttpHandler handler = make_handler(false);
  HttpRequest request = get("/scene/a.glb");
  EXPECT_EQ(header(handler.respond(request), "Content-Encoding"), "gzip");
  request.accepts_gzip = false;
  const HttpResponse plain = handler.respond(request);
  EXPECT_EQ(header(plain, "Content-Encoding"), "");
  EXPECT_EQ(plain.content->body, "a mesh");
}

TEST_F(HttpHandlerTest, AnswersNotModifiedForAMatchingETag) {
  HttpHandler handler = make_handler(false);
  HttpRequest request = get("/assets/main-1a2b.js");
  const HttpResponse first = handler.respond(request);
  EXPECT_NE(header(first, "Cache-Control").find("immutable"), std::string::npos);
  request.if_none_match = header(first, "ETag");
  const HttpResponse second = handler.respond(request);
  EXPECT_EQ(second.status, 304U);
  EXPECT_EQ(second.content, nullptr);
  EXPECT_EQ(header(handler.respond(get("/")), "Cache-Control"), "no-cache");
}

TEST_F(HttpHandlerTest, UnreadableFilesAndOtherMethodsAreErrors) {
  HttpHandler handler = make_handler(false);
  EXPECT_EQ(handler.respond(get("/scene/bad.glb")).status, 500U);
  EXPECT_EQ(handler.respond(get("/scene/none.glb")).status, 404U);
  HttpRequest request = get("/");
  request.method = "DELETE";
  EXPECT_EQ(handler.respond(request).status, 405U);
  EXPECT_EQ(handler.respond(get("/live")).status, 426U);
}

TEST_F(HttpHandlerTest, RedirectsPlainHttpToHttps) {
  const HttpHandler handler = make_handler();
  HttpRequest request = get("/a?b");
  const HttpResponse response = handler.redirect_to_https(request);
  EXPECT_EQ(response.status, 308U);
  EXPECT_EQ(header(response, "Location"), "https://192.168.1.5:8080/a?b");
}

TEST_F(HttpHandlerTest, RedirectsToNoOtherHost) {
  const HttpHandler handler = make_handler();
  for (const char* host : {"evil.example", "evil.example:8080", "192.168.1.5:8080@evil.example",
                           "192.168.1.5:80@evil.example/", "192.168.1.5.evil.example", "",
                           "[::1]@evil.example", "[::1", "localhost:", "localhost:8080x",
                           "user@localhost", "localhost/..", "localhost:80808080"}) {
    HttpRequest request = get("/a");
    request.host = host;
    const HttpResponse response = handler.redirect_to_https(request);
    EXPECT_EQ(response.status, 421U) << host;
    EXPECT_EQ(header(response, "Location"), "") << host;
  }
  for (const char* target : {"@evil.example/", "http://evil.example/", ".evil.example", "", "*"}) {
    EXPECT_EQ(header(handler.redirect_to_https(get(target)), "Location"),
              "https://192.168.1.5:8080/")
        << target;
  }
  HttpRequest literal = get("/x");
  literal.host = "[fe80::1]:8080";
  EXPECT_EQ(header(handler.redirect_to_https(literal), "Location"), "https://[fe80::1]:8080/x");
}

TEST(Pairing, EachServerHasItsOwnCode) {
  const std::string one = std::move(Pairing::create()).value().code();
  const std::string other = std::move(Pairing::create()).value().code();
  EXPECT_EQ(one.size(), 6U);
  EXPECT_NE(one, other);
}

TEST(Pairing, LimitsAttemptsPerMinuteByAddressAndInTotal) {
  Pairing pairing = std::move(Pairing::create()).value();
  using Outcome = Pairing::Outcome;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(pairing.pair("x", "a", 0.0)->outcome, Outcome::wrong);
  EXPECT_EQ(pairing.pair("x", "a", 59.0)->outcome, Outcome::too_many_attempts);
  EXPECT_EQ(pairing.pair("x", "a", 61.0)->outcome, Outcome::wrong);
  int attempts = 0;
  for (int i = 0; i < 100; ++i) {
    const std::string address = "b" + std::to_string(i % 20);
    attempts += pairing.pair("x", address, 62.0)->outcome == Outcome::wrong ? 1 : 0;
  }
  EXPECT_EQ(attempts, 29);
}

TEST(Pairing, CanNotBeKeptFromAnyoneByOthers) {
  Pairing pairing = std::move(Pairing::create()).value();
  using Outcome = Pairing::Outcome;
  for (int i = 0; i < 600; ++i) {
    static_cast<void>(pairing.pair("x", "10.0.0." + std::to_string(i % 60), 0.0));
  }
  EXPECT_EQ(pairing.pair("x", "10.0.0.7", 1.0)->outcome, Outcome::too_many_attempts);
  EXPECT_EQ(pairing.pair(pairing.code(), "192.168.1.9", 1.0)->outcome, Outcome::paired);
}

TEST(Pairing, CountsTheAddressesOfAnIpv6NetworkAsOne) {
  Pairing pairing = std::move(Pairing::create()).value();
  int attempts = 0;
  for (int i = 0; i < 100; ++i) {
    const auto answer = pairing.pair("x", "2001:db8:1:2::" + std::to_string(i), 0.0);
    attempts += answer->outcome == Pairing::Outcome::wrong ? 1 : 0;
  }
  EXPECT_EQ(attempts, 5);
  EXPECT_EQ(pairing.pair("x", "2001:db8:1:3::1", 0.0)->outcome, Pairing::Outcome::wrong);
}

TEST(LoadOrCreateCertificate, CoversThisMachineAndIsKeptWithAPrivateKey) {
  const TemporaryFolder folder;
  const auto files = load_or_create_certificate(folder.path() / "pcavr");
  ASSERT_TRUE(files) << files.error().to_string();
  const auto info = read_certificate(files->certificate);
  ASSERT_TRUE(info);
  EXPECT_NEAR(info->days_left, 396.0, 0.1);
  EXPECT_EQ(info->fingerprint.size(), 95U);
  std::vector<std::string> required = machine_addresses();
  required.insert(required.end(), {"localhost", "127.0.0.1", "::1"});
  for (const std::string& name : required) {
    EXPECT_NE(std::find(info->names.begin(), info->names.end(), name), info->names.end()) << name;
  }
  EXPECT_EQ(std::filesystem::status(files->key).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const auto again = load_or_create_certificate(folder.path() / "pcavr");
  ASSERT_TRUE(again);
  EXPECT_EQ(read_certificate(again->certificate)->fingerprint, info->fingerprint);
}

TEST(LoadOrCreateCertificate, ReplacesOneWithAnotherKey) {
  const TemporaryFolder folder;
  const auto files = load_or_create_certificate(folder.path() / "one");
  const auto others = load_or_create_certificate(folder.path() / "other");
  ASSERT_TRUE(files && others);
  const std::string before = read_certificate(files->certificate)->fingerprint;
  for (const std::string& key : {read_file(others->key).value(), std::string()}) {
    EXPECT_TRUE(write_file(files->key, key));
    ASSERT_TRUE(load_or_create_certificate(folder.path() / "one"));
    EXPECT_NE(read_certificate(files->certificate)->fingerprint, before);
    EXPECT_NE(read_file(files->key).value(), key);
  }
}

TEST(LoadOrCreateCertificate, ReplacesAnInvalidOne) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file(folder.path() / "certificate.pem", "nonsense"));
  EXPECT_TRUE(write_file(folder.path() / "key.pem", "nonsense"));
  EXPECT_FALSE(read_certificate(folder.path() / "certificate.pem"));
  const auto files = load_or_create_certificate(folder.path());
  ASSERT_TRUE(files);
  EXPECT_TRUE(read_certificate(files->certificate));
}

}  // namespace
}  // namespace pcavr
