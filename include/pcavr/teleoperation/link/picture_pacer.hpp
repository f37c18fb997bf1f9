// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// See src/teleoperation/link/picture_pacer.cpp for meanings, ranges and defaults.
struct PictureOptions {
  PictureOptions();
  double max_rate;       ///< [Hz]; 0: no pictures
  double max_bandwidth;  ///< [kB/s]
};
[[nodiscard]] OptionSection section_of(PictureOptions& options);

/// When the robot's site sends the next picture, and how large it may be. Pictures share the link
/// with commands and states, which must not wait behind them: their rate of bytes falls by three
/// tenths once they arrive later than the fastest ones by more than a few cycles of the display,
/// because they queue, and grows slowly while they do not (delay-based congestion control, as
/// RFC 6817). Times are those of the shared clock [s]. Not thread-safe.
class PicturePacer {
 public:
  explicit PicturePacer(const PictureOptions& options = {});

  /// [bytes] of a picture that may be sent now; empty: not yet.
  [[nodiscard]] std::optional<std::size_t> max_bytes(double now) const;
  void note_sent(std::uint32_t sequence, std::size_t bytes, double now);
  /// The picture of that sequence number arrived at `received`; this is known at `now`.
  void note_receipt(std::uint32_t sequence, double received, double now);
  /// A new session: what was sent before will not be acknowledged.
  void restart();
  /// [bytes/s]
  [[nodiscard]] double bandwidth() const { return bandwidth_; }

 private:
  struct Sent {
    std::uint32_t sequence = 0;
    double t = 0.0;
    std::size_t bytes = 0;
  };
  void slow_down(double now);

  PictureOptions options_;
  double bandwidth_;                        ///< [bytes/s]
  std::deque<Sent> sent_;                   ///< not acknowledged
  double next_ = 0.0;                       ///< [s]
  std::optional<double> min_transit_ = {};  ///< [s]
  double last_receipt_ = 0.0;               ///< [s]
  double slowed_at_ = 0.0;                  ///< [s]
};

}  // namespace pcavr
