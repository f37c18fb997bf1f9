// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "pcavr/recordings/recording/joint_log.hpp"

namespace pcavr {

/// Findings about the samples' own clock.
struct SampleClock {
  bool is_corrected = false;  ///< stamps were replaced by multiples of `tick`
  double tick = 0.0;          ///< [s] cycle of the robot's controller
  std::size_t repeated = 0;   ///< rows that repeat the previous sample: removed
  std::size_t skipped = 0;    ///< cycles without a row
};

/// A logger that reads a controller's state without waiting for its cycle stamps the instant of
/// reading: some samples come twice, others never, and speeds differentiated over these stamps are
/// noise. Where positions and velocities together show that the intervals between samples are whole
/// multiples of one cycle and the stamps are not, this replaces the stamps by those multiples and
/// removes repeated rows. Otherwise, and without velocities, the log stays as it is.
[[nodiscard]] SampleClock correct_sample_clock(JointLog& log);

}  // namespace pcavr
