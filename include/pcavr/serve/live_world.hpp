// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/core/expected.hpp"
#include "pcavr/devices/device.hpp"
#include "pcavr/devices/remote_device.hpp"
#include "pcavr/haptics/haptic_world.hpp"

namespace pcavr {

/// How long cycles took [s], from their begin to their end.
struct CycleTimes {
  double median = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double longest = 0.0;
};

/// The world at the end of one cycle, with what is told about it.
struct WorldSnapshot {
  double t = 0.0;          ///< [s] of the world: its cycles, one after the other
  double published = 0.0;  ///< [s] of LiveWorld::clock
  HapticWorldState world;
  std::vector<double> speeds;  ///< [m/s] by body, of its origin
  bool is_on_hold = false;
  double pulse = 0.0;        ///< 0 to 1: what a controller should give now
  std::uint32_t pulses = 0;  ///< first touches and breakaways so far
  std::uint32_t cycles = 0;
  std::uint32_t late_cycles = 0;  ///< began a whole cycle late or more, or never
  CycleTimes times = {};          ///< over the last second
  RemoteUse page = {};            ///< where a page moves the tool: what was used of it
};

struct LiveWorldOptions {
  double cycle = 0.001;  ///< [s] > 0
  /// [m] base frame: where the tool is at the start, and after a reset.
  Eigen::Vector3d p_base_tool_start = Eigen::Vector3d::Zero();
  double full_force = 5.0;  ///< [N] > 0: at which a controller's pulses are strongest
};

/// A haptic world that runs by itself: a thread of its own, a cycle each millisecond, device to
/// force. No call of another thread makes it wait, and it waits for none: what it publishes is the
/// newest, whether or not somebody looks.
///
/// Deadlines are absolute. A cycle that begins late is run all the same, so that the world's time
/// goes with the clock's; more than twenty in arrears are left out. Both are counted.
class LiveWorld {
 public:
  /// Options in range: PCAVR_REQUIRE.
  LiveWorld(HapticWorld world, std::unique_ptr<Device> device, const LiveWorldOptions& options);
  ~LiveWorld();
  LiveWorld(const LiveWorld&) = delete;
  LiveWorld& operator=(const LiveWorld&) = delete;

  /// The clock that everything here is told by: monotonic [s].
  [[nodiscard]] static double clock() noexcept;

  /// Starts the thread, with real-time priority and its memory kept where that is permitted. What
  /// is not is said in the notes, and it runs without. Call once.
  [[nodiscard]] Expected<std::vector<std::string>> start();
  /// Ends the thread. The destructor does it too.
  void stop() noexcept;

  /// Of all cycles so far. Before start(), or after stop().
  [[nodiscard]] CycleTimes times() const;

  [[nodiscard]] const std::vector<std::string>& names() const;
  [[nodiscard]] std::string_view device_name() const;
  /// The device that pages speak to; null where another one moves the tool.
  [[nodiscard]] RemoteDevice* page_device() noexcept;

  /// Freezes the tool's command where it is; opening the clutch lets go all the same. When it goes
  /// on, the tool goes on from where it is. Any thread; takes effect with the next cycle.
  void hold(bool is_on_hold) noexcept;
  /// Everything back to where it was at the start, the tool too. Any thread.
  void reset() noexcept;

  /// The newest snapshot; stays as it is until the next call. One thread at a time.
  [[nodiscard]] const WorldSnapshot& newest() noexcept;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
