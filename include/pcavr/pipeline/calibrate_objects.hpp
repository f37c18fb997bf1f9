// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/core/observer.hpp"
#include "pcavr/base/geometry/pose.hpp"
#include "pcavr/base/model/cad_model.hpp"

namespace pcavr {

struct ObjectsInput {
  std::filesystem::path recording;
  double min_force = 0.0;  ///< [N] from which on the tip touches; 0: by the largest force
  bool skip_bad = false;
};

/// The centre of the tip while it touches a body.
struct ContactPoint {
  std::size_t contact = 0;    ///< number of the contact, from the first touch to the release
  Eigen::Vector3d p_tracked;  ///< [m] in the frame that the tracker calls the object's
};

/// A tracked body and what the tip touched of it.
struct TouchedObject {
  std::string name = {};
  CadModel model = {};
  double mesh_unit = 1.0;      ///< [m] as the recording states it
  Pose T_tracked_object = {};  ///< as the recording states it; the identity where it does not
  Eigen::Vector3d up_tracked = Eigen::Vector3d::UnitZ();  ///< base's z as the recording begins
  double tip_radius = 0.0;                                ///< [m]
  std::size_t contacts = 0;
  std::vector<ContactPoint> points = {};
};

struct TouchedObjects {
  std::vector<TouchedObject> objects = {};
  std::vector<std::string> notes = {};  ///< for the user
};

/// Reads the recording's tool, force and tracked poses. A contact belongs to the body whose stated
/// surface is nearest, in the middle of its points. An Error where one of the streams is absent.
[[nodiscard]] Expected<TouchedObjects> read_touched_objects(const ObjectsInput& input,
                                                            const Observer& observer);

/// Positions along the mesh's axes, rotations about them, and the scale.
inline constexpr std::size_t kObjectParameters = 7;

/// Where a body's mesh is in the frame that a tracker calls the object's.
struct CalibratedObject {
  std::string name = {};
  Pose T_tracked_object = {};
  double scale = 1.0;      ///< of the mesh about its origin, on top of mesh_unit
  double mesh_unit = 1.0;  ///< [m] with the scale
  /// Of x, y, z [m], rotations about x, y, z [rad], all in the mesh's axes, and the scale.
  std::array<double, kObjectParameters> stds{};
  std::array<bool, kObjectParameters> is_observable{};  ///< else it is as stated
  Pose from_stated = {};                                ///< T_stated^-1 * T_tracked_object
  double before_rms = 0.0;                              ///< [m] between tip and surface, as stated
  double fitted_rms = 0.0;                              ///< [m]
  double held_out_rms = 0.0;                            ///< [m] of each contact by the others
  std::size_t contacts = 0;
  std::vector<std::string> notes = {};  ///< for the user
};

/// Moves (and scales) the mesh until the tip's surface touches it in all points, with Huber's loss
/// (point to plane [Chen and Medioni 1991]), from stated pose and from turns of it about the
/// vertical. A parameter that the contacts do not show to 5 mm, 3 degrees or 3 % stays as it is
/// stated. Stds by the jackknife over contacts [Efron and Tibshirani 1993, ch. 11] and by
/// all residuals, the mean of both variances. An Error where
/// there are fewer than four contacts, or none of the parameters is shown.
[[nodiscard]] Expected<CalibratedObject> calibrate_object(const TouchedObject& object);

/// One sentence: how far the mesh is from where the tracker has it.
[[nodiscard]] std::string describe_object(const CalibratedObject& found);
/// "x, y, rotation about z": of those that are observable, or of the others.
[[nodiscard]] std::string parameter_names(const CalibratedObject& found, bool observable);

/// A calibration that recordings name (`calibration:`).
[[nodiscard]] std::string format_objects(const std::vector<CalibratedObject>& found,
                                         const ObjectsInput& input);

/// Writes report.html and report.json, which has the same figures, to a folder. Both lists are in
/// the same order.
[[nodiscard]] Expected<void> write_objects_report(const std::vector<CalibratedObject>& found,
                                                  const std::vector<TouchedObject>& objects,
                                                  const std::string& report_json,
                                                  const std::filesystem::path& folder);

}  // namespace pcavr
