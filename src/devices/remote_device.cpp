// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/devices/remote_device.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "pcavr/core/check.hpp"

#include "devices/clutch.hpp"
#include "devices/sample_ring.hpp"
#include "devices/tip_playback.hpp"

namespace pcavr {
namespace {

/// 0.7 s at 90 Hz: longer than the silence after which the tool is let go.
constexpr std::uint32_t kRoom = 64;
/// [s] 500 Hz: the fastest mice send at twice that, pages at a fifth.
constexpr double kMinInterval = 0.002;

bool is_sound(const RemoteSample& sample) {
  return is_plausible_tip(sample.p_base_tip) && is_rotation(sample.q_base_tool) &&
         std::isfinite(sample.sender_clock) && std::isfinite(sample.arrival);
}

}  // namespace

struct RemoteDevice::Content {
  RemoteDeviceOptions options;
  SampleRing<RemoteSample, kRoom> ring;
  std::atomic<std::uint64_t> left_out{0};
  // The writer's.
  RemoteSample last;
  bool has_last = false;
  // The reader's.
  TipPlayback playback;
  Clutch clutch;
  double closed_at = 0.0;  ///< [s] sender's clock
  bool is_closing = false;
  bool must_open = false;  ///< let go by silence: to be opened before it can close again
  double age = 0.0;

  [[nodiscard]] bool follows(const RemoteSample& sample) const noexcept {
    if (!has_last || sample.sender != last.sender) return true;
    if (sample.arrival - last.arrival > options.max_silence) return true;
    const double since = sample.sender_clock - last.sender_clock;
    return sample.is_engaged == last.is_engaged ? since >= kMinInterval : since > 0.0;
  }
  void forget() noexcept {
    playback.clear();
    open();
    must_open = false;
    age = 0.0;
  }
  void open() noexcept {
    clutch.open();
    is_closing = false;
  }
  void take(RemoteSample sample) noexcept;
  [[nodiscard]] DeviceSample move(double dt, const DeviceFeedback& feedback) noexcept;
};

/// One sample from the ring, in order.
void RemoteDevice::Content::take(RemoteSample sample) noexcept {
  if (!playback.is_empty() && sample.sender != playback.newest().sender) forget();
  sample.q_base_tool.normalize();
  const bool restarts = playback.add(sample);
  if (restarts || !sample.is_engaged) open();
  if (!sample.is_engaged) must_open = false;
  if (!sample.is_engaged || must_open || clutch.is_closed() || is_closing) return;
  is_closing = true;
  closed_at = sample.sender_clock;
}

DeviceSample RemoteDevice::Content::move(double dt, const DeviceFeedback& feedback) noexcept {
  if (is_closing && is_plausible_tip(feedback.p_base_tool)) {
    clutch.close(playback.at(closed_at).p_base_tip, feedback.p_base_tool);
    is_closing = false;
  }
  // What the hand did before the clutch closed does not move the tool.
  const double clock =
      clutch.is_closed() ? std::max(playback.shown(), closed_at) : playback.shown();
  const TipPlayback::Place place = playback.at(clock);
  const Eigen::Vector3d p_base_tip = clutch.is_closed()
                                         ? clutch.follow(place.p_base_tip, options.max_speed * dt)
                                         : place.p_base_tip;
  return {p_base_tip, place.q_base_tool, clutch.is_closed(), true};
}

RemoteDevice::RemoteDevice(RemoteDeviceOptions options) : content_(std::make_unique<Content>()) {
  PCAVR_REQUIRE(std::isfinite(options.max_speed) && options.max_speed > 0.0, options.max_speed);
  PCAVR_REQUIRE(std::isfinite(options.max_silence) && options.max_silence > 0.0,
                options.max_silence);
  content_->options = std::move(options);
}

RemoteDevice::~RemoteDevice() = default;

bool RemoteDevice::push(const RemoteSample& sample) noexcept {
  Content& own = *content_;
  if (!is_sound(sample) || !own.follows(sample) || !own.ring.push(sample)) {
    own.left_out.fetch_add(1, std::memory_order_relaxed);
    return false;
  }
  own.last = sample;
  own.has_last = true;
  return true;
}

void RemoteDevice::let_go() noexcept {
  content_->has_last = false;
  content_->ring.forget();
}

std::uint64_t RemoteDevice::left_out() const noexcept {
  return content_->left_out.load(std::memory_order_relaxed);
}

std::string_view RemoteDevice::name() const noexcept { return content_->options.name; }

DeviceSample RemoteDevice::exchange(double t, double dt, const DeviceFeedback& feedback) noexcept {
  Content& own = *content_;
  if (own.ring.forgets()) own.forget();
  // What comes while this runs is the next cycle's, so that a flood does not hold it up.
  for (std::uint32_t i = 0; i < kRoom; ++i) {
    const std::optional<RemoteSample> sample = own.ring.pop();
    if (!sample) break;
    own.take(*sample);
  }
  if (own.playback.is_empty()) return {};
  own.age = std::max(0.0, t - own.playback.newest().arrival);
  const bool is_silent = own.age > own.options.max_silence;
  if (is_silent) {
    own.must_open = own.playback.newest().is_engaged;
    own.open();
  }
  own.playback.advance(t, dt);
  DeviceSample said = own.move(dt, feedback);
  said.is_present = !is_silent;
  return said;
}

RemoteUse RemoteDevice::use() const noexcept {
  const Content& own = *content_;
  if (own.playback.is_empty()) return {};
  return {own.playback.newest().sender_clock, own.playback.shown(), own.age, own.playback.delay(),
          own.playback.newest().sender};
}

}  // namespace pcavr
