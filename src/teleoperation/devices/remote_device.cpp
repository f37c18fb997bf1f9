// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/remote_device.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "teleoperation/devices/clutch.hpp"
#include "teleoperation/devices/jitter_buffer.hpp"
#include "teleoperation/devices/sample_ring.hpp"

namespace pcavr {
namespace {

/// 0.7 s at 90 Hz: far more than a cycle's.
constexpr std::uint32_t kQueueSize = 64;

bool is_valid(const RemoteSample& sample) {
  return is_plausible_tip(sample.p_base_tip) && is_rotation(sample.q_base_tool) &&
         std::isfinite(sample.sender_clock) && std::isfinite(sample.arrival);
}

}  // namespace

struct RemoteDevice::Content {
  explicit Content(RemoteDeviceOptions device_options)
      : options(std::move(device_options)), buffer(options.max_delay, options.catch_up_time) {}

  RemoteDeviceOptions options;
  SampleRing<RemoteSample, kQueueSize> ring;
  std::atomic<std::uint64_t> rejected{0};
  // Writer thread only.
  RemoteSample last;
  bool has_last = false;
  // Reader thread only.
  JitterBuffer buffer;
  Clutch clutch;
  double closed_at = 0.0;  ///< [s] sender's clock
  bool is_closing = false;
  bool must_open = false;  ///< after a timeout: must open before it can close again
  double age = 0.0;

  [[nodiscard]] bool is_acceptable(const RemoteSample& sample) const noexcept {
    if (!has_last || sample.sender != last.sender) return true;
    if (sample.arrival - last.arrival > options.timeout) return true;
    const double since = sample.sender_clock - last.sender_clock;
    return sample.is_engaged == last.is_engaged ? since >= options.min_interval : since > 0.0;
  }
  void clear() noexcept {
    buffer.clear();
    open();
    must_open = false;
    age = 0.0;
  }
  void open() noexcept {
    clutch.open();
    is_closing = false;
  }
  void process(RemoteSample sample) noexcept;
  [[nodiscard]] DeviceSample move(double dt, const DeviceFeedback& feedback) noexcept;
};

/// One sample from the ring, in order.
void RemoteDevice::Content::process(RemoteSample sample) noexcept {
  if (!buffer.is_empty() && sample.sender != buffer.newest().sender) clear();
  sample.q_base_tool.normalize();
  const bool restarts = buffer.add(sample);
  if (restarts || !sample.is_engaged) open();
  if (!sample.is_engaged) must_open = false;
  if (!sample.is_engaged || must_open || clutch.is_closed() || is_closing) return;
  is_closing = true;
  closed_at = sample.sender_clock;
}

DeviceSample RemoteDevice::Content::move(double dt, const DeviceFeedback& feedback) noexcept {
  if (is_closing && is_plausible_tip(feedback.p_base_tool)) {
    clutch.close(buffer.at(closed_at).p_base_tip, feedback.p_base_tool);
    is_closing = false;
  }
  // Motion before the clutch closed does not move the tool.
  const double clock = clutch.is_closed() ? std::max(buffer.shown(), closed_at) : buffer.shown();
  const JitterBuffer::Tip tip = buffer.at(clock);
  const Eigen::Vector3d p_base_tip =
      clutch.is_closed() ? clutch.follow(tip.p_base_tip, options.max_speed * dt) : tip.p_base_tip;
  return {p_base_tip, tip.q_base_tool, clutch.is_closed(), true};
}

RemoteDevice::RemoteDevice(RemoteDeviceOptions options) {
  PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0, options.max_speed);
  PCAVR_REQUIRE(std::isfinite(options.timeout) && options.timeout > 0.0, options.timeout);
  PCAVR_REQUIRE(options.min_interval > 0.0 && options.catch_up_time > 0.0);
  PCAVR_REQUIRE(JitterBuffer::covers(options.max_delay, options.min_interval), options.max_delay);
  content_ = std::make_unique<Content>(std::move(options));
}

RemoteDevice::~RemoteDevice() = default;

bool RemoteDevice::push(const RemoteSample& sample) noexcept {
  Content& own = *content_;
  if (!is_valid(sample) || !own.is_acceptable(sample) || !own.ring.push(sample)) {
    own.rejected.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  own.last = sample;
  own.has_last = true;
  return true;
}

void RemoteDevice::release() noexcept {
  content_->has_last = false;
  content_->ring.request_clear();
}

std::uint64_t RemoteDevice::rejected() const noexcept {
  return content_->rejected.load(std::memory_order_relaxed);
}

std::string_view RemoteDevice::name() const noexcept { return content_->options.name; }

DeviceSample RemoteDevice::exchange(double t, double dt, const DeviceFeedback& feedback) noexcept {
  Content& own = *content_;
  if (own.ring.is_clear_requested()) own.clear();
  // A bounded number per cycle, so that a flood of samples does not block it.
  for (std::uint32_t i = 0; i < kQueueSize; ++i) {
    const std::optional<RemoteSample> sample = own.ring.pop();
    if (!sample) break;
    own.process(*sample);
  }
  if (own.buffer.is_empty()) return {};
  own.age = std::max(0.0, t - own.buffer.newest().arrival);
  const bool has_timed_out = own.age > own.options.timeout;
  if (has_timed_out) {
    own.must_open = own.buffer.newest().is_engaged;
    own.open();
  }
  own.buffer.advance(t, dt);
  DeviceSample result = own.move(dt, feedback);
  result.is_present = !has_timed_out;
  return result;
}

RemoteStatus RemoteDevice::status() const noexcept {
  const Content& own = *content_;
  if (own.buffer.is_empty()) return {};
  return {own.buffer.newest().sender_clock, own.buffer.shown(), own.age, own.buffer.delay(),
          own.buffer.newest().sender};
}

}  // namespace pcavr
