// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "teleoperation/teleop/surface_offset.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

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
// Cosine between the normals of faces that keep each an offset of their own: from 60 degrees.
constexpr double kMaxAlong = 0.5;
// Cosine between a level face's normal and the vertical: 20 degrees.
constexpr double kLevel = 0.94;
// Squared sine to the faces before, below which a face adds no direction: 18 degrees.
constexpr double kMinNewDirection = 0.1;

/// The offsets of several faces as one vector.
class OffsetVector {
 public:
  /// Makes the offset along `normal` equal to `offset` [m], as far as the faces added before leave
  /// that direction.
  void add(const Eigen::Vector3d& normal, double offset) {
    Eigen::Vector3d across = normal;
    for (int i = 0; i < count_; ++i)
      across -= across.dot(axes_[static_cast<std::size_t>(i)]) * axes_[static_cast<std::size_t>(i)];
    const double length = across.norm();
    if (length * length < kMinNewDirection || count_ == 3) return;
    value_ += (offset - normal.dot(value_)) / (length * length) * across;
    axes_[static_cast<std::size_t>(count_++)] = across / length;
  }
  /// Across all faces it becomes that of `whole`.
  void complete(const Eigen::Vector3d& whole) {
    Eigen::Vector3d rest = whole - value_;
    for (int i = 0; i < count_; ++i)
      rest -= rest.dot(axes_[static_cast<std::size_t>(i)]) * axes_[static_cast<std::size_t>(i)];
    value_ += rest;
  }
  [[nodiscard]] const Eigen::Vector3d& value() const { return value_; }

 private:
  std::array<Eigen::Vector3d, 3> axes_;
  int count_ = 0;
  Eigen::Vector3d value_ = Eigen::Vector3d::Zero();
};

}  // namespace

void SurfaceOffset::add(const Eigen::Vector3d& normal_object, double gap, double std,
                        double force) {
  const auto is_same = [&](const Face& face) {
    return face.frames > 0 && normal_object.dot(face.normal_object) > kSameFace;
  };
  auto known = std::find_if(faces_.begin(), faces_.end(), is_same);
  if (known != faces_.begin()) {
    // The pose may have changed since a face was touched: it is measured anew.
    if (known == faces_.end()) known = std::prev(faces_.end());
    std::rotate(faces_.begin(), known, std::next(known));
    // One vector can't hold opposite faces: only those across the new one are kept.
    for (Face& face : faces_) {
      if (std::abs(normal_object.dot(face.normal_object)) > kMaxAlong) face = Face{};
    }
    faces_.front() = Face{.normal_object = normal_object};
  }
  Face& face = faces_.front();
  face.frames = std::min(face.frames + 1, kMaxSurfaceFrames);
  const double gain = 1.0 / face.frames;
  face.gap += gain * (gap - face.gap);
  face.force += gain * (force - face.force);
  face.std += gain * (std - face.std);
}

std::optional<double> SurfaceOffset::offset_of(const Face& face, const HuntCrossley& law) const {
  if (face.frames < kMinSurfaceFrames) return std::nullopt;
  const double offset = face.gap + static_penetration(law, face.force);
  const double std = face.std * std::hypot(kSurfaceSystematicShare, 1.0 / std::sqrt(face.frames));
  if (std::abs(offset) < kSignificantStds * std || std::abs(offset) > max_offset_) {
    return std::nullopt;
  }
  return offset;
}

std::optional<Eigen::Vector3d> SurfaceOffset::value(
    const HuntCrossley& law, const std::optional<Eigen::Vector3d>& identified) const {
  OffsetVector combined;
  bool is_known = false;
  const auto add_faces = [&](bool are_level) {
    for (const Face& face : faces_) {
      if ((std::abs(face.normal_object.dot(up_object_)) > kLevel) != are_level) continue;
      const std::optional<double> offset = offset_of(face, law);
      if (!offset) continue;
      combined.add(face.normal_object, *offset);
      is_known = true;
    }
  };
  add_faces(true);
  // No wall changes the height: see the class. Without an own offset the floor has the identified
  // one.
  combined.add(up_object_, identified ? identified->dot(up_object_) : 0.0);
  add_faces(false);
  if (!is_known) return std::nullopt;
  if (identified) combined.complete(*identified);
  return combined.value();
}

}  // namespace pcavr
