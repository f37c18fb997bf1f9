// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/link_transport.hpp"

#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zmq.hpp>

#include "pcavr/base/core/check.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

#include "authenticator.hpp"
#include "connection_guard.hpp"
#include "socket_monitor.hpp"

namespace pcavr {
namespace {

// Messages that wait for a peer; more are dropped: a second of commands.
constexpr int kMaxQueuedMessages = 1000;
// Times for TCP connections whose peer has vanished [ms].
constexpr int kHeartbeatInterval = 500;
constexpr int kHeartbeatTimeout = 2000;
constexpr int kReconnectInterval = 100;
constexpr int kMaxReconnectInterval = 1000;
// Longest time until a connection is authenticated [ms]: four times there and back, each within a
// second.
constexpr int kHandshakeTimeout = 5000;
// Descriptors of libzmq and of a site's own sockets and files; at the robot's site also
// connections.
constexpr std::size_t kOwnDescriptors = 32;
constexpr int kThreads = 6;  // of libzmq, the authentication, the guard, and to spare
// Priority of the socket's thread: real-time, below that of the sites' loops; else the highest nice
// value.
constexpr int kThreadPriority = 19;
constexpr int kThreadNice = -20;

/// Raises the priority of the calling thread, as far as the system permits it. A nice value alone
/// is not enough: it counts within a session of the system only (autogroup), so that programs of
/// other sessions kept the thread waiting for a quarter of a second, after which a link's session
/// ends.
void raise_priority() {
  const sched_param parameters{.sched_priority = kThreadPriority};
  if (::pthread_setschedparam(::pthread_self(), SCHED_RR, &parameters) == 0) return;
  ::setpriority(PRIO_PROCESS, 0, kThreadNice);
}

/// An Error where the system does not give as many descriptors as a site needs; throws
/// std::system_error if it does not give the threads. libzmq would end the process.
Expected<void> check_resources(std::size_t descriptors) {
  std::vector<int> opened;
  int code = 0;
  while (opened.size() < descriptors && code == 0) {
    const int descriptor = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) code = errno;
    if (descriptor >= 0) opened.push_back(descriptor);
  }
  for (const int descriptor : opened) ::close(descriptor);
  if (code != 0) {
    return Error{.message = "the system gives " + std::to_string(opened.size()) +
                            " file descriptors, and the link needs " + std::to_string(descriptors) +
                            ": " + std::strerror(code),
                 .hint = "raise the limit (ulimit -n)"};
  }
  std::atomic<bool> is_over = false;
  std::vector<std::thread> threads;
  const auto end = [&] {
    is_over = true;
    is_over.notify_all();
    for (std::thread& thread : threads) thread.join();
  };
  try {
    for (int i = 0; i < kThreads; ++i) threads.emplace_back([&is_over] { is_over.wait(false); });
  } catch (const std::system_error&) {
    end();
    throw;
  }
  end();
  return {};
}

/// A context whose socket thread has priority where that is permitted: on a loaded machine it would
/// otherwise not run for longer than a session lasts without messages. It inherits the priority of
/// the thread that makes the first socket (libzmq aborts where its own options are not permitted).
zmq::context_t make_context() {
  zmq::context_t context;
  std::thread([&] {
    raise_priority();
    const zmq::socket_t first(context, zmq::socket_type::pair);
  }).join();
  return context;
}

std::string endpoint_of(const std::string& host, const std::string& port) {
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return "tcp://" + (is_ipv6 ? "[" + host + "]" : host) + ":" + port;
}

void set_common(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::sndhwm, kMaxQueuedMessages);
  socket.set(zmq::sockopt::rcvhwm, kMaxQueuedMessages);
  socket.set(zmq::sockopt::handshake_ivl, kHandshakeTimeout);
  socket.set(zmq::sockopt::heartbeat_ivl, kHeartbeatInterval);
  socket.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeout);
  socket.set(zmq::sockopt::ipv6, true);
}

Error needs_keys(const std::string& host, const char* option) {
  return {.message = "without keys only a loopback address is permitted, not " + host,
          .hint = std::string("create keys with pcavr keygen, and give ") + option};
}

std::vector<std::uint8_t> bytes_of(const zmq::message_t& message) {
  const auto* const begin = message.data<std::uint8_t>();
  return {begin, begin + message.size()};
}

/// Waits for a message, or a signal. zmq_poll() counts in milliseconds, which is a whole cycle; the
/// descriptor signals changes only, so that the socket's state is checked before.
void wait_for(zmq::socket_t& socket, double timeout) {
  if (timeout <= 0.0) return;
  try {
    if ((socket.get(zmq::sockopt::events) & ZMQ_POLLIN) != 0) return;
    pollfd item{socket.get(zmq::sockopt::fd), POLLIN, 0};
    timespec duration{};
    duration.tv_sec = static_cast<time_t>(timeout);
    duration.tv_nsec = static_cast<long>(1e9 * (timeout - std::floor(timeout)));
    ::ppoll(&item, 1, &duration, nullptr);
  } catch (const zmq::error_t&) {
    // A signal.
  }
}

}  // namespace

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

struct LinkServer::Impl {
  zmq::context_t context = make_context();
  std::optional<Authenticator> authenticator;  ///< with keys
  zmq::socket_t socket{context, zmq::socket_type::router};
  std::optional<ConnectionGuard> guard;
  std::uint16_t port = 0;
};

LinkServer::LinkServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LinkServer::LinkServer(LinkServer&&) noexcept = default;
LinkServer& LinkServer::operator=(LinkServer&&) noexcept = default;
LinkServer::~LinkServer() = default;

Expected<LinkServer> LinkServer::open(const LinkServerOptions& options) {
  if (!options.keys && !is_loopback(options.host)) {
    return needs_keys(options.host, "--key and --authorized");
  }
  const Expected<void> checked = check_resources(kOwnDescriptors + ConnectionGuard::kMaxSilent);
  if (!checked) return checked.error();
  auto impl = std::make_unique<Impl>();
  set_common(impl->socket);
  impl->socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(kMaxLinkMessageBytes));
  if (options.keys) {
    impl->authenticator.emplace(impl->context, options.authorized);
    impl->socket.set(zmq::sockopt::curve_server, true);
    impl->socket.set(zmq::sockopt::curve_secretkey, options.keys->secret_key);
    impl->socket.set(zmq::sockopt::zap_domain, "pcavr");
  }
  impl->guard.emplace(impl->context, impl->socket, options.keys.has_value());
  const std::string port = options.port == 0 ? "*" : std::to_string(options.port);
  try {
    impl->socket.bind(endpoint_of(options.host == "localhost" ? "127.0.0.1" : options.host, port));
  } catch (const zmq::error_t& fault) {
    const bool is_in_use = fault.num() == EADDRINUSE;
    return Error{.message = is_in_use ? "port " + port + " is in use"
                                      : "can't listen on " + options.host + ": " + fault.what(),
                 .hint = is_in_use ? "choose another --port" : "give an address of this machine"};
  }
  const std::string bound = impl->socket.get(zmq::sockopt::last_endpoint);
  impl->port = static_cast<std::uint16_t>(std::stoi(bound.substr(bound.rfind(':') + 1)));
  return LinkServer(std::move(impl));
}

std::uint16_t LinkServer::port() const { return impl_->port; }

void LinkServer::wait(double timeout) { wait_for(impl_->socket, timeout); }

std::optional<LinkPacket> LinkServer::receive() {
  zmq::message_t identity;
  zmq::message_t content;
  try {
    while (impl_->socket.recv(identity, zmq::recv_flags::dontwait)) {
      if (!identity.more() || !impl_->socket.recv(content)) continue;
      impl_->guard->note_message(zmq_msg_get(content.handle(), ZMQ_SRCFD));
      LinkPacket packet{identity.to_string(), {}, bytes_of(content)};
      const bool is_single = !content.more();
      while (content.more() && impl_->socket.recv(content)) continue;
      if (!is_single) continue;  // no message of ours has more parts
      const char* const key = zmq_msg_gets(content.handle(), "User-Id");
      if (key != nullptr) packet.key = key;
      return packet;
    }
    impl_->guard->note_drained();
  } catch (const zmq::error_t&) {
    // A signal; the caller comes again.
  }
  return std::nullopt;
}

bool LinkServer::send(const std::string& peer, std::span<const std::uint8_t> bytes) {
  try {
    return impl_->socket.send(zmq::buffer(peer),
                              zmq::send_flags::sndmore | zmq::send_flags::dontwait) &&
           impl_->socket.send(zmq::buffer(bytes.data(), bytes.size()), zmq::send_flags::dontwait);
  } catch (const zmq::error_t&) {
    return false;
  }
}

bool LinkServer::is_authorized(const std::string& key) const {
  return !impl_->authenticator || impl_->authenticator->is_authorized(key);
}

std::vector<std::string> LinkServer::take_notices() {
  std::vector<std::string> notices = impl_->guard->take_notices();
  if (impl_->authenticator) {
    for (std::string& notice : impl_->authenticator->take_notices()) {
      notices.push_back(std::move(notice));
    }
  }
  return notices;
}

struct LinkClient::Impl {
  zmq::context_t context = make_context();
  zmq::socket_t socket{context, zmq::socket_type::dealer};
  std::optional<SocketMonitor> monitor;
  State state = State::connecting;
};

LinkClient::LinkClient(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LinkClient::LinkClient(LinkClient&&) noexcept = default;
LinkClient& LinkClient::operator=(LinkClient&&) noexcept = default;
LinkClient::~LinkClient() = default;

Expected<LinkClient> LinkClient::open(const LinkClientOptions& options) {
  if (!options.keys && !is_loopback(options.host)) {
    return needs_keys(options.host, "--key and --robot-key");
  }
  const Expected<void> checked = check_resources(kOwnDescriptors);
  if (!checked) return checked.error();
  auto impl = std::make_unique<Impl>();
  set_common(impl->socket);
  impl->socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(kMaxLinkPictureBytes));
  // Nothing is queued while there is no connection: it would arrive late.
  impl->socket.set(zmq::sockopt::immediate, true);
  impl->socket.set(zmq::sockopt::reconnect_ivl, kReconnectInterval);
  impl->socket.set(zmq::sockopt::reconnect_ivl_max, kMaxReconnectInterval);
  if (options.keys) {
    impl->socket.set(zmq::sockopt::curve_publickey, options.keys->public_key);
    impl->socket.set(zmq::sockopt::curve_secretkey, options.keys->secret_key);
    impl->socket.set(zmq::sockopt::curve_serverkey, options.robot_key);
  }
  impl->monitor.emplace(impl->context, impl->socket,
                        ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_HANDSHAKE_FAILED_AUTH |
                            ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_DISCONNECTED |
                            ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_CONNECTED);
  try {
    impl->socket.connect(endpoint_of(options.host, std::to_string(options.port)));
  } catch (const zmq::error_t& fault) {
    return Error{.message = "can't connect to " + options.host + ": " + fault.what(),
                 .hint = "give the address of the robot's site"};
  }
  return LinkClient(std::move(impl));
}

void LinkClient::wait(double timeout) { wait_for(impl_->socket, timeout); }

std::optional<std::vector<std::uint8_t>> LinkClient::receive() {
  zmq::message_t content;
  try {
    if (!impl_->socket.recv(content, zmq::recv_flags::dontwait)) return std::nullopt;
  } catch (const zmq::error_t&) {
    return std::nullopt;
  }
  return bytes_of(content);
}

bool LinkClient::send(std::span<const std::uint8_t> bytes) {
  try {
    return impl_->socket.send(zmq::buffer(bytes.data(), bytes.size()), zmq::send_flags::dontwait)
        .has_value();
  } catch (const zmq::error_t&) {
    return false;
  }
}

void LinkClient::close(double timeout) {
  impl_->socket.set(zmq::sockopt::linger, static_cast<int>(std::lround(1e3 * timeout)));
}

LinkClient::State LinkClient::state() {
  while (const auto event = impl_->monitor->next()) {
    switch (event->event) {
      case ZMQ_EVENT_HANDSHAKE_SUCCEEDED:
        impl_->state = State::connected;
        break;
      case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
        impl_->state = State::rejected;
        break;
      case ZMQ_EVENT_CONNECTED:
        // A TCP connection without a handshake so far.
        if (impl_->state == State::connecting) impl_->state = State::no_handshake;
        break;
      case ZMQ_EVENT_DISCONNECTED:
        if (impl_->state == State::connected) impl_->state = State::connecting;
        break;
      default:
        if (impl_->state != State::rejected) impl_->state = State::no_handshake;
        break;
    }
  }
  return impl_->state;
}

}  // namespace pcavr
