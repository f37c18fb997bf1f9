// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>

namespace pcavr {

/// Detects that a pushed body slides, and that it rests, from its tracked poses: means over the
/// quarters of a window, each of which must be ahead of the one before by more than their noise. So
/// a single frame is no motion, nor is a step by a clock that is late; and the noise averages out
/// in slides that force and tip do not show, as their speed is that of a contact being loaded.
class SlowSlide {
 public:
  /// `window` [s], the shortest that is tried; `min_displacement` [m] within it.
  SlowSlide(double window, double min_displacement)
      : window_(window), min_displacement_(min_displacement) {}

  /// Positions of the touched point and of the tip along the push [m].
  struct Frame {
    double t = 0.0;  ///< [s]
    double body = 0.0;
    double body_std = 0.0;
    double tip = 0.0;
  };
  /// Forgets all frames. `rest`: the coordinate from which it will slide, if it is known.
  void restart(std::optional<double> rest = {});
  /// Adds a frame, in ascending order of time.
  void add(const Frame& frame);
  /// When a slide began that lasts until the last frame [s]; empty: none is significant.
  [[nodiscard]] std::optional<double> onset() const;
  /// Whether it rested in the newest frames.
  [[nodiscard]] bool is_at_rest() const;

 private:
  struct Mean {
    double t = 0.0, body = 0.0, variance = 0.0, tip = 0.0;
  };
  /// Mean of the frames within [from, to); empty without any.
  [[nodiscard]] std::optional<Mean> mean_of(double from, double to) const;
  /// Maximum std of a frame [m], by the scatter of the frames.
  [[nodiscard]] double scatter_std() const;
  [[nodiscard]] std::optional<double> onset_within(double window) const;

  double window_;
  double min_displacement_;
  std::deque<Frame> frames_;
  double max_std_ = 0.0;  ///< [m] scatter_std() of `frames_`
  std::optional<double> rest_;
};

}  // namespace pcavr
