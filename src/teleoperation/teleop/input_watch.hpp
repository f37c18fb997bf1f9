// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <future>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/inputs/input_monitor.hpp"
#include "pcavr/teleoperation/teleop/options.hpp"
#include "pcavr/teleoperation/teleop/run_teleop.hpp"

#include "teleoperation/teleop/background.hpp"
#include "teleoperation/teleop/delayed_result.hpp"

namespace pcavr {

/// A clock offset that is being subtracted, with what is written about it.
struct AppliedOffset {
  double offset = 0.0;               ///< [s] with the prior's
  double std = 0.0;                  ///< [s] of what was found beyond the prior
  std::optional<double> since = {};  ///< [s] first time of use; empty: only the prior's
};

/// Examines the samples of a live site while no object is touched: faults of the force, clock
/// offsets. A finding applies from then on, and is refined. Stamps are those of the sensors, from
/// which the prior's offsets are subtracted first. An examination takes up to some tenths of a
/// second: where `background` is async a thread computes it, and samples wait. Not thread-safe.
class InputWatch {
 public:
  /// `objects` must outlive it; their series are not used.
  InputWatch(const std::vector<TeleopObject>& objects, double tool_radius,
             const TeleopOptions& options, Background background = {});

  void add_tool(double t, const Eigen::Vector3d& p_base_tip,
                const std::optional<Eigen::Quaterniond>& q_base_tool);
  void add_force(double t, const Eigen::Vector3d& force_base);
  void add_tracked(std::size_t object, const TrackedPose& pose);

  /// Examines the samples so far if that is due at `t` [s]: after a contact, or when half as much
  /// again has come since the last time. A finding applies from the first call on that is
  /// kExaminationTime later. True if a fault or an offset has changed. Call while no object is
  /// touched.
  bool examine(double t, bool has_new_contact);
  /// Whether examine() would wait for the thread.
  [[nodiscard]] bool would_wait(double t) const {
    return examination_ && examination_->would_wait(t);
  }
  static constexpr double kExaminationTime = 0.2;  ///< [s] of the data, so that replay equals live

  /// A fault of the force; as of the last examination. (One of the tool or its clock is stated by
  /// findings() only, at the end: of little data it may be wrong.)
  [[nodiscard]] const std::optional<InputFault>& fault() const { return fault_; }
  /// See InputFindings::suspected_turn [rad]; as of the last examination, too.
  [[nodiscard]] double suspected_turn() const { return suspected_turn_; }
  [[nodiscard]] const AppliedOffset& force() const { return force_; }
  [[nodiscard]] const AppliedOffset& camera() const { return camera_; }
  /// Findings by all samples so far; expensive. An Error: the examination failed.
  [[nodiscard]] Expected<InputFindings> findings();
  /// Why the last examination failed, if it did: what was found before applies. Once.
  [[nodiscard]] std::optional<Error> take_failure() { return std::exchange(failure_, {}); }
  static constexpr char kTask[] = "the examination of the inputs";

 private:
  struct ToolSample {
    double t;  ///< [s]
    Eigen::Vector3d p_base_tip;
    std::optional<Eigen::Quaterniond> q_base_tool;
  };
  struct ForceSample {
    double t;  ///< [s]
    Eigen::Vector3d force_base;
  };
  struct TrackedSample {
    std::size_t object;
    TrackedPose pose;
  };
  using Sample = std::variant<ToolSample, ForceSample, TrackedSample>;
  using Chunks = std::vector<std::vector<Sample>>;
  void add(Sample sample);
  /// Has what waits added to the monitor, unless an examination is still in progress.
  void store();
  void add_to_monitor(const Chunks& samples);
  bool apply_findings(const InputFindings& found, double t);
  bool apply(const TimeOffset& found, bool is_significant, double prior, double t,
             AppliedOffset& applied) const;

  SensorPriorOptions prior_;
  Background background_;
  InputMonitor monitor_;  ///< of the newest of storage_ and examination_ until that is done
  Chunks waiting_;        ///< in order of arrival
  std::optional<bool> has_orientation_ = {};
  double first_ = std::numeric_limits<double>::infinity();  ///< [s]
  std::optional<double> examined_ = {};                     ///< [s]
  std::optional<InputFault> fault_ = {};
  double suspected_turn_ = 0.0;  ///< [rad]
  std::optional<Error> failure_ = {};
  AppliedOffset force_, camera_;
  /// Begins once the last examination is done. All tasks after one that throws throw the same.
  std::shared_future<void> storage_ = {};
  std::optional<DelayedResult<InputFindings>> examination_ = {};  ///< waits for storage_ itself
};

}  // namespace pcavr
