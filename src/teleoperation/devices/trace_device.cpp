// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/trace_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"

#include "teleoperation/devices/tip_bounds.hpp"

namespace pcavr {

Expected<std::unique_ptr<TraceDevice>> TraceDevice::open(const std::filesystem::path& file,
                                                         const TraceDeviceOptions& options) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  Expected<std::vector<TraceSample>> samples = parse_trace(*text, file.string());
  if (!samples) return samples.error();
  return std::make_unique<TraceDevice>(*std::move(samples), options);
}

TraceDevice::TraceDevice(std::vector<TraceSample> samples, const TraceDeviceOptions& options)
    : samples_(std::move(samples)), options_(options) {
  PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0, options.max_speed);
  PCAVR_REQUIRE(!samples_.empty() && samples_.front().t == 0.0);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const TraceSample& sample = samples_[i];
    PCAVR_REQUIRE(i == 0 || sample.t > samples_[i - 1].t, i);
    PCAVR_REQUIRE(is_plausible_tip(sample.p_base_tip) && is_rotation(sample.q_base_tool), i);
  }
}

TraceSample TraceDevice::at(double t) const noexcept {
  const auto later = std::upper_bound(samples_.begin(), samples_.end(), t,
                                      [](double u, const TraceSample& s) { return u < s.t; });
  if (later == samples_.begin()) return samples_.front();
  TraceSample sample = *(later - 1);
  if (later == samples_.end()) return sample;
  const double ratio = (t - sample.t) / (later->t - sample.t);
  sample.p_base_tip += ratio * (later->p_base_tip - sample.p_base_tip);
  sample.q_base_tool = sample.q_base_tool.slerp(ratio, later->q_base_tool);
  return sample;
}

DeviceSample TraceDevice::exchange(double t, double dt, const DeviceFeedback& feedback) noexcept {
  if (!has_begun_) begin_ = t;
  has_begun_ = true;
  const TraceSample now = at(t - begin_);
  sample_.q_base_tool = now.q_base_tool;
  sample_.is_present = t - begin_ <= duration();
  const bool was_engaged =
      std::exchange(sample_.is_engaged,
                    sample_.is_present && now.is_engaged && is_plausible_tip(feedback.p_base_tool));
  if (!sample_.is_engaged) {
    sample_.p_base_tip = now.p_base_tip;
    return sample_;
  }
  if (!was_engaged) sample_.p_base_tip = feedback.p_base_tool;
  sample_.p_base_tip = limit_distance(sample_.p_base_tip, now.p_base_tip, options_.max_speed * dt);
  return sample_;
}

}  // namespace pcavr
