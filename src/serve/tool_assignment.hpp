// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>

namespace pcavr {

/// The page that has the tool, and those that ask for it. Sends no messages; times [s] ascend.
///
/// A page that asks gets a free tool at once. A tool that another page uses goes to the first that
/// asks when its holder hands it over, releases it, leaves, or has not held the clutch for the idle
/// time; unless the holder refuses.
class ToolAssignment {
 public:
  using PageId = std::uint32_t;
  /// A change of the tool's holder. Without `to` the tool is free.
  struct Change {
    enum class Reason { taken, handed_over, idle, silent };
    Reason reason = Reason::taken;
    std::optional<PageId> from = {};
    std::optional<PageId> to = {};
  };
  enum class Answer { given, asked, already_asked, refused_before };

  /// `timeout` [s]: a page that holds the clutch and is silent for longer loses the tool
  /// (watchdog). `idle_time` [s]: see above; a page that was refused can't ask again for as long.
  ToolAssignment(double timeout, double idle_time) : timeout_(timeout), idle_time_(idle_time) {}

  [[nodiscard]] std::optional<PageId> holder() const { return holder_; }
  [[nodiscard]] bool is_held_by(PageId page) const { return holder_ == page; }
  /// Whether a page other than `page` has the tool and uses it.
  [[nodiscard]] bool is_used_by_another(PageId page, double now) const;
  [[nodiscard]] bool is_asked_for() const { return !requests_.empty(); }
  [[nodiscard]] bool has_asked(PageId page) const;
  [[nodiscard]] double idle_time() const { return idle_time_; }

  /// The page asks for the tool. The holder's own request is answered with `given`.
  [[nodiscard]] Answer request(PageId page, double now);
  /// The page gives the tool back, or no longer asks. True if it had it.
  bool release(PageId page);
  /// Does the same as release() for a page that has disconnected.
  bool leave(PageId page);
  /// The holder hands the tool over to the first that asks; nothing if none does.
  [[nodiscard]] std::optional<Change> hand_over(PageId holder, double now);
  /// The holder refuses all requests; returns the pages that have asked.
  [[nodiscard]] std::deque<PageId> refuse(PageId holder, double now);
  /// The page has moved the tool. Only for the holder.
  void use(bool is_engaged, double now);
  /// The change that is due; one a call.
  [[nodiscard]] std::optional<Change> update(double now);

 private:
  Change give(PageId page, Change::Reason reason, double now);

  double timeout_;
  double idle_time_;
  std::optional<PageId> holder_;
  bool is_engaged_ = false;    ///< the holder's clutch is closed
  double last_use_ = 0.0;      ///< [s] when the holder last moved the tool
  double last_engaged_ = 0.0;  ///< [s] when it last took the tool or held the clutch
  std::deque<PageId> requests_;
  std::map<PageId, double> refused_;  ///< [s] when the page was refused last
};

}  // namespace pcavr
