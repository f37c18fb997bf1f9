// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/cycle_histogram.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"
#include "pcavr/teleoperation/link/delay_stages.hpp"
#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {

class PageRecorder;

/// The link to a robot's site, in a snapshot. Times [s] are CLOCK_MONOTONIC.
struct LinkSnapshot {
  bool is_connected = false;            ///< false: the robot holds, and the clutch is open
  double silence = 0.0;                 ///< [s] since a message from the robot's site
  double lead = 0.0;                    ///< [s] from sending a command to its execution
  double round_trip = 0.0;              ///< [s] fastest
  double clock_std = 0.0;               ///< [s] of the shared clock
  std::optional<LinkState> robot = {};  ///< its newest state, of this session or of the last one
  std::optional<DelayStamps> delays = {};
  std::uint32_t picture = 0;         ///< number of the newest one of the robot's camera; 0: none
  double picture_age = 0.0;          ///< [s]
  std::uint16_t picture_width = 0;   ///< [px]
  std::uint16_t picture_height = 0;  ///< [px]
  std::optional<LinkPictureCamera> picture_camera = {};
};

/// The world at the end of one cycle, with timing statistics.
struct WorldSnapshot {
  double t = 0.0;          ///< [s] simulation time: cycles times their period and time scale
  double published = 0.0;  ///< [s] by LiveWorld::clock
  HapticWorldState world;
  std::vector<double> speeds;  ///< [m/s] of each body's origin, in simulated time
  bool is_on_hold = false;
  bool is_stopped = false;   ///< emergency stop
  double time_scale = 1.0;   ///< simulated over real time
  double pulse = 0.0;        ///< 0 to 1: vibration amplitude for a controller
  std::uint32_t pulses = 0;  ///< first contacts and breakaways so far
  std::uint32_t cycles = 0;
  std::uint32_t late_cycles = 0;     ///< overruns: began at least a cycle late, or were skipped
  CycleTimes times = {};             ///< over the last second
  std::optional<ArmState> arm = {};  ///< if there is an arm
  bool arm_meets_scan = false;       ///< its surface 0 is the scan, else the first body
  RemoteStatus page = {};            ///< if a page moves the tool: the sample that was used
  std::optional<LinkSnapshot> link = {};  ///< at an operator's site
};

/// A world that pages show and command. The functions without a note are for any thread.
class PageWorld {
 public:
  virtual ~PageWorld() = default;

  /// Notes for the person at a page, such as a missing real-time priority.
  [[nodiscard]] virtual const std::vector<std::string>& notes() const = 0;
  [[nodiscard]] virtual const std::vector<std::string>& names() const = 0;
  [[nodiscard]] virtual std::string_view device_name() const = 0;
  /// The device that pages send samples to; null if another device moves the tool.
  [[nodiscard]] virtual RemoteDevice* page_device() noexcept = 0;
  /// Its bodies exist elsewhere: neither reset(), undo_reset() nor the time scale has an effect.
  [[nodiscard]] virtual bool is_remote() const noexcept { return false; }

  /// Freezes the tool's command; opening the clutch still disengages the tool. After resuming, the
  /// tool continues from its current pose. Takes effect with the next cycle.
  virtual void hold(bool is_on_hold) noexcept = 0;
  /// Disengages the tool until it is released; afterwards the world is on hold, and the clutch must
  /// open before it closes again.
  virtual void emergency_stop() noexcept = 0;
  virtual void release_emergency_stop() noexcept = 0;
  /// Restores the initial state of all bodies and of the tool.
  virtual void reset() noexcept = 0;
  /// Puts the bodies back where the last reset found them, unless one was touched since.
  virtual void undo_reset() noexcept = 0;
  /// Sets the time scale, clamped to 0.1 to 1. Takes effect with the next cycle.
  virtual void set_time_scale(double scale) noexcept = 0;
  [[nodiscard]] virtual double time_scale() const noexcept = 0;

  /// What records it at a page's request; null where nothing does.
  [[nodiscard]] virtual PageRecorder* recorder() noexcept { return nullptr; }

  /// The newest snapshot; valid until the next call. One thread at a time.
  [[nodiscard]] virtual const WorldSnapshot& newest() noexcept = 0;
};

}  // namespace pcavr
