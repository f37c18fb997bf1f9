// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/contact/hunt_crossley.hpp"

namespace pcavr {

/// How far beyond the CAD body's surface the tip meets an object, measured while it is touched and
/// tracked: the error of mesh, tip radius and tracking's calibration, and of a contact law that is
/// only assumed. Without it a body that is put where it is tracked lies apart from the tip that
/// pushes it in reality, and stays behind by that distance. Faces touched before keep theirs: in a
/// slot the floor's offset is not that of its walls.
class SurfaceOffset {
 public:
  /// Offsets above `max_offset` [m] are errors of another kind, and not used.
  explicit SurfaceOffset(double max_offset) : max_offset_(max_offset) {}

  /// One frame: the `gap` [m] between tip and the tracked body's surface (negative inside), its std
  /// [m], the force without damping [N], and the face's outward normal in the object's frame.
  void add(const Eigen::Vector3d& normal_object, double gap, double std, double force);

  /// [m] ObjectParameters::contact_surface_offset by this law: along the newest face as measured
  /// there, across it as on the faces before, and across those as `identified`. Empty before there
  /// are enough frames, and where none is larger than its uncertainty.
  [[nodiscard]] std::optional<Eigen::Vector3d> value(
      const HuntCrossley& law, const std::optional<Eigen::Vector3d>& identified = {}) const;

 private:
  struct Face {
    Eigen::Vector3d normal_object = Eigen::Vector3d::Zero();
    int frames = 0;
    double gap = 0.0;    ///< [m] mean of the newest frames
    double force = 0.0;  ///< [N]
    double std = 0.0;    ///< [m] of one frame
  };
  [[nodiscard]] std::optional<double> offset_of(const Face& face, const HuntCrossley& law) const;

  double max_offset_;
  std::array<Face, 3> faces_;  ///< the newest first
};

}  // namespace pcavr
