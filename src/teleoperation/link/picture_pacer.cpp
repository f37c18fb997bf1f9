// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/link/picture_pacer.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "pcavr/base/core/options.hpp"

namespace pcavr {
namespace {

constexpr auto kPictureFields = std::to_array<OptionField<PictureOptions>>({
    {"max_rate", &PictureOptions::max_rate, 10.0, 0.0, 60.0, "Hz",
     "rate of the pictures of the robot's camera that are sent to the operator's site; 0: none",
     "lower: jerky pictures; higher: more computing time at both sites, smaller pictures"},
    {"max_bandwidth", &PictureOptions::max_bandwidth, 1000.0, 1.0, 1e5, "kB/s",
     "bandwidth that pictures take at most; on a slower link they take less, as measured",
     "lower: coarse pictures; higher: they may fill a link that others need"},
});
static_assert(are_valid_fields(kPictureFields));

constexpr double kBytesPerKilobyte = 1000.0;
constexpr double kStartBandwidth = 200e3;  // [bytes/s] of a slow line: pictures begin coarse
constexpr double kMinBandwidth = 5e3;      // [bytes/s] a thumbnail a second
// [s] that a picture may queue: as much delays commands and states behind it.
constexpr double kMaxQueueing = 0.03;
constexpr double kDecrease = 0.7;
constexpr double kIncrease = 1.05;
constexpr double kLossTimeout = 2.0;       // [s] without a receipt of any picture
constexpr double kMinTransitDrift = 1e-3;  // of time, by which the fastest transit is forgotten

}  // namespace

PictureOptions::PictureOptions() { set_defaults(*this, kPictureFields); }
OptionSection section_of(PictureOptions& options) {
  return make_section("robot_site.pictures", options, kPictureFields);
}

PicturePacer::PicturePacer(const PictureOptions& options)
    : options_(options),
      bandwidth_(std::min(kStartBandwidth, kBytesPerKilobyte * options.max_bandwidth)) {}

std::optional<std::size_t> PicturePacer::max_bytes(double now) const {
  if (!(options_.max_rate > 0.0) || now < next_) return std::nullopt;
  return static_cast<std::size_t>(bandwidth_ / options_.max_rate);
}

void PicturePacer::note_sent(std::uint32_t sequence, std::size_t bytes, double now) {
  if (!sent_.empty() && now - sent_.front().t > kLossTimeout) {
    slow_down(now);
    sent_.clear();
  }
  sent_.push_back({sequence, now, bytes});
  next_ = now + std::max(1.0 / options_.max_rate, static_cast<double>(bytes) / bandwidth_);
}

void PicturePacer::note_receipt(std::uint32_t sequence, double received, double now) {
  const auto found = std::find_if(sent_.begin(), sent_.end(), [sequence](const Sent& picture) {
    return picture.sequence == sequence;
  });
  if (found == sent_.end()) return;
  const Sent picture = *found;
  sent_.erase(sent_.begin(), found + 1);  // older ones are lost, or will be too late
  const double transit = received - picture.t;
  const double forgotten = min_transit_ ? *min_transit_ + kMinTransitDrift * (now - last_receipt_)
                                        : std::numeric_limits<double>::infinity();
  last_receipt_ = now;
  min_transit_ = std::min(transit, forgotten);
  if (transit - *min_transit_ > kMaxQueueing) {
    // One queue delays all that were sent into it: it is answered once.
    if (picture.t > slowed_at_) slow_down(now);
    return;
  }
  bandwidth_ = std::min(kIncrease * bandwidth_, kBytesPerKilobyte * options_.max_bandwidth);
}

void PicturePacer::slow_down(double now) {
  slowed_at_ = now;
  bandwidth_ = std::max(kDecrease * bandwidth_, kMinBandwidth);
}

void PicturePacer::restart() {
  sent_.clear();
  min_transit_.reset();
  next_ = 0.0;
}

}  // namespace pcavr
