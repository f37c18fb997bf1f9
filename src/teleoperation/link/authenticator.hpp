// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <zmq.hpp>

#include "authorized_keys.hpp"
#include "notices.hpp"

namespace pcavr {

/// Answers libzmq's authentication requests [ZeroMQ RFC 27], and reads the authorised keys again as
/// they change, on its own thread.
class Authenticator {
 public:
  Authenticator(zmq::context_t& context, std::filesystem::path authorized);
  ~Authenticator();
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  /// The answer is as of the last tenth of a second.
  [[nodiscard]] bool is_authorized(std::string_view public_key) const {
    return keys_.contains(public_key);
  }
  [[nodiscard]] std::vector<std::string> take_notices() { return notices_.take(); }

 private:
  void run();
  /// Reads the keys if that was `age` [s] ago.
  void refresh_older_than(double age);
  void answer(const std::vector<zmq::message_t>& request);

  zmq::socket_t socket_;
  AuthorizedKeys keys_;
  double refreshed_ = 0.0;  ///< [s]
  Notices notices_;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace pcavr
