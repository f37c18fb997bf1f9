// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/server.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/detect_ssl.hpp>

#include "pcavr/core/check.hpp"

#include "http_session.hpp"
#include "network.hpp"

namespace pcavr {
namespace {

using namespace network;

/// [s] How long pages may take to hear that the server ends.
constexpr auto kFarewell = std::chrono::milliseconds(200);

/// Tells TLS from plain HTTP by the first bytes, on a port that wants TLS.
class Doorman final : public std::enable_shared_from_this<Doorman> {
 public:
  Doorman(Hub& hub, asio::ssl::context& tls, tcp::socket&& socket, Peer peer)
      : hub_(hub), tls_(tls), stream_(std::move(socket)), peer_(std::move(peer)) {}

  void look() {
    stream_.expires_after(kMaxReadTime);
    beast::async_detect_ssl(stream_, buffer_,
                            [self = shared_from_this()](error_code fault, bool is_tls) {
                              if (!fault) self->let_in(is_tls);
                            });
  }

 private:
  void let_in(bool is_tls) {
    if (!is_tls) {
      std::make_shared<HttpSession<PlainStream>>(hub_, std::move(stream_), std::move(buffer_),
                                                 std::move(peer_), true)
          ->begin();
      return;
    }
    std::make_shared<HttpSession<TlsStream>>(hub_, TlsStream(std::move(stream_), tls_),
                                             std::move(buffer_), std::move(peer_), false)
        ->begin();
  }

  Hub& hub_;
  asio::ssl::context& tls_;
  PlainStream stream_;
  Peer peer_;
  beast::flat_buffer buffer_;
};

Error cannot_listen(const ServerOptions& options, const error_code& fault) {
  Error error{.message = "can't listen: " + fault.message(),
              .place = options.host + ':' + std::to_string(options.port)};
  if (fault == asio::error::address_in_use) error.hint = "another --port, or 0 for a free one";
  if (fault == asio::error::access_denied) error.hint = "a --port from 1024 on";
  return error;
}

Expected<tcp::endpoint> endpoint_of(const ServerOptions& options) {
  error_code fault;
  const auto address =
      asio::ip::make_address(options.host == "localhost" ? "127.0.0.1" : options.host, fault);
  if (!fault) return tcp::endpoint(address, options.port);
  return Error{.message = "not an address: '" + options.host + "'",
               .place = "host",
               .hint = "a number such as 192.168.1.5, or 0.0.0.0 for all of this machine's"};
}

/// Loads the files, and hands back the names that the certificate is for.
Expected<std::vector<std::string>> load(const TlsFiles& files, asio::ssl::context& context) {
  const Expected<CertificateFacts> facts = read_certificate(files.certificate);
  if (!facts) return facts.error();
  error_code fault;
  context.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                          asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                          asio::ssl::context::no_tlsv1_1,
                      fault);
  if (!fault) context.use_certificate_chain_file(files.certificate.string(), fault);
  if (fault) {
    return Error{.message = "not a certificate: " + fault.message(),
                 .file = files.certificate.string()};
  }
  context.use_private_key_file(files.key.string(), asio::ssl::context::pem, fault);
  if (fault) {
    return Error{.message = "not the certificate's key: " + fault.message(),
                 .file = files.key.string()};
  }
  return facts->names;
}

struct Certified {
  std::optional<asio::ssl::context> tls;
  std::vector<std::string> names;
};

/// All that can be said against the options without listening.
Expected<Certified> check(const ServerOptions& options, const tcp::endpoint& endpoint) {
  if (!endpoint.address().is_loopback() && !options.tls) {
    return Error{.message = "others can reach " + options.host + ": that wants TLS",
                 .place = "host",
                 .hint = "add --tls, or leave --host away"};
  }
  std::error_code ignored;
  if (!std::filesystem::exists(options.page / "index.html", ignored)) {
    return Error{.message = "the page is not there: no index.html",
                 .file = options.page.string(),
                 .hint = "build apps/viewer, or name its folder by --page"};
  }
  Certified certified;
  if (!options.tls) return certified;
  certified.tls.emplace(asio::ssl::context::tls_server);
  Expected<std::vector<std::string>> names = load(*options.tls, *certified.tls);
  if (!names) return names.error();
  certified.names = std::move(*names);
  return certified;
}

Expected<void> listen(tcp::acceptor& acceptor, const tcp::endpoint& endpoint,
                      const ServerOptions& options) {
  error_code fault;
  acceptor.open(endpoint.protocol(), fault);
  if (!fault) acceptor.set_option(asio::socket_base::reuse_address(true), fault);
  if (!fault) acceptor.bind(endpoint, fault);
  if (!fault) acceptor.listen(asio::socket_base::max_listen_connections, fault);
  if (fault) return cannot_listen(options, fault);
  return {};
}

}  // namespace

struct LiveServer::Impl {
  Impl(const ServerOptions& options, LiveWorld& world, std::unique_ptr<FrontDesk> desk)
      : hub(options, world, std::move(desk)) {}

  void accept() {
    acceptor.async_accept([this](error_code fault, tcp::socket socket) {
      if (fault == asio::error::operation_aborted) return;
      if (fault) return accept_later();
      greet(std::move(socket));
      accept();
    });
  }

  /// The system has no more to give: it will, once a connection ends.
  void accept_later() {
    retry.expires_after(std::chrono::milliseconds(100));
    retry.async_wait([this](error_code fault) {
      if (!fault) accept();
    });
  }

  void greet(tcp::socket socket) {
    error_code fault;
    const tcp::endpoint remote = socket.remote_endpoint(fault);
    if (fault) return;
    if (hub.connections >= hub.options.max_connections) return turn_away(std::move(socket));
    Peer peer{std::make_shared<Connection>(hub), remote.address().to_string(),
              remote.address().is_loopback()};
    if (tls) {
      std::make_shared<Doorman>(hub, *tls, std::move(socket), std::move(peer))->look();
      return;
    }
    std::make_shared<HttpSession<PlainStream>>(hub, PlainStream(std::move(socket)),
                                               beast::flat_buffer{}, std::move(peer), false)
        ->begin();
  }

  /// In one go: nobody waits for who is one too many.
  static void turn_away(tcp::socket socket) {
    static constexpr char kWords[] =
        "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 21\r\n\r\n"
        "too many connections\n";
    error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(kWords, sizeof kWords - 1), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
  }

  void tick() {
    const double now = LiveWorld::clock();
    hub.room.look_around(now);
    // A page that is dropped leaves the list only when its last handler has run.
    for (const auto& [id, page] : hub.pages) page->tick(now);
    next_tick += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / hub.options.rate));
    next_tick = std::max(next_tick, std::chrono::steady_clock::now());
    timer.expires_at(next_tick);
    timer.async_wait([this](error_code fault) {
      if (!fault) tick();
    });
  }

  void say_farewell() {
    error_code ignored;
    acceptor.close(ignored);
    timer.cancel();
    for (const auto& [id, page] : hub.pages) page->end();
    retry.expires_after(kFarewell);
    retry.async_wait([this](error_code) { hub.io.stop(); });
  }

  /// Before anybody is told that there is a server: a signal may follow at once.
  void heed_signals() {
    signals.add(SIGINT);
    signals.add(SIGTERM);
    signals.async_wait([this](error_code fault, int) {
      if (!fault) say_farewell();
    });
  }

  void run() {
    accept();
    tick();
    hub.io.run();
  }

  std::optional<asio::ssl::context> tls;
  Hub hub;
  tcp::acceptor acceptor{hub.io};
  asio::steady_timer timer{hub.io};
  asio::steady_timer retry{hub.io};
  asio::signal_set signals{hub.io};
  std::chrono::steady_clock::time_point next_tick = std::chrono::steady_clock::now();
};

Expected<void> check_server(const ServerOptions& options) {
  const Expected<tcp::endpoint> endpoint = endpoint_of(options);
  if (!endpoint) return endpoint.error();
  const Expected<Certified> certified = check(options, *endpoint);
  if (!certified) return certified.error();
  asio::io_context io;
  tcp::acceptor acceptor(io);
  return listen(acceptor, *endpoint, options);
}

Expected<LiveServer> LiveServer::open(const ServerOptions& options, LiveWorld& world,
                                      const ContentSource& content) {
  PCAVR_REQUIRE(options.rate >= 1.0 && options.rate <= 1000.0, options.rate);
  PCAVR_REQUIRE(options.max_write_time > 0.0, options.max_write_time);
  const Expected<tcp::endpoint> endpoint = endpoint_of(options);
  if (!endpoint) return endpoint.error();
  Expected<Certified> certified = check(options, *endpoint);
  if (!certified) return certified.error();
  Expected<Pairing> pairing = Pairing::create();
  if (!pairing) return pairing.error();
  HouseFacts facts{options.version, options.scene, options.is_replay, machine_names(),
                   !endpoint->address().is_loopback()};
  facts.host_names.insert(facts.host_names.end(), certified->names.begin(), certified->names.end());
  auto impl = std::make_unique<Impl>(
      options, world,
      std::make_unique<FrontDesk>(std::move(facts), content, options.page, std::move(*pairing)));
  impl->tls = std::move(certified->tls);
  const Expected<void> listening = listen(impl->acceptor, *endpoint, options);
  if (!listening) return listening.error();
  if (options.ends_on_signals) impl->heed_signals();
  return LiveServer(std::move(impl));
}

LiveServer::LiveServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LiveServer::LiveServer(LiveServer&&) noexcept = default;
LiveServer& LiveServer::operator=(LiveServer&&) noexcept = default;
LiveServer::~LiveServer() = default;

std::uint16_t LiveServer::port() const {
  error_code ignored;
  return impl_->acceptor.local_endpoint(ignored).port();
}
const std::string& LiveServer::pairing_code() const { return impl_->hub.desk->code(); }
void LiveServer::run() { impl_->run(); }
void LiveServer::stop() {
  asio::post(impl_->hub.io, [impl = impl_.get()] { impl->say_farewell(); });
}

}  // namespace pcavr
