// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace pcavr {

struct SoakOptions {
  std::uint64_t seed = 1;  ///< of the faults, the network, the plant and the person
  double duration = 60.0;  ///< [s] virtual time, with the end
  /// [s] mean time between the beginnings of two faults; infinite: none, processes grow old
  double fault_interval = 4.0;
  double quiet_end = 15.0;  ///< [s] without faults at the end, in which both sites recover
  std::function<std::size_t()> heap_bytes = {};  ///< in use now
};

struct SoakReport {
  std::vector<std::string> violations;         ///< of what must hold; the first of them
  std::uint64_t digest = 0;                    ///< the same for the same options, to the bit
  std::map<std::string, std::size_t> faults;   ///< by kind
  std::map<std::string, std::size_t> endings;  ///< of the operator's program, by its message
  std::size_t sessions = 0;
  std::size_t commands = 0;     ///< executed
  std::size_t corrections = 0;  ///< applied
  double max_age = 0.0;         ///< [s] of an executed command
  double path = 0.0;            ///< [m] of the robot's setpoint
  std::size_t pressed = 0;      ///< times the limit of the force acted
  std::size_t heap_peak = 0;    ///< above the use at the beginning
  std::size_t heap_rest = 0;    ///< the same after both sites have ended
};

/// Does the use of the heap [bytes], sampled at even intervals over a run, grow? Its minimum in the
/// last third against that in the first, by more than half a megabyte. A process's windows of data
/// fill with its age, so that the maximum depends on when processes are started anew; soon after
/// that only what outlives them is left. For processes that are not started anew, give the samples
/// from when their windows are full on.
[[nodiscard]] bool heap_grows(std::span<const std::size_t> samples);

/// Both sites' main loops, message handling, watchdogs and worlds, as the two programs run them, in
/// virtual time with a simulated plant, through a network, machines and keys that fail at random.
/// Deterministic by its options.
[[nodiscard]] SoakReport run_two_sites_soak(const SoakOptions& options);

}  // namespace pcavr
