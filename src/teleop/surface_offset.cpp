// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleop/surface_offset.hpp"

#include <algorithm>
#include <cmath>

namespace pcavr {
namespace {

// Frames that the mean is over: a second of an ordinary camera; and before there is one.
constexpr int kMaxSurfaceFrames = 30;
constexpr int kMinSurfaceFrames = 6;
// Cosine between normals of one flat face: 10 degrees.
constexpr double kSameFace = 0.985;
// Stds beyond which an offset is none of tracking's noise.
constexpr double kSignificantStds = 3.0;
// Share of a frame's std that averaging does not reduce: calibration, and noise that is correlated.
constexpr double kSurfaceSystematicShare = 0.5;

}  // namespace

void SurfaceOffset::add(const Eigen::Vector3d& normal_object, double gap, double std,
                        double force) {
  if (frames_ > 0 && normal_object.dot(normal_object_) < kSameFace) frames_ = 0;
  if (frames_ == 0) normal_object_ = normal_object;
  frames_ = std::min(frames_ + 1, kMaxSurfaceFrames);
  const double gain = 1.0 / frames_;
  gap_ += gain * (gap - gap_);
  force_ += gain * (force - force_);
  std_ += gain * (std - std_);
}

std::optional<Eigen::Vector3d> SurfaceOffset::value(const HuntCrossley& law) const {
  if (frames_ < kMinSurfaceFrames) return std::nullopt;
  const double offset = gap_ + static_penetration(law, force_);
  const double std = std_ * std::hypot(kSurfaceSystematicShare, 1.0 / std::sqrt(frames_));
  if (std::abs(offset) < kSignificantStds * std || std::abs(offset) > max_offset_) {
    return std::nullopt;
  }
  return offset * normal_object_;
}

}  // namespace pcavr
