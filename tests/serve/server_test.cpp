// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/server.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/ssl.hpp>
#include <gtest/gtest.h>

#include "pcavr/base/core/output.hpp"
#include "pcavr/serve/certificate.hpp"

#include "serve/a_world.hpp"
#include "serve/page_client.hpp"
#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace asio = boost::asio;
using test::PageClient;
using test::response_to;
using test::tcp;

class NoScene final : public ContentSource {
 public:
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(
      std::string_view path) const override {
    if (path != "/api/scene.json") return std::shared_ptr<const Content>();
    return std::make_shared<const Content>(Content{"application/json", "{}", false});
  }
};

/// Is slow, as rendering an image is.
class SlowScene final : public ContentSource {
 public:
  [[nodiscard]] Expected<std::shared_ptr<const Content>> find(std::string_view) const override {
    ++requests;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    return std::make_shared<const Content>(Content{"image/jpeg", "a picture", false});
  }
  mutable std::atomic<int> requests{0};
};

class ServerTest : public testing::Test {
 protected:
  ServerTest() { EXPECT_TRUE(write_file(page_.path() / "index.html", "<title>pcavr</title>")); }
  ~ServerTest() override { end(); }

  void end() {
    if (!server_) return;
    server_->stop();
    thread_.join();
    server_.reset();
  }

  void open(ServerOptions options = {}) { open(options, scene_); }
  void open(ServerOptions options, const ContentSource& scene) {
    options.port = 0;
    options.page = page_.path();
    auto server = LiveServer::open(options, *world_, scene);
    ASSERT_TRUE(server) << server.error().to_string();
    server_ = std::make_unique<LiveServer>(std::move(*server));
    ASSERT_TRUE(world_->start());
    thread_ = std::thread([this] { server_->run(); });
  }
  [[nodiscard]] std::uint16_t port() const { return server_->port(); }
  [[nodiscard]] std::string get(const std::string& path, const std::string& header = {}) const {
    return response_to(port(), "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + header +
                                   "Connection: close\r\n\r\n");
  }
  /// Waits until the world has advanced.
  void expect_world_runs() {
    PageClient page(port());
    ASSERT_TRUE(page.is_open);
    ASSERT_TRUE(page.send_hello());
    const auto first = page.receive_next<LiveState>();
    ASSERT_TRUE(first);
    for (int i = 0; i < 1000; ++i) {
      const auto state = page.receive_next<LiveState>();
      ASSERT_TRUE(state);
      if (state->cycles > first->cycles + 100) return;
    }
    FAIL() << "the world does not advance";
  }

  TemporaryFolder page_;
  NoScene scene_;
  std::unique_ptr<LiveWorld> world_ = test::a_live_world();
  std::unique_ptr<LiveServer> server_;
  std::thread thread_;
};

TEST_F(ServerTest, ServesPageAndSceneWithSecurityHeaders) {
  open();
  const std::string index = get("/");
  EXPECT_EQ(index.substr(0, 15), "HTTP/1.1 200 OK");
  EXPECT_NE(index.find("<title>pcavr</title>"), std::string::npos);
  for (const char* header : {"Content-Security-Policy: default-src 'self'", "nosniff",
                             "Content-Type: text/html", "ETag: "}) {
    EXPECT_NE(index.find(header), std::string::npos) << header;
  }
  EXPECT_NE(get("/api/scene.json").find("200 OK"), std::string::npos);
  EXPECT_NE(get("/nothing").find("404"), std::string::npos);
  EXPECT_NE(get("/", "Origin: http://evil.example\r\n").find("403"), std::string::npos);
}

TEST_F(ServerTest, AScriptedPagePushesTheBoxAndReceivesItsMotion) {
  open();
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  ASSERT_TRUE(page.send_message(LiveCommand::take_tool));
  auto state = page.receive_next<LiveState>();
  ASSERT_TRUE(state);
  const float before = state->objects.at(0).position.x();
  LiveTool tool{.p_base_tip = state->p_base_hip};
  // The clutch closes at the start; then the hand moves at 0.15 m/s, by the clock, into the box.
  const double start_x = tool.p_base_tip.x();
  double start = LiveWorld::clock();
  for (int i = 0; i < 2000 && state->objects[0].position.x() < before + 0.02F; ++i) {
    tool.is_engaged = i > 5;
    if (!tool.is_engaged) start = LiveWorld::clock();
    tool.p_base_tip.x() = static_cast<float>(start_x + 0.15 * (LiveWorld::clock() - start));
    ASSERT_TRUE(page.send_message(tool));
    state = page.receive_next<LiveState>();
    ASSERT_TRUE(state);
  }
  EXPECT_GT(state->objects[0].position.x(), before + 0.02F);
  EXPECT_TRUE(state->has_tool);
  EXPECT_GE(state->pulses, 2U);
  EXPECT_FALSE(std::isnan(state->page_clock));
}

TEST_F(ServerTest, ThePageThatHasTheToolIsAskedForItAndHandsItOver) {
  open();
  PageClient first(port());
  PageClient second(port());
  ASSERT_TRUE(first.send_hello() && second.send_hello());
  const auto comes_to = [](PageClient& page, auto condition) {
    for (int i = 0; i < 300; ++i) {
      const auto state = page.receive_next<LiveState>();
      if (!state || condition(*state)) return state.has_value();
    }
    return false;
  };
  const auto has_tool = [](const LiveState& state) { return state.has_tool; };
  ASSERT_TRUE(first.send_message(LiveCommand::take_tool));
  ASSERT_TRUE(comes_to(first, has_tool));
  ASSERT_TRUE(second.send_message(LiveCommand::take_tool));
  EXPECT_TRUE(comes_to(second, [](const LiveState& state) { return state.has_asked; }));
  EXPECT_TRUE(comes_to(first, [](const LiveState& state) { return state.is_tool_wanted; }));
  ASSERT_TRUE(first.send_message(LiveCommand::hand_over_tool));
  EXPECT_TRUE(comes_to(second, has_tool));
  EXPECT_TRUE(comes_to(first, [](const LiveState& state) { return !state.has_tool; }));
}

TEST_F(ServerTest, MalformedAndHugeMessagesGetAnErrorAndCloseTheConnection) {
  open();
  for (const std::size_t length : {std::size_t{1}, std::size_t{24}, std::size_t{60'000}}) {
    PageClient page(port());
    ASSERT_TRUE(page.send_hello());
    ASSERT_TRUE(page.send(std::vector<std::uint8_t>(length, 0xff)));
    const auto notice = page.receive_next<LiveNotice>();
    ASSERT_TRUE(notice);
    EXPECT_EQ(notice->level, LiveLevel::error);
    while (page.receive()) {
    }
  }
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  page.send(std::vector<std::uint8_t>(1'000'000, 0));
  while (page.receive()) {
  }
  expect_world_runs();
}

TEST_F(ServerTest, APageOfAnotherVersionGetsAnError) {
  open();
  PageClient page(port());
  ASSERT_TRUE(page.send_message(LiveHello{2, "9.9"}));
  const auto notice = page.receive_next<LiveNotice>();
  ASSERT_TRUE(notice);
  EXPECT_NE(notice->text.find("protocol 2"), std::string::npos);
  EXPECT_FALSE(page.receive());
}

TEST_F(ServerTest, RejectsCrossOriginWebSockets) {
  open();
  EXPECT_FALSE(PageClient(port(), "http://evil.example").is_open);
  EXPECT_TRUE(PageClient(port(), "http://127.0.0.1:" + std::to_string(port())).is_open);
  EXPECT_NE(get("/live", "Origin: http://evil.example\r\n").find("403"), std::string::npos);
}

TEST_F(ServerTest, MalformedHttpGetsAnErrorResponse) {
  open();
  EXPECT_NE(response_to(port(), "nonsense\r\n\r\n").find("400"), std::string::npos);
  EXPECT_NE(get("/", "X: " + std::string(20'000, 'x') + "\r\n").find("431"), std::string::npos);
  EXPECT_NE(
      response_to(port(),
                  "POST /api/pair HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999\r\n\r\n")
          .find("413"),
      std::string::npos);
  expect_world_runs();
}

TEST_F(ServerTest, AHundredPagesAtOnceAreServedOrRejectedWithANotice) {
  open();
  std::vector<std::unique_ptr<PageClient>> pages;
  // The pages come from eight addresses: one alone gets a quarter of the places.
  for (int i = 0; i < 100; ++i) {
    pages.push_back(
        std::make_unique<PageClient>(port(), "", "127.0.0." + std::to_string(1 + i % 8)));
  }
  int served = 0;
  int rejected = 0;
  for (const auto& page : pages) {
    page->send_hello();
    while (const auto message = page->receive()) {
      if (const auto* notice = std::get_if<LiveNotice>(&message->content)) {
        rejected += notice->text.find("pages are open") != std::string::npos ? 1 : 0;
      }
      if (!std::holds_alternative<LiveState>(message->content)) continue;
      ++served;
      break;
    }
  }
  EXPECT_EQ(served, 32);
  EXPECT_EQ(rejected, 68);
  pages.clear();
  expect_world_runs();
}

TEST_F(ServerTest, ConnectionsAreLimited) {
  ServerOptions options;
  options.max_connections = 3;
  open(options);
  asio::io_context io;
  std::vector<tcp::socket> idle;
  for (int i = 0; i < 3; ++i) idle.emplace_back(io).connect(test::local(port()));
  EXPECT_NE(get("/").find("503"), std::string::npos);
}

TEST_F(ServerTest, SilentPagesOfOneAddressLeavePlacesForOthersAndAreClosed) {
  ServerOptions options;
  options.max_pages = 8;
  options.hello_timeout = 0.5;
  open(options);
  std::vector<std::unique_ptr<PageClient>> silent;
  for (int i = 0; i < 40; ++i) silent.push_back(std::make_unique<PageClient>(port()));
  PageClient honest(port(), "", "127.0.0.2");
  ASSERT_TRUE(honest.send_hello());
  EXPECT_TRUE(honest.receive_next<LiveState>()) << "others have a place at once";
  for (const auto& page : silent) {
    while (page->receive()) {
    }
  }
  PageClient later(port());
  ASSERT_TRUE(later.send_hello());
  EXPECT_TRUE(later.receive_next<LiveState>()) << "places of pages without a hello are free again";
}

TEST_F(ServerTest, IdleConnectionsOfOneAddressLeavePlacesForOthers) {
  ServerOptions options;
  options.max_connections = 40;
  open(options);
  asio::io_context io;
  std::vector<tcp::socket> idle;
  for (int i = 0; i < 100; ++i) idle.emplace_back(io).connect(test::local(port()));
  EXPECT_NE(get("/").find("503"), std::string::npos);
  EXPECT_NE(response_to(port(), "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
                        "127.0.0.2")
                .find("200 OK"),
            std::string::npos);
}

TEST_F(ServerTest, DisconnectsAFloodOfPings) {
  open();
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  ASSERT_TRUE(page.receive_next<LiveWelcome>());
  bool is_open = true;
  for (int i = 0; i < 200'000 && is_open; ++i) is_open = page.ping();
  EXPECT_FALSE(is_open);
  expect_world_runs();
}

TEST_F(ServerTest, RejectsTwoHostHeadersAndInlineStyles) {
  open();
  EXPECT_NE(get("/", "Host: evil.example\r\n").find("HTTP/1.1 400"), std::string::npos);
  const std::string index = get("/");
  EXPECT_NE(index.find("style-src 'self';"), std::string::npos);
  EXPECT_EQ(index.find("unsafe-inline"), std::string::npos);
}

TEST_F(ServerTest, StatesWhatTheWorldsThreadLacks) {
  open();
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  std::vector<std::string> notices;
  while (const auto message = page.receive()) {
    if (const auto* notice = std::get_if<LiveNotice>(&message->content)) {
      notices.push_back(notice->text);
    }
    if (std::holds_alternative<LiveState>(message->content)) break;
  }
  EXPECT_EQ(notices, world_->notes());
}

/// Whether a TLS handshake of at most that version succeeds with these cipher suites only.
bool connects_with(std::uint16_t port, int version, const char* ciphers) {
  asio::io_context io;
  asio::ssl::context context(asio::ssl::context::tls_client);
  SSL_CTX_set_max_proto_version(context.native_handle(), version);
  if (SSL_CTX_set_cipher_list(context.native_handle(), ciphers) != 1) return false;
  asio::ssl::stream<tcp::socket> stream(io, context);
  stream.next_layer().connect(test::local(port));
  boost::system::error_code fault;
  stream.handshake(asio::ssl::stream_base::client, fault);
  return !fault;
}

TEST_F(ServerTest, AcceptsAuthenticatedEncryptionOnly) {
  const TemporaryFolder folder;
  const auto files = load_or_create_certificate(folder.path());
  ASSERT_TRUE(files) << files.error().to_string();
  ServerOptions options;
  options.tls = *files;
  open(options);
  EXPECT_TRUE(connects_with(port(), TLS1_2_VERSION, "ECDHE+AESGCM"));
  EXPECT_TRUE(connects_with(port(), TLS1_3_VERSION, "ECDHE+AESGCM"));
  EXPECT_FALSE(connects_with(port(), TLS1_2_VERSION, "ECDHE+AES:!AESGCM:!AESCCM"));
  EXPECT_FALSE(connects_with(port(), TLS1_2_VERSION, "AES128-GCM-SHA256"));
}

TEST_F(ServerTest, DisconnectsAClientThatNeverReads) {
  ServerOptions options;
  options.max_write_time = 0.5;
  options.rate = 90.0;
  open(options);
  PageClient unresponsive(port());
  unresponsive.transport().set_option(asio::socket_base::receive_buffer_size(4096));
  ASSERT_TRUE(unresponsive.send_hello());
  ASSERT_TRUE(unresponsive.send_message(LiveCommand::take_tool));
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  bool was_taken = false;
  for (int i = 0; i < 10'000; ++i) {
    const auto state = page.receive_next<LiveState>();
    ASSERT_TRUE(state);
    was_taken = was_taken || state->tool_taken;
    // The tool is free again: the unresponsive page was disconnected.
    if (was_taken && !state->tool_taken) return;
  }
  FAIL() << "it is still connected";
}

TEST_F(ServerTest, ASlowPageReceivesTheNewestState) {
  ServerOptions options;
  options.rate = 90.0;
  open(options);
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  ASSERT_TRUE(page.receive_next<LiveState>());
  // Some 60 states, if they were queued.
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  std::uint32_t before = 0;
  for (int i = 0; i < 200; ++i) {
    const auto state = page.receive_next<LiveState>();
    ASSERT_TRUE(state);
    EXPECT_GE(state->cycles, before);
    before = state->cycles;
    // A state is only encoded when it can be sent.
    EXPECT_LT(state->state_age, 0.1F);
  }
}

TEST_F(ServerTest, RepliesAreNotQueuedWithoutLimit) {
  ServerOptions options;
  options.max_write_time = 0.5;
  open(options);
  {
    PageClient page(port());
    ASSERT_TRUE(page.send_hello());
    // Pings without reading a single pong.
    for (int i = 0; i < 20'000 && page.send_message(LivePing{}); ++i) {
    }
  }
  expect_world_runs();
}

TEST_F(ServerTest, StopsAtOnceWithPendingFileRequests) {
  const SlowScene scene;
  open({}, scene);
  asio::io_context io;
  std::vector<tcp::socket> waiting;
  for (int i = 0; i < 20; ++i) {
    waiting.emplace_back(io).connect(test::local(port()));
    asio::write(waiting.back(),
                asio::buffer(std::string("GET /scene/a HTTP/1.1\r\nHost: localhost\r\n\r\n")));
  }
  // Served in order: by now all of them wait for the first.
  PageClient page(port());
  ASSERT_TRUE(page.send_hello());
  ASSERT_TRUE(page.receive_next<LiveWelcome>());
  end();
  EXPECT_LT(scene.requests, 20);
}

TEST(LiveServer, RejectsUnsafeOptions) {
  const TemporaryFolder folder;
  const NoScene scene;
  const auto world = test::a_live_world();
  ServerOptions options;
  options.port = 0;
  options.page = folder.path();
  const auto message = [&] { return LiveServer::open(options, *world, scene).error().to_string(); };
  EXPECT_NE(message().find("index.html"), std::string::npos);
  ASSERT_TRUE(write_file(folder.path() / "index.html", ""));
  options.host = "0.0.0.0";
  EXPECT_NE(message().find("--tls"), std::string::npos);
  options.host = "not.an.address";
  EXPECT_NE(message().find("not an address"), std::string::npos);
  options.host = "localhost";
  options.tls = TlsFiles{folder.path() / "index.html", folder.path() / "index.html"};
  EXPECT_NE(message().find("not a PEM certificate"), std::string::npos);
}

TEST(LiveServer, NamesAPortInUse) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder.path() / "index.html", ""));
  const NoScene scene;
  const auto world = test::a_live_world();
  ServerOptions options;
  options.port = 0;
  options.page = folder.path();
  const auto first = LiveServer::open(options, *world, scene);
  ASSERT_TRUE(first);
  options.port = first->port();
  EXPECT_NE(LiveServer::open(options, *world, scene).error().hint.find("--port"),
            std::string::npos);
  EXPECT_FALSE(check_server(options));
}

}  // namespace
}  // namespace pcavr
