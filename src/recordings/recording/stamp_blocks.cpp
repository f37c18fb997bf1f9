// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/stamp_blocks.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

namespace pcavr {
namespace {

constexpr std::size_t kMinBlockRows = 60;
constexpr double kBetweenShare = 0.97;  ///< percentile of the intervals: one between blocks ...
constexpr double kMinOfBetween = 0.5;   ///< ... and what counts as one, as a share of that
constexpr double kMaxBetween = 0.25;    ///< [s] of drivers' buffers; beyond, recording paused
constexpr double kMaxBlockTime = 0.2;   ///< share of the whole time that blocks last
constexpr double kMinBlock = 2.5;       ///< [rows] usually: two rows at a time are jitter

}  // namespace

std::optional<std::string> warn_of_stamp_blocks(const std::string& stream,
                                                std::span<const double> t) {
  if (t.size() < kMinBlockRows) return std::nullopt;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
  std::vector<double> sorted = intervals;
  std::sort(sorted.begin(), sorted.end());
  const double between =
      sorted[static_cast<std::size_t>(kBetweenShare * static_cast<double>(sorted.size()))];
  if (between > kMaxBetween) return std::nullopt;
  double inside = 0.0;
  std::size_t blocks = 1;
  for (const double interval : intervals) {
    if (interval < kMinOfBetween * between) {
      inside += interval;
    } else {
      ++blocks;
    }
  }
  const double rows = static_cast<double>(t.size()) / static_cast<double>(blocks);
  if (rows < kMinBlock || inside > kMaxBlockTime * (t.back() - t.front())) return std::nullopt;
  return fmt::format(
      "{}: rows come in blocks of {:.2g}, {:.2g} ms apart: their stamps are of when they arrived, "
      "and speeds between them are wrong; log the stamps of the sensor or the controller",
      stream, rows, 1e3 * (t.back() - t.front()) / static_cast<double>(blocks));
}

}  // namespace pcavr
