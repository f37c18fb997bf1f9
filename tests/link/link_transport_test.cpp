// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_transport.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.hpp>

#include "pcavr/base/core/output.hpp"

#include "support/temporary_folder.hpp"
#include "teleoperation/link/authorized_keys.hpp"
#include "teleoperation/link/connection_guard.hpp"

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

/// Whether each of libzmq's threads, which carry the messages, has real-time priority.
std::vector<bool> are_socket_threads_real_time() {
  std::vector<bool> found;
  for (const fs::directory_entry& thread : fs::directory_iterator("/proc/self/task")) {
    std::string name;
    std::ifstream(thread.path() / "comm") >> name;
    if (!name.starts_with("ZMQbg/IO")) continue;
    const std::string id = thread.path().filename().string();
    const int policy = ::sched_getscheduler(static_cast<pid_t>(std::stol(id)));
    found.push_back(policy == SCHED_RR);
  }
  return found;
}

TEST_F(LinkTransport, SocketThreadsPrecedeOtherPrograms) {
  bool is_permitted = false;
  std::thread([&] {
    const sched_param parameters{.sched_priority = 19};
    is_permitted = ::pthread_setschedparam(::pthread_self(), SCHED_RR, &parameters) == 0;
  }).join();
  if (!is_permitted) GTEST_SKIP() << "no permission to raise a thread's priority";
  const int before = ::sched_getscheduler(0);
  const LinkServer server = open_server();
  const LinkClient client = open_client(server, "alice");
  // libzmq names a thread only when it runs, which nothing waits for.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (are_socket_threads_real_time().size() < 2 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(are_socket_threads_real_time(), (std::vector<bool>{true, true}));
  EXPECT_EQ(::sched_getscheduler(0), before);
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
  for (int i = 0; i < 100 && server.is_authorized(key); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_FALSE(server.is_authorized(key));
  LinkClient client = open_client(server, "alice");
  EXPECT_FALSE(exchange(client, server, 15));
}

/// The process can open no other file as long as this exists.
class NoDescriptors {
 public:
  NoDescriptors() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST_F(LinkTransport, AFolderOfKeysThatCanNotBeReadIsNoRevocation) {
  AuthorizedKeys known(authorized());
  const std::string alice = keys_of("alice").public_key, mallory = keys_of("mallory").public_key;
  EXPECT_TRUE(known.contains(alice) && !known.contains(mallory));
  {
    const NoDescriptors none;
    EXPECT_NE(known.refresh().find("stay so"), std::string::npos);
    EXPECT_EQ(known.refresh(), "");  // said once
    EXPECT_TRUE(known.contains(alice));
  }
  fs::copy_file(keys() / "mallory.pub", authorized() / "mallory.pub");
  EXPECT_EQ(known.refresh(), "");
  EXPECT_TRUE(known.contains(alice) && known.contains(mallory));
  ASSERT_TRUE(write_file(authorized() / "alice.pub", "no key any more\n"));
  fs::remove(authorized() / "mallory.pub");
  EXPECT_EQ(known.refresh(), "");
  EXPECT_FALSE(known.contains(alice) || known.contains(mallory));
}

TEST_F(LinkTransport, TooFewDescriptorsAreAnErrorAndNoAbort) {
  const NoDescriptors none;
  const auto server = LinkServer::open({});
  ASSERT_FALSE(server);
  EXPECT_NE(server.error().hint.find("ulimit -n"), std::string::npos);
  EXPECT_FALSE(LinkClient::open({.port = 5}));
}

TEST_F(LinkTransport, AFolderOfKeysThatIsGoneAuthorisesNobody) {
  AuthorizedKeys known(authorized());
  fs::remove_all(authorized());
  EXPECT_NE(known.refresh(), "");
  EXPECT_FALSE(known.contains(keys_of("alice").public_key));
}

/// A TCP connection over which nothing is sent but what send() is given.
class SilentConnection {
 public:
  explicit SilentConnection(std::uint16_t port)
      : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    static_cast<void>(::connect(descriptor_, reinterpret_cast<sockaddr*>(&to), sizeof to));
  }
  SilentConnection(SilentConnection&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)) {}
  SilentConnection& operator=(SilentConnection&&) = delete;
  ~SilentConnection() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  ssize_t send(const std::string& bytes) const {
    return ::send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  }
  /// Waits until libzmq's greeting (64 bytes) and the beginning of its READY are here, some seconds
  /// at most.
  void wait_for_ready() const {
    std::array<char, 256> answer{};
    const timeval timeout{.tv_sec = 5, .tv_usec = 0};
    ::setsockopt(descriptor_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    ssize_t size = 0, count = 0;
    while (size <= 64 && (count = ::recv(descriptor_, answer.data(), answer.size(), 0)) > 0) {
      size += count;
    }
  }
  /// Whether the peer has ended the connection, after what libzmq says first.
  [[nodiscard]] bool is_ended() const {
    std::array<char, 256> greeting{};
    ssize_t count = 0;
    while ((count = ::recv(descriptor_, greeting.data(), greeting.size(), MSG_DONTWAIT)) > 0) {
    }
    return count == 0 || errno == ECONNRESET;
  }

 private:
  int descriptor_;
};

TEST_F(LinkTransport, ConnectionsWithoutAMessageAreFewAndEndNobodysSession) {
  LinkServer server = open_server();
  LinkClient client = open_client(server, "alice");
  ASSERT_TRUE(exchange(client, server));
  std::vector<SilentConnection> silent;
  for (int i = 0; i < 300; ++i) silent.emplace_back(server.port());
  const auto open = [&silent] {
    return static_cast<std::size_t>(std::count_if(
        silent.begin(), silent.end(), [](const SilentConnection& one) { return !one.is_ended(); }));
  };
  for (int i = 0; i < 200 && open() > ConnectionGuard::kMaxSilentOfAddress; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_LE(open(), ConnectionGuard::kMaxSilentOfAddress);
  EXPECT_TRUE(exchange(client, server));
  EXPECT_EQ(client.state(), LinkClient::State::connected);
  LinkClient later = open_client(server, "alice");
  EXPECT_TRUE(exchange(later, server));
}

/// ZMTP 3.0 [RFC 23] without encryption, up to the first message of a DEALER.
std::string handshake() {
  std::string greeting = std::string("\xff\0\0\0\0\0\0\0\1\x7f\3\0NULL", 16);
  greeting.resize(64, '\0');
  const std::string ready = "\5READY\x0bSocket-Type" + std::string("\0\0\0\6", 4) + "DEALER";
  return greeting + '\4' + static_cast<char>(ready.size()) + ready;
}

/// A part that another one follows.
std::string part_of_more(std::size_t size) {
  std::string frame = "\3";
  for (int shift = 56; shift >= 0; shift -= 8) frame += static_cast<char>((size >> shift) & 0xff);
  return frame + std::string(size, 'x');
}

/// libzmq's own sockets send no message before its last part; these bytes do. Returns how many were
/// sent until the other side ended the connection, or `most`.
std::size_t send_endless_message(LinkServer& server, std::size_t size, std::size_t most) {
  const SilentConnection peer(server.port());
  std::string parts;
  while (parts.size() < 65536) parts += part_of_more(size);
  EXPECT_GT(peer.send(handshake()), 0);
  peer.wait_for_ready();  // before it, libzmq expects no message
  std::string bytes = parts;
  std::size_t sent = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (sent < most && std::chrono::steady_clock::now() < end) {
    static_cast<void>(server.receive());
    const ssize_t count = peer.send(bytes);
    if (count < 0 && errno != EAGAIN) break;
    if (count <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    sent += static_cast<std::size_t>(count);
    bytes.erase(0, static_cast<std::size_t>(count));
    if (bytes.size() < parts.size()) bytes += parts;
  }
  return sent;
}

TEST_F(LinkTransport, AMessageWithoutAnEndEndsItsConnection) {
  constexpr std::size_t kMost = 400'000'000;  // bytes
  LinkServer server = LinkServer::open({}).value();
  for (const std::size_t size : {std::size_t{40'000}, std::size_t{1}}) {
    EXPECT_LT(send_endless_message(server, size, kMost), kMost) << size;
    const std::vector<std::string> notices = server.take_notices();
    ASSERT_FALSE(notices.empty()) << size;
    EXPECT_NE(notices[0].find("no whole message"), std::string::npos) << notices[0];
  }
  LinkClient client = LinkClient::open({.port = server.port()}).value();
  EXPECT_TRUE(exchange(client, server));
}

TEST_F(LinkTransport, AMessageOfSeveralPartsIsIgnored) {
  LinkServer server = LinkServer::open({}).value();
  LinkClient client = LinkClient::open({.port = server.port()}).value();
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  socket.connect("tcp://127.0.0.1:" + std::to_string(server.port()));
  for (int i = 0; i < 50; ++i) socket.send(zmq::str_buffer("x"), zmq::send_flags::sndmore);
  socket.send(zmq::str_buffer("x"), zmq::send_flags::none);
  server.wait(1.0);
  EXPECT_FALSE(server.receive());
  EXPECT_TRUE(exchange(client, server));
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

TEST_F(LinkTransport, APairOfKeysIsWrittenAsAWhole) {
  const LinkKeys before = keys_of("alice");
  fs::remove(keys() / "alice.pub");  // as if the process was killed between the two
  ASSERT_TRUE(write_file(keys() / ".alice.pub.partial", "half"));
  ASSERT_TRUE(generate_link_keys(keys(), "alice"));
  EXPECT_EQ(read_public_link_key(keys() / "alice.pub").value(), before.public_key);
  EXPECT_EQ(keys_of("alice").secret_key, before.secret_key);
  fs::remove(keys() / "alice.key");
  EXPECT_FALSE(generate_link_keys(keys(), "alice"));
  EXPECT_FALSE(fs::exists(keys() / "alice.key"));
  for (const auto& entry : fs::directory_iterator(keys())) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
  }
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
