// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/link/link_transport.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "pcavr/core/output.hpp"

#include "support/temporary_folder.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;

class LinkTransport : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* const name : {"robot", "alice", "mallory"}) {
      ASSERT_TRUE(generate_link_keys(keys(), name));
    }
    fs::create_directories(authorized());
    fs::copy_file(keys() / "alice.pub", authorized() / "alice.pub");
  }
  fs::path keys() const { return folder_.path() / "keys"; }
  fs::path authorized() const { return folder_.path() / "authorized"; }
  LinkKeys keys_of(const std::string& name) const {
    return read_link_keys(keys() / (name + ".key")).value();
  }
  LinkServer open_server() const {
    return LinkServer::open({.keys = keys_of("robot"), .authorized = authorized()}).value();
  }
  LinkClient open_client(const LinkServer& server, const std::string& name,
                         const std::string& robot = "robot") const {
    return LinkClient::open({.port = server.port(),
                             .keys = keys_of(name),
                             .robot_key = keys_of(robot).public_key})
        .value();
  }

 private:
  TemporaryFolder folder_;
};

/// Sends until the server has received something, at most a few seconds.
std::optional<LinkPacket> exchange(LinkClient& client, LinkServer& server, int attempts = 100) {
  const std::vector<std::uint8_t> bytes{1, 2, 3};
  for (int i = 0; i < attempts; ++i) {
    client.send(bytes);
    server.wait(0.02);
    if (auto packet = server.receive()) return packet;
    static_cast<void>(client.state());
  }
  return std::nullopt;
}

TEST_F(LinkTransport, CarriesMessagesBothWaysAndStatesTheSendersKey) {
  LinkServer server = open_server();
  LinkClient client = open_client(server, "alice");
  const std::optional<LinkPacket> packet = exchange(client, server);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->bytes, (std::vector<std::uint8_t>{1, 2, 3}));
  EXPECT_EQ(packet->key, keys_of("alice").public_key);
  EXPECT_TRUE(server.send(packet->peer, std::vector<std::uint8_t>{9}));
  client.wait(2.0);
  EXPECT_EQ(client.receive(), (std::vector<std::uint8_t>{9}));
  EXPECT_EQ(client.state(), LinkClient::State::connected);
}

/// Nice values of libzmq's threads, which carry the messages.
std::vector<int> nice_of_socket_threads() {
  std::vector<int> values;
  for (const fs::directory_entry& thread : fs::directory_iterator("/proc/self/task")) {
    std::string name;
    std::ifstream(thread.path() / "comm") >> name;
    if (!name.starts_with("ZMQbg/IO")) continue;
    const std::string id = thread.path().filename().string();
    values.push_back(::getpriority(PRIO_PROCESS, static_cast<id_t>(std::stoul(id))));
  }
  return values;
}

TEST_F(LinkTransport, SocketThreadsPrecedeOtherPrograms) {
  bool is_permitted = false;
  std::thread([&] { is_permitted = ::setpriority(PRIO_PROCESS, 0, -20) == 0; }).join();
  if (!is_permitted) GTEST_SKIP() << "no permission to raise a thread's priority";
  const int before = ::getpriority(PRIO_PROCESS, 0);
  const LinkServer server = open_server();
  const LinkClient client = open_client(server, "alice");
  // libzmq names a thread only when it runs, which nothing waits for.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (nice_of_socket_threads().size() < 2 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(nice_of_socket_threads(), (std::vector<int>{-20, -20}));
  EXPECT_EQ(::getpriority(PRIO_PROCESS, 0), before);
}

TEST_F(LinkTransport, RejectsAKeyThatIsNotAuthorised) {
  LinkServer server = open_server();
  LinkClient client = open_client(server, "mallory");
  EXPECT_FALSE(exchange(client, server, 25));
  EXPECT_EQ(client.state(), LinkClient::State::rejected);
  const std::vector<std::string> notices = server.take_notices();
  ASSERT_FALSE(notices.empty());
  EXPECT_NE(notices[0].find("its key is not in"), std::string::npos);
}

TEST_F(LinkTransport, RejectsAPeerWithoutKeyAndOneMadeForAnotherServer) {
  LinkServer server = open_server();
  LinkClient without = LinkClient::open({.port = server.port()}).value();
  EXPECT_FALSE(exchange(without, server, 15));
  EXPECT_EQ(without.state(), LinkClient::State::no_handshake);
  LinkClient other = open_client(server, "alice", "mallory");
  EXPECT_FALSE(exchange(other, server, 15));
  EXPECT_EQ(other.state(), LinkClient::State::no_handshake);
}

TEST_F(LinkTransport, RevokesAKeyWithItsFile) {
  LinkServer server = open_server();
  const std::string key = keys_of("alice").public_key;
  EXPECT_TRUE(server.is_authorized(key));
  fs::remove(authorized() / "alice.pub");
  EXPECT_FALSE(server.is_authorized(key));
  LinkClient client = open_client(server, "alice");
  EXPECT_FALSE(exchange(client, server, 15));
}

TEST_F(LinkTransport, AcceptsNothingWithoutKeysOffLoopback) {
  EXPECT_FALSE(LinkServer::open({.host = "0.0.0.0"}));
  EXPECT_FALSE(LinkClient::open({.host = "192.0.2.1", .port = 5}));
  EXPECT_TRUE(is_loopback("127.0.0.1") && is_loopback("localhost") && is_loopback("::1"));
  EXPECT_FALSE(is_loopback("0.0.0.0") || is_loopback("128.0.0.1") || is_loopback("*"));
}

TEST_F(LinkTransport, APortInUseIsAnError) {
  const LinkServer server = LinkServer::open({}).value();
  const Expected<LinkServer> other = LinkServer::open({.port = server.port()});
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("in use"), std::string::npos);
}

TEST_F(LinkTransport, KeysAreForTheirOwnerAlone) {
  struct stat status {};
  const fs::path file = keys() / "alice.key";
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  ASSERT_EQ(::chmod(file.c_str(), 0644), 0);
  EXPECT_FALSE(read_link_keys(file));
  EXPECT_FALSE(generate_link_keys(keys(), "alice"));  // never replaced
  EXPECT_FALSE(generate_link_keys(keys(), "../alice"));
  ASSERT_TRUE(write_file(keys() / "odd.pub", "pcavr-link-public short\n"));
  EXPECT_FALSE(read_public_link_key(keys() / "odd.pub"));
}

}  // namespace
}  // namespace pcavr
