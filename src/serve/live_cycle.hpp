// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pcavr/base/core/cycle_histogram.hpp"
#include "pcavr/serve/live_world.hpp"
#include "pcavr/serve/scene_arm.hpp"
#include "pcavr/serve/session_recorder.hpp"
#include "pcavr/teleoperation/link/motion_limiter.hpp"

#include "pulse_generator.hpp"
#include "triple_buffer.hpp"

namespace pcavr {

/// One cycle of a live world, without a clock: device, world, arm, vibration, publish.
class LiveCycle {
 public:
  LiveCycle(HapticWorld world, std::unique_ptr<Device> device, const LiveWorldOptions& options,
            std::unique_ptr<LiveArm> arm = nullptr);
  /// The tool then moves within these limits, and brakes when its clutch opens. Before step().
  void limit_motion(const MotionLimits& limits) { limits_ = limits; }

  /// publish() adds each cycle's state to it. Before step().
  void record(SessionRecorder& recorder) noexcept { recorder_ = &recorder; }

  /// A further one, at any time; null: none. Any thread.
  void switch_recorder(SessionRecorder* recorder) noexcept { switched_.store(recorder); }
  /// Whether a cycle is adding to a recorder that was switched to. Any thread.
  [[nodiscard]] bool uses_switched_recorder() const noexcept { return used_.load() != nullptr; }

  /// One thread; never allocates, locks, waits or throws. `t` [s]: the device's clock.
  void step(double t) noexcept;
  /// Ends a cycle that took `duration` [s]: publishes its result as the newest, stamped `now`.
  void publish(double duration, std::uint32_t late_cycles, double now) noexcept;

  void hold(bool is_on_hold) noexcept { is_on_hold_.store(is_on_hold, std::memory_order_relaxed); }
  /// Disengages the tool until the release; then the world is on hold.
  void emergency_stop() noexcept { is_stopped_.store(true, std::memory_order_relaxed); }
  void release_emergency_stop() noexcept {
    hold(true);
    is_stopped_.store(false, std::memory_order_relaxed);
  }
  [[nodiscard]] bool is_stopped() const noexcept {
    return is_stopped_.load(std::memory_order_relaxed);
  }
  void reset() noexcept { resets_.fetch_add(1, std::memory_order_relaxed); }
  void undo_reset() noexcept { undos_.fetch_add(1, std::memory_order_relaxed); }
  void set_time_scale(double scale) noexcept;
  [[nodiscard]] double time_scale() const noexcept {
    return time_scale_.load(std::memory_order_relaxed);
  }
  // The following are for the thread of step() only.
  /// The clutch is open until the device opens it and closes it again.
  void open_clutch() noexcept { must_open_ = true; }
  /// Places the tool anew.
  void restart(const Eigen::Vector3d& p_base_tool) noexcept;
  /// [m] Offset from the proxy to where the tool is shown: the motion by the site beside that by
  /// the hand.
  void displace_shown_tool(const Eigen::Vector3d& offset) noexcept { shown_offset_ = offset; }
  /// The published state of the link.
  [[nodiscard]] std::optional<LinkSnapshot>& link() noexcept { return link_; }
  [[nodiscard]] const HapticWorldState& state() const noexcept { return world_.state(); }
  [[nodiscard]] const DeviceSample& sample() const noexcept { return sample_; }

  [[nodiscard]] const WorldSnapshot& newest() noexcept { return buffer_.newest(); }

  [[nodiscard]] CycleTimes times() const noexcept { return histogram_.times_of_all(); }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] Device& device() noexcept { return *device_; }
  [[nodiscard]] RemoteDevice* page_device() noexcept { return page_device_; }

 private:
  [[nodiscard]] ToolCommand command_from(const DeviceSample& sample, bool is_on_hold) noexcept;
  [[nodiscard]] ToolCommand limited(ToolCommand wanted) noexcept;
  void reset_if_requested() noexcept;
  /// Begins from rest, with the hand where it is, after the bodies and the tool were placed.
  void begin_anew() noexcept;
  [[nodiscard]] DeviceFeedback feedback() noexcept;
  void measure_speeds() noexcept;
  void add_to_switched_recorder(double t) noexcept;
  void move_arm(const Eigen::Vector3d& p_base_tip) noexcept;
  [[nodiscard]] Eigen::Vector3d drive_arm() noexcept;

  HapticWorld world_;
  std::unique_ptr<Device> device_;
  RemoteDevice* page_device_;
  std::unique_ptr<LiveArm> arm_;
  LiveWorldOptions options_;
  std::vector<std::string> names_;
  PulseGenerator pulses_;
  CycleHistogram histogram_;
  TripleBuffer<WorldSnapshot> buffer_;
  SessionRecorder* recorder_ = nullptr;
  std::atomic<SessionRecorder*> switched_{nullptr};
  std::atomic<SessionRecorder*> used_{nullptr};  ///< while a cycle adds to it
  std::vector<Eigen::Vector3d> positions_;       ///< of the bodies, one cycle ago
  std::vector<double> speeds_;
  std::atomic<bool> is_on_hold_{false};
  std::atomic<bool> is_stopped_{false};
  std::optional<MotionLimits> limits_;
  std::optional<MotionLimiter> limiter_;  ///< while the tool is engaged, or brakes
  std::optional<LinkSnapshot> link_;
  DeviceSample sample_;     ///< of the last cycle
  bool must_open_ = false;  ///< the clutch, before it can close again
  std::atomic<double> time_scale_{1.0};
  double cycle_scale_ = 1.0;       ///< time scale of the latest cycle
  double simulated_cycles_ = 0.0;  ///< cycles, times their time scale
  std::atomic<std::uint32_t> resets_{0};
  std::uint32_t resets_done_ = 0;
  std::atomic<std::uint32_t> undos_{0};
  std::uint32_t undos_done_ = 0;
  std::uint32_t cycles_ = 0;
  bool was_on_hold_ = false;
  ToolCommand command_;                                              ///< of the last cycle
  Eigen::Quaterniond q_base_tool_ = Eigen::Quaterniond::Identity();  ///< of the last sample
  double weight_share_ = 0.0;  ///< of the tool's weight that is rendered
  Eigen::Vector3d p_tip_offset_ = Eigen::Vector3d::Zero();  ///< from the device's tip to the HIP
  Eigen::Vector3d shown_offset_ = Eigen::Vector3d::Zero();
};

}  // namespace pcavr
