// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/server.hpp"

#include <chrono>
#include <csignal>
#include <optional>
#include <utility>

#include <boost/asio/ssl/context.hpp>

#include "pcavr/base/core/check.hpp"

#include "network.hpp"
#include "session.hpp"

namespace pcavr {
namespace {

using namespace network;

Error cannot_listen(const ServerOptions& options, const error_code& fault) {
  Error error{.message = "can't listen: " + fault.message(),
              .place = options.host + ':' + std::to_string(options.port)};
  if (fault == asio::error::address_in_use)
    error.hint = "choose another --port, or 0 for a free one";
  if (fault == asio::error::access_denied) error.hint = "choose a --port of 1024 or above";
  return error;
}

Expected<tcp::endpoint> endpoint_of(const ServerOptions& options) {
  error_code fault;
  const auto address =
      asio::ip::make_address(options.host == "localhost" ? "127.0.0.1" : options.host, fault);
  if (!fault) return tcp::endpoint(address, options.port);
  return Error{.message = "not an address: '" + options.host + "'",
               .place = "host",
               .hint = "use an IP address such as 192.168.1.5, or 0.0.0.0 for all interfaces"};
}

/// Loads certificate and key; returns the names that the certificate is for.
Expected<std::vector<std::string>> load(const TlsFiles& files, asio::ssl::context& context) {
  const Expected<CertificateInfo> info = read_certificate(files.certificate);
  if (!info) return info.error();
  error_code fault;
  context.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                          asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                          asio::ssl::context::no_tlsv1_1,
                      fault);
  // Authenticated encryption (AEAD) with forward secrecy only.
  SSL_CTX* const native = context.native_handle();
  const bool has_ciphers =
      SSL_CTX_set_cipher_list(native, "ECDHE+AESGCM:ECDHE+CHACHA20:!aNULL:!PSK") == 1 &&
      SSL_CTX_set_ciphersuites(
          native, "TLS_AES_256_GCM_SHA384:TLS_CHACHA20_POLY1305_SHA256:TLS_AES_128_GCM_SHA256") ==
          1;
  if (!has_ciphers) return Error{.message = "this OpenSSL has no AES-GCM and no ChaCha20-Poly1305"};
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
  return info->names;
}

struct TlsSetup {
  std::optional<asio::ssl::context> tls;
  std::vector<std::string> names;
};

/// Checks the options, except that the port is free.
Expected<TlsSetup> check(const ServerOptions& options, const tcp::endpoint& endpoint) {
  if (!endpoint.address().is_loopback() && !options.tls) {
    return Error{
        .message = options.host + " can be reached from other machines, which requires TLS",
        .place = "host",
        .hint = "add --tls, or omit --host"};
  }
  std::error_code ignored;
  if (!std::filesystem::exists(options.page / "index.html", ignored)) {
    return Error{.message = "no index.html: the page was not built",
                 .file = options.page.string(),
                 .hint = "build apps/viewer, or give its folder with --page"};
  }
  TlsSetup setup;
  if (!options.tls) return setup;
  setup.tls.emplace(asio::ssl::context::tls_server);
  Expected<std::vector<std::string>> names = load(*options.tls, *setup.tls);
  if (!names) return names.error();
  setup.names = std::move(*names);
  return setup;
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

struct LiveServer::State {
  State(const ServerOptions& options, PageWorld& world, const ContentSource& content,
        ViewerScene viewer, std::unique_ptr<HttpHandler> http_handler)
      : hub(options, world, content, std::move(viewer), std::move(http_handler)) {}

  void accept() {
    acceptor.async_accept([this](error_code fault, tcp::socket socket) {
      if (fault == asio::error::operation_aborted) return;
      if (fault) return accept_later();
      open_connection(std::move(socket));
      accept();
    });
  }

  /// Out of file descriptors: retries, since a connection may have ended.
  void accept_later() {
    retry.expires_after(std::chrono::milliseconds(100));
    retry.async_wait([this](error_code fault) {
      if (!fault) accept();
    });
  }

  void open_connection(tcp::socket socket) {
    error_code fault;
    const tcp::endpoint remote = socket.remote_endpoint(fault);
    if (fault) return;
    const std::string network = network_of(remote.address());
    const auto of_network = hub.connections_by_network.find(network);
    const bool has_its_share =
        of_network != hub.connections_by_network.end() &&
        of_network->second >= share_of(hub.options.max_connections, hub.options);
    if (has_its_share || hub.connections >= hub.options.max_connections) {
      return reject_connection(std::move(socket));
    }
    Peer peer{std::make_shared<Connection>(hub, network), remote.address().to_string(), network,
              remote.address().is_loopback()};
    if (tls) return begin_tls_session(hub, *tls, std::move(socket), std::move(peer));
    begin_plain_session(hub, std::move(socket), std::move(peer));
  }

  /// Non-blocking, without a session.
  static void reject_connection(tcp::socket socket) {
    static constexpr char kResponse[] =
        "HTTP/1.1 503 Service Unavailable\r\nConnection: close\r\nContent-Length: 21\r\n\r\n"
        "too many connections\n";
    error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(kResponse, sizeof kResponse - 1), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
  }

  void tick() {
    const double now = LiveWorld::clock();
    hub.sessions.check_timeouts(now);
    // A page is removed from the list when its last handler has run, so not in this loop.
    for (const auto& [id, page] : hub.pages) page->tick(now);
    hub.channels.update(now);
    for (Client* viewer : hub.viewers) viewer->tick(now);
    next_tick += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / hub.options.rate));
    next_tick = std::max(next_tick, std::chrono::steady_clock::now());
    timer.expires_at(next_tick);
    timer.async_wait([this](error_code fault) {
      if (!fault) tick();
    });
  }

  void shutdown_gracefully() {
    error_code ignored;
    acceptor.close(ignored);
    timer.cancel();
    for (const auto& [id, page] : hub.pages) page->end();
    for (Client* viewer : hub.viewers) viewer->end();
    retry.expires_after(duration_of(hub.options.shutdown_timeout));
    retry.async_wait([this](error_code) { hub.io.stop(); });
  }

  /// Called before the server is announced: a signal may follow at once.
  void install_signal_handlers() {
    signals.add(SIGINT);
    signals.add(SIGTERM);
    // A closed terminal sends SIGHUP, unless nohup has it ignored.
    struct sigaction hangup {};
    ::sigaction(SIGHUP, nullptr, &hangup);
    if (hangup.sa_handler != SIG_IGN) signals.add(SIGHUP);
    signals.async_wait([this](error_code fault, int) {
      if (!fault) shutdown_gracefully();
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
  const Expected<TlsSetup> setup = check(options, *endpoint);
  if (!setup) return setup.error();
  asio::io_context io;
  tcp::acceptor acceptor(io);
  return listen(acceptor, *endpoint, options);
}

Expected<LiveServer> LiveServer::open(const ServerOptions& options, PageWorld& world,
                                      const ContentSource& content, ViewerScene viewer) {
  PCAVR_REQUIRE(options.rate >= 1.0 && options.rate <= 1000.0, options.rate);
  PCAVR_REQUIRE(options.max_write_time > 0.0, options.max_write_time);
  PCAVR_REQUIRE(options.min_download_rate > 0.0, options.min_download_rate);
  const Expected<tcp::endpoint> endpoint = endpoint_of(options);
  if (!endpoint) return endpoint.error();
  Expected<TlsSetup> setup = check(options, *endpoint);
  if (!setup) return setup.error();
  Expected<Pairing> pairing = Pairing::create();
  if (!pairing) return pairing.error();
  ServerInfo info{options.version, options.scene, options.is_replay, machine_names(),
                  !endpoint->address().is_loopback()};
  info.host_names.insert(info.host_names.end(), setup->names.begin(), setup->names.end());
  auto state = std::make_unique<State>(
      options, world, content, std::move(viewer),
      std::make_unique<HttpHandler>(std::move(info), content, options.page, std::move(*pairing)));
  state->tls = std::move(setup->tls);
  const Expected<void> listening = listen(state->acceptor, *endpoint, options);
  if (!listening) return listening.error();
  if (options.ends_on_signals) state->install_signal_handlers();
  return LiveServer(std::move(state));
}

LiveServer::LiveServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
LiveServer::LiveServer(LiveServer&&) noexcept = default;
LiveServer& LiveServer::operator=(LiveServer&&) noexcept = default;
LiveServer::~LiveServer() = default;

std::uint16_t LiveServer::port() const {
  error_code ignored;
  return state_->acceptor.local_endpoint(ignored).port();
}
const std::string& LiveServer::pairing_code() const { return state_->hub.http_handler->code(); }
void LiveServer::run() { state_->run(); }
void LiveServer::stop() {
  asio::post(state_->hub.io, [state = state_.get()] { state->shutdown_gracefully(); });
}

}  // namespace pcavr
