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

#include <Eigen/Core>

#include "pcavr/serve/live_protocol.hpp"
#include "pcavr/serve/page_world.hpp"

#include "tool_assignment.hpp"

namespace pcavr {

/// The connected pages: decodes and handles their messages, and gives the tool to one page at a
/// time. Without sockets: bytes in, bytes out. One thread; times [s] are by LiveWorld::clock.
class LiveSessions {
 public:
  using PageId = std::uint32_t;
  using Send = std::function<void(PageId, std::vector<std::uint8_t>)>;

  /// Keeps a reference to `world`, which must outlive it, as must what `send` refers to. A page
  /// that holds the clutch but sends nothing for `tool_timeout` [s] counts as disconnected
  /// (watchdog). `tool_idle_time` [s]: see ToolAssignment.
  LiveSessions(PageWorld& world, LiveWelcome welcome, Send send, double tool_timeout,
               double tool_idle_time);

  [[nodiscard]] PageId join();
  /// The page has disconnected. Releases the tool if it has it.
  void leave(PageId page);
  /// False: close the connection after the replies that were sent.
  [[nodiscard]] bool on_message(PageId page, std::span<const std::uint8_t> bytes, double now);
  /// Releases the tool of an unresponsive page, and gives one that is not used to the page that
  /// asks for it; passes on what recordings report. Call it at least ten times a second.
  void check_timeouts(double now);

  /// Whether the page has sent a valid hello: it gets states from then on.
  [[nodiscard]] bool has_sent_hello(PageId page) const;
  /// The newest state for this page. `queue_age` [s]: how long sending its last message took.
  void write_state(PageId page, double now, double queue_age, std::vector<std::uint8_t>& bytes);

 private:
  struct Page {
    bool has_sent_hello = false;
    std::uint32_t last_received = 0;  ///< sequence number
    std::uint32_t last_sent = 0;      ///< sequence number
  };

  template <typename Content>
  void send(PageId page, Content content, double now);
  void send_notice(PageId page, LiveLevel level, const std::string& text, double now);
  [[nodiscard]] bool on_hello(PageId page, const PageMessage& message, double now);
  void move_tool(PageId page, const LiveHeader& header, const LiveTool& tool, double now);
  void handle_command(PageId page, LiveCommand command, double now);
  void send_notice_to_all(LiveLevel level, const std::string& text, double now,
                          const std::string& about = {});
  void reset(PageId page, double now);
  void undo_reset(double now);
  void record(PageId page, bool is_wanted, double now);
  void change_time_scale(bool is_faster);
  void take_tool(PageId page, double now);
  void keep_tool(PageId page, double now);
  /// Called after the tool has changed hands: no motion of the previous page remains.
  void on_change(const ToolAssignment::Change& change, double now);
  /// Does the same, and sends a notice to the page that has waited for the tool.
  void notify_change(const ToolAssignment::Change& change, double now);
  void release_device();

  PageWorld& world_;
  LiveWelcome welcome_;
  Send send_;
  double tool_timeout_;  ///< [s]
  std::map<PageId, Page> pages_;
  ToolAssignment tool_;
  std::vector<Eigen::Vector3d> starts_;  ///< [m] of the bodies, before they were pushed
  PageId last_page_ = 0;
  LiveState state_;
};

}  // namespace pcavr
