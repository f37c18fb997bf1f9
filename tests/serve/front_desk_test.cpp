// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "serve/front_desk.hpp"

#include <filesystem>

#include <gtest/gtest.h>

#include "pcavr/core/output.hpp"
#include "pcavr/serve/certificate.hpp"

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

class FrontDeskTest : public testing::Test {
 protected:
  FrontDeskTest() {
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

  FrontDesk desk(bool needs_pairing = true) {
    return FrontDesk({"1.2.3", "table", false, {"workbench", "*.example.org"}, needs_pairing},
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
  static std::string header(const HttpAnswer& answer, const std::string& name) {
    for (const auto& [key, value] : answer.headers) {
      if (key == name) return value;
    }
    return {};
  }
  static HttpAnswer pair(FrontDesk& desk, const std::string& code) {
    HttpRequest request = get("/api/pair");
    request.method = "POST";
    request.body = R"({"code": ")" + code + "\"}";
    return desk.answer(request);
  }

  TemporaryFolder page_;
  TemporaryFolder outside_;
  OneFile scene_;
};

TEST_F(FrontDeskTest, WhoIsNotPairedGetsThePageAndNothingOfTheScene) {
  FrontDesk d = desk();
  EXPECT_EQ(d.answer(get("/")).status, 200U);
  EXPECT_EQ(d.answer(get("/index.html?x=1")).status, 200U);
  EXPECT_EQ(d.answer(get("/assets/main-1a2b.js")).status, 200U);
  const HttpAnswer session = d.answer(get("/api/session"));
  EXPECT_NE(session.content->body.find("\"paired\":false"), std::string::npos);
  for (const char* path : {"/scene/a.glb", "/api/scene.json", "/api/replay.bin", "/api/x"}) {
    EXPECT_EQ(d.answer(get(path)).status, 401U) << path;
  }
  EXPECT_EQ(d.refuse_live(get("/live"))->status, 401U);
}

TEST_F(FrontDeskTest, TheCodeOpensTheDoorToWhoBringsTheCookie) {
  FrontDesk d = desk();
  EXPECT_EQ(pair(d, "WRONG1").status, 403U);
  std::string code = d.code();
  for (char& sign : code) sign = static_cast<char>(std::tolower(sign));
  const HttpAnswer paired = pair(d, code.substr(0, 3) + "-" + code.substr(3));
  ASSERT_EQ(paired.status, 200U);
  const std::string cookie = header(paired, "Set-Cookie");
  for (const char* what : {"HttpOnly", "SameSite=Strict", "Secure"}) {
    EXPECT_NE(cookie.find(what), std::string::npos) << what;
  }
  HttpRequest request = get("/scene/a.glb");
  request.cookie = "other=1; " + cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(d.answer(request).status, 200U);
  request.target = "/live";
  EXPECT_FALSE(d.refuse_live(request));
  request.cookie.back() = request.cookie.back() == '0' ? '1' : '0';
  EXPECT_EQ(d.refuse_live(request)->status, 401U);
}

TEST_F(FrontDeskTest, AfterFiveTriesInAMinuteNotEvenTheRightCodeHelps) {
  FrontDesk d = desk();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(pair(d, "WRONG1").status, 403U);
  EXPECT_EQ(pair(d, d.code()).status, 429U);
}

TEST_F(FrontDeskTest, WhatIsNoCodeIsABadRequest) {
  FrontDesk d = desk();
  HttpRequest request = get("/api/pair");
  request.method = "POST";
  for (const char* body : {"", "{", "[]", "{\"code\": 5}", "{\"kode\": \"\"}"}) {
    request.body = body;
    EXPECT_EQ(d.answer(request).status, 400U) << body;
  }
}

TEST_F(FrontDeskTest, FromThisMachineEverybodyIsPaired) {
  FrontDesk d = desk();
  HttpRequest request = get("/scene/a.glb");
  request.is_loopback = true;
  EXPECT_EQ(d.answer(request).status, 200U);
  EXPECT_EQ(desk(false).answer(get("/scene/a.glb")).status, 200U);
  EXPECT_TRUE(desk(false).code().empty());
}

TEST_F(FrontDeskTest, APageOfAnotherSiteGetsNothing) {
  FrontDesk d = desk(false);
  HttpRequest request = get("/scene/a.glb");
  for (const char* origin : {"https://evil.example", "null", "http://192.168.1.5:8080",
                             "https://192.168.1.5:8081", "https://192.168.1.5:8080.evil.example"}) {
    request.origin = origin;
    EXPECT_EQ(d.answer(request).status, 403U) << origin;
    EXPECT_TRUE(d.refuse_live(request)) << origin;
  }
  request.origin = "https://192.168.1.5:8080";
  EXPECT_EQ(d.answer(request).status, 200U);
}

TEST_F(FrontDeskTest, ANameThatSomebodyHadPointHereIsNoneOfOurs) {
  FrontDesk d = desk(false);
  HttpRequest request = get("/");
  for (const char* host : {"evil.example:8080", "", "localhost.evil.example", "x.y.example.org"}) {
    request.host = host;
    EXPECT_EQ(d.answer(request).status, 421U) << host;
  }
  for (const char* host : {"localhost", "LOCALHOST:8080", "[::1]:8080", "10.0.0.1", "workbench:1",
                           "lab.example.org:8080"}) {
    request.host = host;
    EXPECT_EQ(d.answer(request).status, 200U) << host;
  }
}

TEST_F(FrontDeskTest, NothingOutsideOfThePageIsFound) {
  FrontDesk d = desk(false);
  for (const char* path :
       {"/../secret.txt", "/assets/../../secret.txt", "/.secret", "/link.txt", "//etc/passwd",
        "/%2e%2e/secret.txt", "/assets", "/assets/", "/nothing.js", "", "etc/passwd"}) {
    EXPECT_EQ(d.answer(get(path)).status, 404U) << path;
  }
}

TEST_F(FrontDeskTest, WhatIsCompressedIsTakenApartForWhoCannot) {
  FrontDesk d = desk(false);
  HttpRequest request = get("/scene/a.glb");
  EXPECT_EQ(header(d.answer(request), "Content-Encoding"), "gzip");
  request.accepts_gzip = false;
  const HttpAnswer plain = d.answer(request);
  EXPECT_EQ(header(plain, "Content-Encoding"), "");
  EXPECT_EQ(plain.content->body, "a mesh");
}

TEST_F(FrontDeskTest, WhatABrowserHasIsNotSentAgain) {
  FrontDesk d = desk(false);
  HttpRequest request = get("/assets/main-1a2b.js");
  const HttpAnswer first = d.answer(request);
  EXPECT_NE(header(first, "Cache-Control").find("immutable"), std::string::npos);
  request.known_tag = header(first, "ETag");
  const HttpAnswer second = d.answer(request);
  EXPECT_EQ(second.status, 304U);
  EXPECT_EQ(second.content, nullptr);
  EXPECT_EQ(header(d.answer(get("/")), "Cache-Control"), "no-cache");
}

TEST_F(FrontDeskTest, FilesThatCannotBeReadAndOtherMethodsGetAClearWord) {
  FrontDesk d = desk(false);
  EXPECT_EQ(d.answer(get("/scene/bad.glb")).status, 500U);
  EXPECT_EQ(d.answer(get("/scene/none.glb")).status, 404U);
  HttpRequest request = get("/");
  request.method = "DELETE";
  EXPECT_EQ(d.answer(request).status, 405U);
  EXPECT_EQ(d.answer(get("/live")).status, 426U);
}

TEST_F(FrontDeskTest, PlainHttpIsSentToTls) {
  HttpRequest request = get("/a?b");
  const HttpAnswer answer = FrontDesk::send_to_tls(request);
  EXPECT_EQ(answer.status, 308U);
  EXPECT_EQ(header(answer, "Location"), "https://192.168.1.5:8080/a?b");
}

TEST(Pairing, NoTwoServersShowTheSameCode) {
  const std::string one = std::move(Pairing::create()).value().code();
  const std::string other = std::move(Pairing::create()).value().code();
  EXPECT_EQ(one.size(), 6U);
  EXPECT_NE(one, other);
}

TEST(Pairing, TriesComeBackAfterAMinuteAndAllTogetherAreBounded) {
  Pairing pairing = std::move(Pairing::create()).value();
  using Outcome = Pairing::Outcome;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(pairing.pair("x", "a", 0.0)->outcome, Outcome::wrong);
  EXPECT_EQ(pairing.pair("x", "a", 59.0)->outcome, Outcome::too_many_tries);
  EXPECT_EQ(pairing.pair("x", "a", 61.0)->outcome, Outcome::wrong);
  int tried = 0;
  for (int i = 0; i < 100; ++i) {
    const std::string address = "b" + std::to_string(i);
    tried += pairing.pair("x", address, 62.0)->outcome == Outcome::wrong ? 1 : 0;
  }
  EXPECT_EQ(tried, 29);
}

TEST(OwnCertificate, IsForThisMachineAndKeptWithItsKeyPrivate) {
  const TemporaryFolder folder;
  const auto files = own_certificate(folder.path() / "pcavr");
  ASSERT_TRUE(files) << files.error().to_string();
  const auto facts = read_certificate(files->certificate);
  ASSERT_TRUE(facts);
  EXPECT_NEAR(facts->days_left, 396.0, 0.1);
  EXPECT_EQ(facts->fingerprint.size(), 95U);
  std::vector<std::string> wanted = machine_addresses();
  wanted.insert(wanted.end(), {"localhost", "127.0.0.1", "::1"});
  for (const std::string& name : wanted) {
    EXPECT_NE(std::find(facts->names.begin(), facts->names.end(), name), facts->names.end())
        << name;
  }
  EXPECT_EQ(std::filesystem::status(files->key).permissions(),
            std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  const auto again = own_certificate(folder.path() / "pcavr");
  ASSERT_TRUE(again);
  EXPECT_EQ(read_certificate(again->certificate)->fingerprint, facts->fingerprint);
}

TEST(OwnCertificate, OneWithAnotherKeyIsMadeAnew) {
  const TemporaryFolder folder;
  const auto files = own_certificate(folder.path() / "one");
  const auto others = own_certificate(folder.path() / "other");
  ASSERT_TRUE(files && others);
  const std::string before = read_certificate(files->certificate)->fingerprint;
  for (const std::string& key : {read_file(others->key).value(), std::string()}) {
    EXPECT_TRUE(write_file(files->key, key));
    ASSERT_TRUE(own_certificate(folder.path() / "one"));
    EXPECT_NE(read_certificate(files->certificate)->fingerprint, before);
    EXPECT_NE(read_file(files->key).value(), key);
  }
}

TEST(OwnCertificate, OneThatIsNoneIsMadeAnew) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file(folder.path() / "certificate.pem", "nonsense"));
  EXPECT_TRUE(write_file(folder.path() / "key.pem", "nonsense"));
  EXPECT_FALSE(read_certificate(folder.path() / "certificate.pem"));
  const auto files = own_certificate(folder.path());
  ASSERT_TRUE(files);
  EXPECT_TRUE(read_certificate(files->certificate));
}

}  // namespace
}  // namespace pcavr
