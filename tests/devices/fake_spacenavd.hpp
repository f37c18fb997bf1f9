// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "support/temporary_folder.hpp"

namespace pcavr::test {

/// The part of spacenavd's protocol 1 that libspnav's open and dev_name use, for one client at a
/// time, and its events. SPNAV_SOCKET is set to its socket during its lifetime.
class FakeSpacenavd {
 public:
  using Packet = std::array<std::int32_t, 8>;

  explicit FakeSpacenavd(bool has_device = true) : has_device_(has_device) {
    const std::string path = (folder_.path() / "spnav.sock").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    listener_ = socket(AF_UNIX, SOCK_STREAM, 0);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 1) != 0) {
      std::abort();
    }
    setenv("SPNAV_SOCKET", path.c_str(), 1);
    thread_ = std::thread([this] { serve(); });
  }
  ~FakeSpacenavd() {
    end();
    unsetenv("SPNAV_SOCKET");
  }
  FakeSpacenavd(const FakeSpacenavd&) = delete;
  FakeSpacenavd& operator=(const FakeSpacenavd&) = delete;

  void end() {
    if (!thread_.joinable()) return;
    is_stopping_ = true;
    thread_.join();
    if (client_ >= 0) close(client_);
    close(listener_);
  }

  void motion(std::int32_t x, std::int32_t y, std::int32_t z) { send({0, x, y, z, 0, 0, 0, 16}); }
  void button(std::int32_t number, bool is_down) { send({is_down ? 1 : 2, number}); }
  void unplug() { send({3, 1, 1}); }
  void plug_in() { send({3, 0, 1}); }
  /// Any packet.
  void send(const Packet& packet) {
    if (write(client_, packet.data(), sizeof packet) != sizeof packet) std::abort();
  }

 private:
  static constexpr std::int32_t kTag = 0x7faa0000;
  static constexpr std::int32_t kChangeProtocol = 0x5500;
  static constexpr std::int32_t kDeviceName = 0x2000;

  void serve() {
    while (!is_stopping_) {
      pollfd file{client_ >= 0 ? client_.load() : listener_, POLLIN, 0};
      if (poll(&file, 1, 10) <= 0) continue;
      if (client_ < 0) {
        client_ = accept(listener_, nullptr, nullptr);
      } else {
        serve_request();
      }
    }
  }
  void serve_request() {
    Packet request{};
    const ssize_t length = read(client_, request.data(), sizeof request);
    if (length <= 0) {
      close(client_.exchange(-1));
    } else if (length == 4 && (request[0] & ~0xff) == (kTag | kChangeProtocol)) {
      const std::int32_t version = kTag | kChangeProtocol | 1;
      if (write(client_, &version, sizeof version) != sizeof version) std::abort();
    } else if (request[0] == (kTag | kDeviceName)) {
      const std::string name = "FakeNavigator";
      request[7] = has_device_ ? static_cast<std::int32_t>(name.size()) : -1;
      std::memcpy(&request[1], name.data(), name.size());
      send(request);
    }
  }

  TemporaryFolder folder_;
  bool has_device_;
  int listener_ = -1;
  std::atomic<int> client_{-1};
  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace pcavr::test
