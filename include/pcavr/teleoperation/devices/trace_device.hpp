// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/teleoperation/devices/device.hpp"

namespace pcavr {

struct OptionSection;  // core/options.hpp

/// The hand's state at one time of a trace.
struct TraceSample {
  double t = 0.0;                                        ///< [s] since the trace's first row
  Eigen::Vector3d p_base_tip = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Quaterniond q_base_tool = Eigen::Quaterniond::Identity();
  bool is_engaged = true;
};

/// Reads a trace: rows of a TUM trajectory (`t x y z qx qy qz qw`, `#` comments), or CSV whose
/// header is `t,x,y,z`, with `,qx,qy,qz,qw` (a recording's tool.csv), `,engaged` (0 or 1) or both
/// after it. Times [s] ascend; positions [m] in base, within 100 m of it. At least one row.
[[nodiscard]] Expected<std::vector<TraceSample>> parse_trace(std::string_view text,
                                                             const std::string& file);

struct TraceDeviceOptions {
  TraceDeviceOptions();
  double max_speed;  ///< [m/s] of the tip; see RemoteDeviceOptions
};
[[nodiscard]] OptionSection section_of(TraceDeviceOptions& options);

/// Plays back a trace from the first exchange on, with linear interpolation between its rows. While
/// engaged, the tip is at the trace's position in base, approached at max_speed in a straight line
/// from the tool's position. At its end it is disengaged and absent.
class TraceDevice final : public Device {
 public:
  /// Reads the whole file.
  [[nodiscard]] static Expected<std::unique_ptr<TraceDevice>> open(
      const std::filesystem::path& file, const TraceDeviceOptions& options = {});
  /// Requires (PCAVR_REQUIRE) samples that are not empty and finite, with times ascending from 0.
  explicit TraceDevice(std::vector<TraceSample> samples, const TraceDeviceOptions& options = {});

  /// [s] from its first row to its last.
  [[nodiscard]] double duration() const noexcept { return samples_.back().t; }

  [[nodiscard]] std::string_view name() const noexcept override { return "trace"; }
  [[nodiscard]] DeviceSample exchange(double t, double dt,
                                      const DeviceFeedback& feedback) noexcept override;

 private:
  [[nodiscard]] TraceSample at(double t) const noexcept;

  std::vector<TraceSample> samples_;
  TraceDeviceOptions options_;
  bool has_begun_ = false;
  double begin_ = 0.0;  ///< [s] of exchange's clock
  DeviceSample sample_;
};

}  // namespace pcavr
