// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pcavr/core/expected.hpp"
#include "pcavr/serve/certificate.hpp"
#include "pcavr/serve/content.hpp"
#include "pcavr/serve/live_world.hpp"

namespace pcavr {

struct ServerOptions {
  std::string host = "127.0.0.1";   ///< an address of this machine, or "localhost"
  std::uint16_t port = 8080;        ///< 0: one that is free
  std::filesystem::path page = {};  ///< folder with the page's index.html
  std::optional<TlsFiles> tls = {};
  double rate = 90.0;  ///< [Hz] 60 to 90: states sent to each page
  std::string version = {};
  std::string scene = {};             ///< its name on pages
  bool is_replay = false;             ///< the page starts in replay mode
  double tool_radius = 0.01;          ///< [m]
  std::size_t max_pages = 32;         ///< further ones get an error notice and are closed
  std::size_t max_connections = 256;  ///< of all kinds
  double max_write_time = 5.0;        ///< [s] > 0: write timeout of a message to a page
  bool ends_on_signals = false;       ///< SIGINT and SIGTERM end run(), even if sent before it
};

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
  /// was not built, a bad certificate.
  [[nodiscard]] static Expected<LiveServer> open(const ServerOptions& options, LiveWorld& world,
                                                 const ContentSource& content);
  LiveServer(LiveServer&&) noexcept;
  LiveServer& operator=(LiveServer&&) noexcept;
  ~LiveServer();

  [[nodiscard]] std::uint16_t port() const;
  /// The code to pair a page on another machine; empty if only this machine can connect.
  [[nodiscard]] const std::string& pairing_code() const;

  /// Serves until stop() or a signal. Call once.
  void run();
  /// From any thread, also before run().
  void stop();

 private:
  struct Impl;
  explicit LiveServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace pcavr
