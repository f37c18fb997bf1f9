// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/page_world.hpp"
#include "pcavr/serve/viewer_scene.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

struct ServerOptions {
  ServerOptions();
  std::string host;            ///< an address of this machine, or "localhost"; 127.0.0.1
  std::uint16_t port;          ///< 0: one that is free
  std::filesystem::path page;  ///< folder with the page's index.html
  std::optional<TlsFiles> tls;
  std::string version;
  std::string scene;          ///< its name on pages
  bool is_replay;             ///< the page starts in replay mode
  bool ends_on_signals;       ///< SIGINT and SIGTERM end run(), even if sent before it
  double tool_radius;         ///< [m]
  double rate;                ///< [Hz] states sent to each page
  int max_pages;              ///< further ones get an error notice and are closed
  int max_connections;        ///< of all kinds
  double max_address_share;   ///< of either, for one address (an IPv6 network of 64 bits)
  double max_write_time;      ///< [s] write timeout of a message to a page
  double read_timeout;        ///< [s] of a request, and of a TLS handshake
  double response_timeout;    ///< [s] of a response, in addition to its length over the rate below
  double min_download_rate;   ///< [bytes/s] slower downloads time out
  double handshake_timeout;   ///< [s] of a WebSocket
  double hello_timeout;       ///< [s] from there to a valid hello
  double idle_timeout;        ///< [s] of a page that does not answer pings
  double tool_timeout;        ///< [s] without a sample: the page loses the tool
  double tool_idle_time;      ///< [s] with an open clutch: the tool goes to a page that requests it
  double shutdown_timeout;    ///< [s] for the closing handshakes with the pages
  int max_queued_messages;    ///< to a page; of more, it counts as not reading
  int max_messages_per_tick;  ///< of a page, between two states (rate limit)
  int send_buffer;            ///< [bytes] of a page's socket (SO_SNDBUF)
};
[[nodiscard]] OptionSection section_of(ServerOptions& options);

/// Checks whether such a server could be opened now; the same errors as LiveServer::open. For use
/// before the expensive content is created.
[[nodiscard]] Expected<void> check_server(const ServerOptions& options);

/// HTTP(S) and WebSocket server on one port: the page, the scene's files, and the live state
/// (docs/live-protocol.md). One thread does the network I/O, another one reads files; neither
/// blocks the world. Backpressure: a page that reads too slowly gets fewer states, always the
/// newest; one that does not read is disconnected.
class LiveServer {
 public:
  /// Listens, but serves no request yet. `world` and `content` must outlive it. Errors: a port in
  /// use, an address that is not this machine's, one that others can reach without TLS, a page that
  /// was not built, a bad certificate. `viewer`: the scene, for viewers by the Foxglove protocol.
  [[nodiscard]] static Expected<LiveServer> open(const ServerOptions& options, PageWorld& world,
                                                 const ContentSource& content,
                                                 ViewerScene viewer = {});
  LiveServer(LiveServer&&) noexcept;
  LiveServer& operator=(LiveServer&&) noexcept;
  ~LiveServer();

  [[nodiscard]] std::uint16_t port() const;
  /// The code to pair a page on another machine; empty if only this machine can connect.
  [[nodiscard]] const std::string& pairing_code() const;

  /// Serves until stop() or a signal. Call once.
  void run();
  /// May be called from any thread, also before run().
  void stop();

 private:
  struct State;
  explicit LiveServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pcavr
