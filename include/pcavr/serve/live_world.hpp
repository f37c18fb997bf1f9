// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/robots/robot/arm_follower.hpp"
#include "pcavr/serve/page_world.hpp"
#include "pcavr/serve/scene_arm.hpp"
#include "pcavr/teleoperation/devices/device.hpp"
#include "pcavr/teleoperation/devices/remote_device.hpp"
#include "pcavr/teleoperation/haptics/haptic_world.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp
class SessionRecorder;

/// Vibration of controllers without force feedback.
struct VibrationOptions {
  VibrationOptions();
  double pulse_duration;            ///< [s] at full amplitude
  double decay_time;                ///< [s] time constant of the exponential decay after it
  double max_vibration;             ///< 0 to 1: amplitude of the continuous vibration
  double min_time_without_contact;  ///< [s] debounces the first contact of a tip that chatters
};
[[nodiscard]] OptionSection section_of(VibrationOptions& options);

/// The tool in the operator's hand: straight, from the grip along the tool's z axis to the tip. The
/// force at its tip becomes a torque about the grip; its weight is felt while the clutch is closed.
/// Both do as much work on the hand as the force at the tip and the weight do, so that the
/// rendering stays passive. The weight of a body that is pushed is felt by its friction on the
/// support.
struct HandToolOptions {
  HandToolOptions();
  double length;                        ///< [m] from the grip to the tip
  double mass;                          ///< [kg]
  double centre_share;                  ///< of the length: from the grip to the centre of mass
  [[nodiscard]] double weight() const;  ///< [N]
};
[[nodiscard]] OptionSection section_of(HandToolOptions& options);

struct LiveWorldOptions {
  LiveWorldOptions();
  double cycle;         ///< [s]
  int thread_priority;  ///< of SCHED_FIFO
  int max_backlog;      ///< [cycles] of more, all are skipped
  /// 0.1 to 1: simulated over real time at the start [paper A's two time scales]. A slowed world's
  /// force is rendered times this: its damping and inertia, felt 1 / this and 1 / this^2 times as
  /// large by the slow hand, are then at most 1 / this times; its stiffness is that much less. The
  /// energy budget scales with the force, so that the rendering stays passive.
  double time_scale;
  /// [m] base frame: the tool's position at the start and after a reset.
  Eigen::Vector3d p_base_tool_start;
  double full_scale_force;  ///< [N] > 0: force of the strongest continuous vibration
  VibrationOptions vibration;
  HandToolOptions tool;
};
/// The section without `vibration` and `tool`, which have their own.
[[nodiscard]] OptionSection section_of(LiveWorldOptions& options);

/// Runs a haptic world in real time on its own thread: one cycle per millisecond, from the device's
/// sample to the force. Wait-free towards other threads: state is published through a triple
/// buffer.
///
/// Deadlines are absolute. A late cycle is still run, so that simulation time follows the clock;
/// with more than `max_backlog` cycles of backlog they are skipped. Both count as overruns.
class LiveWorld final : public PageWorld {
 public:
  /// Options in range: PCAVR_REQUIRE. `arm`, if any, follows the tool.
  LiveWorld(HapticWorld world, std::unique_ptr<Device> device, const LiveWorldOptions& options,
            std::unique_ptr<LiveArm> arm = nullptr);
  ~LiveWorld() override;
  LiveWorld(const LiveWorld&) = delete;
  LiveWorld& operator=(const LiveWorld&) = delete;

  /// The time base of all stamps here: CLOCK_MONOTONIC [s].
  [[nodiscard]] static double clock() noexcept;

  /// Each cycle is added to the recorder, which must outlive the thread. Before start().
  void record(SessionRecorder& recorder) noexcept;

  /// A further recorder, from the next cycle on, while the thread runs or before. Null ends that:
  /// returns when no cycle uses the one before. One thread at a time.
  void switch_recorder(SessionRecorder* recorder) noexcept;
  /// What pages start and stop recordings by; must outlive what serves them. Before start().
  void offer(PageRecorder& recorder) noexcept;

  /// Starts the thread with real-time priority (SCHED_FIFO) and locked memory (mlockall), if
  /// permitted; if not, runs without and returns a note. Call once.
  [[nodiscard]] Expected<std::vector<std::string>> start();
  /// Stops the thread; so does the destructor.
  void stop() noexcept;

  /// Times of all cycles so far. Call before start() or after stop().
  [[nodiscard]] CycleTimes times() const;

  [[nodiscard]] const std::vector<std::string>& notes() const override;
  [[nodiscard]] const std::vector<std::string>& names() const override;
  [[nodiscard]] std::string_view device_name() const override;
  [[nodiscard]] RemoteDevice* page_device() noexcept override;
  void hold(bool is_on_hold) noexcept override;
  void emergency_stop() noexcept override;
  void release_emergency_stop() noexcept override;
  void reset() noexcept override;
  void undo_reset() noexcept override;
  void set_time_scale(double scale) noexcept override;
  [[nodiscard]] double time_scale() const noexcept override;
  [[nodiscard]] PageRecorder* recorder() noexcept override;
  [[nodiscard]] const WorldSnapshot& newest() noexcept override;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace pcavr
