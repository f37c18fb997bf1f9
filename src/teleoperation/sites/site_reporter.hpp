// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>

#include "pcavr/base/core/observer.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

#include "site_log.hpp"

namespace pcavr {

/// A site's events, for its user and its log. Keeps references.
class SiteReporter {
 public:
  SiteReporter(const Observer& observer, SiteLog* log)
      : observer_(observer), log_(log != nullptr ? *log : none_) {}
  SiteReporter(const SiteReporter&) = delete;
  SiteReporter& operator=(const SiteReporter&) = delete;

  [[nodiscard]] SiteLog& log() { return log_; }
  void note(double now, const std::string& text) {
    observer_.on_note(text);
    log_.on_event(now, SiteLog::Level::note, text);
  }
  void warn(double now, const std::string& text) {
    observer_.on_warning(text);
    log_.on_event(now, SiteLog::Level::warning, text);
  }
  /// Reports once that the log has ended.
  void check_log() {
    if (const auto fault = log_.take_fault()) observer_.on_warning("the log has ended: " + *fault);
  }
  /// Round trips are logged as what they show, not one by one.
  [[nodiscard]] static bool is_logged(const LinkMessage& message) {
    return !std::holds_alternative<LinkPing>(message.content) &&
           !std::holds_alternative<LinkPong>(message.content) &&
           !std::holds_alternative<LinkPicture>(message.content);
  }

 private:
  const Observer& observer_;
  SiteLog none_;
  SiteLog& log_;
};

}  // namespace pcavr
