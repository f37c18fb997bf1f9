// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/link/link_transport.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <thread>
#include <utility>

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <zmq.hpp>

#include "pcavr/core/check.hpp"
#include "pcavr/link/link_message.hpp"

namespace pcavr {
namespace {

// Messages that wait for a peer; more are dropped: a second of commands.
constexpr int kMaxQueuedMessages = 1000;
// Of TCP connections whose peer has vanished [ms].
constexpr int kHeartbeatInterval = 500;
constexpr int kHeartbeatTimeout = 2000;
constexpr int kReconnectInterval = 100;
constexpr int kMaxReconnectInterval = 1000;
// The authentication thread ends within this time [ms].
constexpr int kAuthenticationPoll = 50;
constexpr std::size_t kMaxNotices = 64;
// Of the socket's thread: the highest nice value, or the real-time priority of the sites' loops.
constexpr int kThreadNice = -20;
constexpr int kThreadPriority = 20;

/// Of the calling thread, as far as the system permits it. By its nice value, the system wakes it
/// on the CPU that has woken it; a real-time thread it moves to another one, away from the site's
/// loop, which costs both CPUs an interrupt for each message.
void raise_priority() {
  if (::setpriority(PRIO_PROCESS, 0, kThreadNice) == 0) return;
  const sched_param parameters{.sched_priority = kThreadPriority};
  ::pthread_setschedparam(::pthread_self(), SCHED_RR, &parameters);
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
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(kMaxLinkPictureBytes));
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

/// Answers libzmq's authentication requests [ZeroMQ RFC 27], on its own thread.
class Authenticator {
 public:
  Authenticator(zmq::context_t& context, std::filesystem::path authorized)
      : socket_(context, zmq::socket_type::rep), authorized_(std::move(authorized)) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::rcvtimeo, kAuthenticationPoll);
    socket_.bind("inproc://zeromq.zap.01");
    thread_ = std::thread([this] { run(); });
  }
  ~Authenticator() {
    is_ending_ = true;
    thread_.join();
  }
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  [[nodiscard]] std::vector<std::string> take_notices() {
    const std::lock_guard lock(mutex_);
    return std::exchange(notices_, {});
  }

 private:
  void run() {
    while (!is_ending_) {
      std::vector<zmq::message_t> request;
      while (true) {
        zmq::message_t part;
        zmq::recv_result_t received;
        try {
          received = socket_.recv(part);
        } catch (const zmq::error_t&) {
          break;  // a signal
        }
        if (!received) break;
        request.push_back(std::move(part));
        if (!request.back().more()) break;
      }
      if (!request.empty()) answer(request);
    }
  }
  void answer(const std::vector<zmq::message_t>& request) {
    // version, id, domain, address, identity, mechanism, credentials
    std::string key;
    const bool is_curve =
        request.size() == 7 && request[5].to_string_view() == "CURVE" && request[6].size() == 32;
    if (is_curve) {
      std::array<char, 41> text{};
      zmq_z85_encode(text.data(), request[6].data<std::uint8_t>(), 32);
      key = text.data();
    }
    const bool is_accepted = is_curve && find_authorized(authorized_, key).has_value();
    if (!is_accepted && request.size() > 3) {
      add_notice("rejected a connection from " + request[3].to_string() + ": its key is not in " +
                 authorized_.string());
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
  void add_notice(std::string line) {
    const std::lock_guard lock(mutex_);
    if (notices_.size() < kMaxNotices) notices_.push_back(std::move(line));
  }

  zmq::socket_t socket_;
  std::filesystem::path authorized_;
  std::mutex mutex_;
  std::vector<std::string> notices_;  ///< guarded by mutex_
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

/// Events of a socket's connections.
class SocketMonitor {
 public:
  SocketMonitor(zmq::context_t& context, zmq::socket_t& socket, int events)
      : receiver_(context, zmq::socket_type::pair) {
    constexpr char kAddress[] = "inproc://pcavr-monitor";
    zmq_socket_monitor(socket.handle(), kAddress, events);
    receiver_.set(zmq::sockopt::linger, 0);
    receiver_.connect(kAddress);
  }
  struct Event {
    std::uint16_t event = 0;
    std::uint32_t value = 0;
  };
  [[nodiscard]] std::optional<Event> next() {
    zmq::message_t number;
    zmq::message_t address;
    if (!receiver_.recv(number, zmq::recv_flags::dontwait)) return std::nullopt;
    if (number.more()) static_cast<void>(receiver_.recv(address));
    Event event;
    if (number.size() < sizeof event.event + sizeof event.value) return std::nullopt;
    std::memcpy(&event.event, number.data(), sizeof event.event);
    std::memcpy(&event.value, number.data<std::uint8_t>() + sizeof event.event, sizeof event.value);
    return event;
  }

 private:
  zmq::socket_t receiver_;
};

}  // namespace

bool is_loopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

struct LinkServer::Impl {
  zmq::context_t context = make_context();
  std::filesystem::path authorized;
  bool has_keys = false;
  std::optional<Authenticator> authenticator;
  zmq::socket_t socket{context, zmq::socket_type::router};
  std::optional<SocketMonitor> monitor;
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
  auto impl = std::make_unique<Impl>();
  set_common(impl->socket);
  if (options.keys) {
    impl->has_keys = true;
    impl->authorized = options.authorized;
    impl->authenticator.emplace(impl->context, options.authorized);
    impl->socket.set(zmq::sockopt::curve_server, true);
    impl->socket.set(zmq::sockopt::curve_secretkey, options.keys->secret_key);
    impl->socket.set(zmq::sockopt::zap_domain, "pcavr");
  }
  impl->monitor.emplace(impl->context, impl->socket,
                        ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL | ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL);
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
      LinkPacket packet{identity.to_string(), {}, bytes_of(content)};
      const bool is_single = !content.more();
      while (content.more() && impl_->socket.recv(content)) continue;
      if (!is_single) continue;  // no message of ours has more parts
      const char* const key = zmq_msg_gets(content.handle(), "User-Id");
      if (key != nullptr) packet.key = key;
      return packet;
    }
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
  return !impl_->has_keys || find_authorized(impl_->authorized, key).has_value();
}

std::vector<std::string> LinkServer::take_notices() {
  std::vector<std::string> notices;
  if (impl_->authenticator) notices = impl_->authenticator->take_notices();
  while (impl_->monitor->next()) {
    if (notices.size() >= kMaxNotices) continue;
    notices.emplace_back(impl_->has_keys
                             ? "rejected a connection: no key, or made for another site's key"
                             : "rejected a connection: it uses a key, but this site has none");
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
  auto impl = std::make_unique<Impl>();
  set_common(impl->socket);
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
