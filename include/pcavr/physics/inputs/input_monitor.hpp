// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/physics/inputs/input_options.hpp"
#include "pcavr/physics/inputs/input_series.hpp"

namespace pcavr {

/// Receives the contacts in order of time, on the tool's clock.
using ContactSink = std::function<void(Contact&&)>;

/// Decides sign, axes and unit of force and tool, saturation, clock offsets, jumps, and which body
/// each contact belongs to, from a stream of samples. It stores one window of samples and the
/// evidence of the newest contacts; when a window is full, it is analysed up to a time between two
/// contacts. Deterministic: the findings do not depend on how the streams are interleaved, as long
/// as none is later than the others by more than 5 s. Not thread-safe.
class InputMonitor {
 public:
  /// The bodies' `tracked` is ignored: poses are added one by one. Their models must outlive it.
  InputMonitor(std::vector<InputBody> bodies, double tool_radius, const InputOptions& options,
               ContactSink sink = {});
  ~InputMonitor();
  InputMonitor(InputMonitor&&) noexcept;
  InputMonitor& operator=(InputMonitor&&) noexcept;

  /// Stamps [s] ascend strictly in every stream; others are ignored. Throws ContractError for a
  /// body that does not exist, or an orientation that comes for some samples only.
  void add_tool(double t, const Eigen::Vector3d& p_base_tip,
                const std::optional<Eigen::Quaterniond>& q_base_tool = {});
  void add_force(double t, const Eigen::Vector3d& force_base);
  void add_tracked(std::size_t body, const TrackedPose& pose);

  /// The findings from all samples so far. Analyses the current window: call it a few times a
  /// minute.
  [[nodiscard]] InputFindings findings() const;
  /// Ends the stream: the last contacts are passed on.
  InputFindings finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The same for a whole recording: what a monitor finds that was fed to the end.
[[nodiscard]] InputFindings examine_inputs(const InputSeries& series, const InputOptions& options,
                                           const ContactSink& sink = {});

}  // namespace pcavr
