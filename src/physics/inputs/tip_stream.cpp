// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/physics/inputs/tip_stream.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pcavr/physics/identification/path_view.hpp"
#include "pcavr/physics/identification/signals.hpp"

#include "physics/inputs/tip_rules.hpp"

namespace pcavr {
namespace {

/// Samples are discarded in blocks: the remaining ones must be moved.
constexpr std::size_t kMinTipBlock = 4096;
/// [s] That a sample's fate may wait for later ones: a slow tool would be known too late.
constexpr double kMaxWait = 0.008;
constexpr double kTypicalTipInterval = 0.002;  // [s] until two samples have come

}  // namespace

TipStream::TipStream(double prior_noise, const InputOptions& options)
    : options_(options), noise_(prior_noise) {}

void TipStream::add(double t, const Eigen::Vector3d& p_base_tip) {
  noise_.add(p_base_tip);
  raw_.push_back({t, p_base_tip});
  const auto half = static_cast<std::size_t>(SpikeOptions().half_window);
  const auto in_time = static_cast<std::size_t>(kMaxWait / interval());
  while (decided_ + std::min(half, in_time) < raw_.size()) {
    decide(raw_[decided_], is_spike(decided_));
    ++decided_;
    if (decided_ <= half) continue;
    raw_.pop_front();
    --decided_;
  }
}

bool TipStream::is_spike(std::size_t index) const {
  const SpikeOptions options = tip_spike_options(noise());
  const auto half = static_cast<std::size_t>(options.half_window);
  const std::size_t begin = index > half ? index - half : 0;
  const std::size_t end = std::min(index + half + 1, raw_.size());
  std::vector<double> values(end - begin);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = begin; i < end; ++i) values[i - begin] = raw_[i].p_base[axis];
    const DespikedSignal signal = remove_spikes(values, options);
    const auto& found = signal.spikes;
    const bool is_far = std::find(found.begin(), found.end(), index - begin) != found.end();
    if (is_far && !is_drivable(values, noise(), interval())) return true;
  }
  return false;
}

void TipStream::decide(const Raw& sample, bool is_spike) {
  known_until_ = sample.t;
  const bool is_lost = !is_spike && !t_.empty() &&
                       is_dropout(p_base_.back(), sample.p_base, sample.t - t_.back(), options_);
  if (is_spike || is_lost) {
    reject(sample);
  } else {
    accept(sample);
  }
}

void TipStream::accept(const Raw& sample) {
  rejected_in_a_row_ = 0;
  t_.push_back(sample.t);
  p_base_.push_back(sample.p_base);
  find_jump();
}

void TipStream::reject(const Raw& sample) {
  if (rejected_in_a_row_++ == 0) rejected_since_ = sample.t;
  if (rejected_in_a_row_ > kSingleSamples) note_bad(rejected_since_, sample.t);
}

void TipStream::find_jump() {
  if (t_.size() < 8) return;
  const std::size_t first = t_.size() - 5;
  const std::span<const double, 5> t(&t_[first], 5);
  const std::span<const Eigen::Vector3d, 5> points(&p_base_[first], 5);
  if (!is_jump(t, points, noise(), interval(), options_)) return;
  if (last_jump_ && is_same_jump(*last_jump_, t[2], std::max(t[2] - t[1], interval()))) return;
  last_jump_ = t[2];
  note_bad(t[2], t[2]);
}

void TipStream::note_bad(double begin, double end) {
  begin -= kBadMargin;
  end += kBadMargin;
  if (!bad_.empty() && begin <= bad_.back().end) {
    bad_.back().end = std::max(bad_.back().end, end);
  } else {
    bad_.push_back({begin, end, kJumpReason});
  }
}

Eigen::Vector3d TipStream::at(double time) const { return PathView(t_, p_base_).at(time); }

double TipStream::interval() const {
  return t_.size() > 1 ? mean_interval(t_) : kTypicalTipInterval;
}

void TipStream::discard_before(double time) {
  if (t_.empty()) return;
  // The newest is kept, however old: the next one is compared with it.
  const auto old = std::lower_bound(t_.begin(), t_.end() - 1, time) - t_.begin();
  if (old < static_cast<std::ptrdiff_t>(kMinTipBlock)) return;
  t_.erase(t_.begin(), t_.begin() + old);
  p_base_.erase(p_base_.begin(), p_base_.begin() + old);
  std::erase_if(bad_, [time](const UnusableInterval& interval) { return interval.end < time; });
}

}  // namespace pcavr
