// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/live_world.hpp"

namespace pcavr {

/// The pages that are connected, what they say, and who has the tool. Knows no sockets: bytes come
/// in, bytes go out. One thread; times are LiveWorld::clock's [s].
class LiveRoom {
 public:
  using PageId = std::uint32_t;
  using Send = std::function<void(PageId, std::vector<std::uint8_t>)>;

  /// Keeps references to `world` and what `send` names; both must outlive it.
  LiveRoom(LiveWorld& world, LiveWelcome welcome, Send send);

  [[nodiscard]] PageId join();
  /// The page is gone, however that came about. What it held is let go.
  void leave(PageId page);
  /// False: after what was sent in answer, that is the end of this page.
  [[nodiscard]] bool hear(PageId page, std::span<const std::uint8_t> bytes, double now);
  /// To be called some ten times a second at least: takes the tool from who fell silent.
  void look_around(double now);

  /// Whether the page has said hello: it gets states from then on.
  [[nodiscard]] bool is_greeted(PageId page) const;
  /// The newest state as this page sees it. `queue_age` [s]: how long its last message took to go.
  void write_state(PageId page, double now, double queue_age, std::vector<std::uint8_t>& bytes);

 private:
  struct Page {
    bool is_greeted = false;
    std::uint32_t heard = 0;  ///< sequence of the newest message from it
    std::uint32_t said = 0;   ///< of the newest to it
    double last_tool = 0.0;   ///< [s] when it last said where its tool is
    bool is_engaged = false;
  };

  template <typename Content>
  void say(PageId page, Content content, double now);
  void tell(PageId page, LiveLevel level, const std::string& text, double now);
  [[nodiscard]] bool greet(PageId page, const PageMessage& message, double now);
  void move_tool(PageId page, const LiveHead& head, const LiveTool& tool, double now);
  void obey(PageId page, LiveCommand command, double now);
  void take_tool(PageId page, double now);
  void release_tool();

  LiveWorld& world_;
  LiveWelcome welcome_;
  Send send_;
  std::map<PageId, Page> pages_;
  std::optional<PageId> holder_;
  PageId last_page_ = 0;
  LiveState state_;
};

}  // namespace pcavr
