// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include <zmq.hpp>

#include "notices.hpp"
#include "socket_monitor.hpp"

namespace pcavr {

/// Ends, on its own thread, connections to a listening socket that cost more than they may: those
/// without a message so far are few and short-lived, so that they can't exhaust the descriptors;
/// and a connection has at most a megabyte under way that is no whole message yet. (libzmq limits
/// the length of a message's part, but neither the number of parts nor that of connections.)
class ConnectionGuard {
 public:
  /// Connections without a message, of all addresses and of one (IPv6: of one /64).
  static constexpr std::size_t kMaxSilent = 64, kMaxSilentOfAddress = 32;
  static constexpr double kMaxSilence = 5.0;                ///< [s] until the first message
  static constexpr std::uint64_t kMaxIncomplete = 1 << 20;  ///< bytes of parts without a last one

  ConnectionGuard(zmq::context_t& context, zmq::socket_t& listener, bool has_keys);
  ~ConnectionGuard();
  ConnectionGuard(const ConnectionGuard&) = delete;
  ConnectionGuard& operator=(const ConnectionGuard&) = delete;

  // The next two are for the thread that receives; neither waits.
  void note_message(int descriptor) { count(messages_[slot_of(descriptor)]); }
  /// Nothing more is there to be received now.
  void note_drained() { count(drained_); }

  [[nodiscard]] std::vector<std::string> take_notices() { return notices_.take(); }

 private:
  struct Connection {
    std::string address;
    double since = 0.0;            ///< [s]
    std::uint32_t messages = 0;    ///< whole ones, of its descriptor
    std::uint64_t bytes_then = 0;  ///< received at the last whole message
    bool is_silent = true;         ///< no message so far
  };
  using Connections = std::map<int, Connection>;  ///< by descriptor

  static constexpr std::size_t kSlots = 1024;
  static std::size_t slot_of(int descriptor) {
    return static_cast<std::size_t>(descriptor) % kSlots;
  }
  static void count(std::atomic<std::uint32_t>& counter) {
    counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  void run();
  void on_event(const SocketMonitor::Event& event, double now);
  void accept(int descriptor, double now);
  void check(double now);
  void check_messages();
  void limit_silent();
  void close(Connections::iterator connection);
  void report_silent(double now);

  SocketMonitor monitor_;
  bool has_keys_;
  Connections connections_;
  std::uint32_t seen_drained_ = 0;
  std::size_t closed_silent_ = 0;  ///< not reported yet
  double next_report_ = 0.0;       ///< [s]
  std::array<std::atomic<std::uint32_t>, kSlots> messages_{};
  std::atomic<std::uint32_t> drained_ = 0;
  Notices notices_;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace pcavr
