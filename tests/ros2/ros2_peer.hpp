// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>
#include <cstdint>
#include <functional>

#include <sys/wait.h>
#include <unistd.h>

#include "pcavr/ros2/ros2_transport.hpp"

namespace pcavr {

/// DDS on the loopback interface without multicast, in a domain of this process and its children.
inline DdsOptions loopback_options() {
  static const auto domain = static_cast<std::uint32_t>(20 + ::getpid() % 180);
  return {.domain = domain, .interface = "127.0.0.1", .peers = {"127.0.0.1"}, .multicast = false};
}

/// Another process that runs `act` until the end of this object. Make it before any participant of
/// this process: threads do not survive a fork.
class Ros2Peer {
 public:
  explicit Ros2Peer(const std::function<void()>& act) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::alarm(30);  // if the parent is killed
    act();
    ::_exit(0);
  }
  Ros2Peer(const Ros2Peer&) = delete;
  Ros2Peer& operator=(const Ros2Peer&) = delete;
  ~Ros2Peer() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }

 private:
  pid_t pid_;
};

}  // namespace pcavr
