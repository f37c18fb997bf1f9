// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "authenticator.hpp"

#include <array>
#include <utility>

namespace pcavr {
namespace {

// The thread ends within this time [ms].
constexpr int kAuthenticationPoll = 50;
// [s] Interval between two readings of the folder; at a connection it is read anew sooner, but no
// more often than the second: whoever reaches the port can connect.
constexpr double kRefreshInterval = 0.1;
constexpr double kMinRefreshInterval = 0.01;

/// A whole request; empty without one.
std::vector<zmq::message_t> receive_request(zmq::socket_t& socket) {
  std::vector<zmq::message_t> request;
  try {
    do {
      zmq::message_t part;
      if (!socket.recv(part)) break;
      request.push_back(std::move(part));
    } while (request.back().more());
  } catch (const zmq::error_t&) {
    // A signal.
  }
  return request;
}

}  // namespace

Authenticator::Authenticator(zmq::context_t& context, std::filesystem::path authorized)
    : socket_(context, zmq::socket_type::rep),
      keys_(std::move(authorized)),
      refreshed_(steady_seconds()) {
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::rcvtimeo, kAuthenticationPoll);
  socket_.bind("inproc://zeromq.zap.01");
  thread_ = std::thread([this] { run(); });
}

Authenticator::~Authenticator() {
  is_ending_ = true;
  thread_.join();
}

void Authenticator::run() {
  while (!is_ending_) {
    const std::vector<zmq::message_t> request = receive_request(socket_);
    refresh_older_than(request.empty() ? kRefreshInterval : kMinRefreshInterval);
    if (!request.empty()) answer(request);
  }
}

void Authenticator::refresh_older_than(double age) {
  if (steady_seconds() - refreshed_ < age) return;
  std::string notice = keys_.refresh();
  refreshed_ = steady_seconds();
  if (!notice.empty()) notices_.add(std::move(notice));
}

void Authenticator::answer(const std::vector<zmq::message_t>& request) {
  // version, id, domain, address, identity, mechanism, credentials
  std::string key;
  const bool is_curve =
      request.size() == 7 && request[5].to_string_view() == "CURVE" && request[6].size() == 32;
  if (is_curve) {
    std::array<char, 41> text{};
    zmq_z85_encode(text.data(), request[6].data<std::uint8_t>(), 32);
    key = text.data();
  }
  const bool is_accepted = is_curve && keys_.contains(key);
  if (!is_accepted && request.size() > 3) {
    notices_.add("rejected a connection from " + request[3].to_string() + ": its key is not in " +
                 keys_.folder().string());
  }
  const auto part = [this](std::string_view text, bool is_last = false) {
    socket_.send(zmq::buffer(text), is_last ? zmq::send_flags::none : zmq::send_flags::sndmore);
  };
  try {
    part("1.0");
    part(request.size() > 1 ? request[1].to_string_view() : std::string_view());
    part(is_accepted ? "200" : "400");
    part(is_accepted ? "" : "key not authorised");
    part(key);
    part("", true);
  } catch (const zmq::error_t&) {
    // The context ends.
  }
}

}  // namespace pcavr
