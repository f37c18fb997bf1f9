// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>

#include "pcavr/physics/contact/hunt_crossley.hpp"

namespace pcavr {

/// Distance beyond the CAD body's surface at which the tip meets an object, measured while it is
/// touched and tracked: the error of mesh, tip radius and tracking's calibration, and of a contact
/// law that is only assumed. Without it a body that is put where it is tracked lies apart from the
/// tip that pushes it in reality, and stays behind by that distance. Faces touched before keep
/// theirs: in a slot the floor's offset is not that of its walls. A wall's offset is horizontal
/// even where the wall is inclined: what displaces it is the tracked pose, which has no height, so
/// that the floor stays where it was.
class SurfaceOffset {
 public:
  /// Offsets above `max_offset` [m] are errors of another kind, and not used. `up_object` is the
  /// vertical in the object's frame.
  explicit SurfaceOffset(double max_offset,
                         const Eigen::Vector3d& up_object = Eigen::Vector3d::UnitZ())
      : max_offset_(max_offset), up_object_(up_object) {}

  /// One frame: the `gap` [m] between tip and the tracked body's surface (negative inside), its std
  /// [m], the force without damping [N], and the face's outward normal in the object's frame.
  void add(const Eigen::Vector3d& normal_object, double gap, double std, double force);

  /// [m] ObjectParameters::contact_surface_offset by this law: vertically as measured on a level
  /// face; along the newest wall as measured there, across it as on the walls before; and across
  /// all those as `identified`. Empty before there are enough frames, and where none is larger than
  /// its uncertainty.
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
  Eigen::Vector3d up_object_;
  std::array<Face, 3> faces_;  ///< the newest first
};

}  // namespace pcavr
