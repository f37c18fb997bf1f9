// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "pcavr/teleoperation/link/correction_channel.hpp"
#include "pcavr/teleoperation/sites/link_sites.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

#include "site_log.hpp"

namespace pcavr {

/// The robot site's corrections at the operator's site: received, applied to its world, counted.
/// Times are the site's [s] unless stated. One thread.
class CorrectionIntake {
 public:
  explicit CorrectionIntake(SiteLog& log) : log_(log) {}

  /// A new session, whose numbers begin anew.
  void begin() { receiver_ = {}; }
  void add(LinkCorrection correction) {
    if (!receiver_.accept(std::move(correction))) ++repeated_;
  }
  /// Applies those that are due before `t_next` to `site`, whose time begins at `start`; both [s]
  /// of the shared clock.
  void apply(LiveOperatorSite& site, std::uint32_t session, double now, double start,
             double t_next) {
    for (const LinkCorrection& correction : receiver_.take(t_next)) {
      const double t = correction.t - start;
      const bool is_valid = site.apply(t, correction.bytes);
      log_.on_applied(now, session, correction, is_valid);
      if (!is_valid) {
        ++invalid_;
        continue;
      }
      ++applied_;
      if (t_applied_.size() < kMaxReportedTimes) t_applied_.push_back(t);
    }
  }
  [[nodiscard]] LinkAcknowledgement acknowledgement() const { return receiver_.acknowledgement(); }
  void add_to(OperatorSiteReport& report) const {
    report.corrections += applied_;
    report.repeated_corrections += repeated_;
    report.invalid_messages += invalid_;
    report.t_corrected = t_applied_;
  }

 private:
  static constexpr std::size_t kMaxReportedTimes = 10'000;

  SiteLog& log_;
  CorrectionReceiver receiver_;
  std::size_t applied_ = 0, repeated_ = 0, invalid_ = 0;
  std::vector<double> t_applied_;
};

}  // namespace pcavr
