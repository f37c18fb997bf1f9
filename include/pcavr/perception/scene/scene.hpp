// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/stage_clock.hpp"
#include "pcavr/base/geometry/camera.hpp"
#include "pcavr/base/geometry/mesh.hpp"
#include "pcavr/base/geometry/trajectory.hpp"
#include "pcavr/base/model/cad_model.hpp"
#include "pcavr/perception/scene/occupancy_map.hpp"
#include "pcavr/recordings/recording/manifest.hpp"
#include "pcavr/recordings/recording/recording.hpp"

namespace pcavr {

/// A plane that supports movable objects, and its extent.
struct SupportPlane {
  Plane plane_base;                           ///< normal upward
  std::vector<Eigen::Vector3d> outline_base;  ///< convex outline, counter-clockwise from above
  double rms = 0.0;                           ///< of its inliers [m]
  std::vector<std::string> objects;           ///< names of the objects that it supports
};

/// The evidence of an object that was not detected in any frame: its pose is invalid. Such an
/// object is not part of the scene that is written: scene.yaml names it, and why, under
/// `not_found`.
inline constexpr char kNotSeen[] = "not_seen";
/// The evidence of an object placed by the recording's manifest, which gives its pose at the start
/// only.
inline constexpr char kByManifest[] = "manifest";

/// A CAD body's texture, from the recorded images.
struct BodyTexture {
  std::string jpeg;  ///< the image's file
  /// The body for display, in its frame: with normals, and vertices that are split where charts
  /// meet.
  TriangleMesh mesh_object;
  std::vector<Eigen::Vector2f> coordinates;  ///< by its vertices, as in SceneTexture
  int width = 0;                             ///< [px]
  int height = 0;                            ///< [px]
  double texel = 0.0;          ///< root mean square edge of a texel on the surface [m]
  std::size_t views = 0;       ///< images that it was made from
  double seen_fraction = 0.0;  ///< of the texels: with colours from an image
};

/// A CAD body in the scene.
struct SceneObject {
  CadModel model;
  Pose T_base_object;  ///< at the end of the recording
  Pose T_base_object_start;
  std::string evidence;       ///< "tags_and_shape", "tags", "shape", "manifest", "not_seen"
  std::string reason = {};    ///< why it was not seen; empty where it was
  double position_std = 0.0;  ///< [m]
  double rotation_std = 0.0;  ///< [rad]
  double refinement_translation = 0.0;  ///< median correction of the tag pose by depth [m]
  double refinement_rotation = 0.0;     ///< [rad]
  std::optional<double> mass = {};      ///< [kg]
  bool is_movable = true;
  /// [N/m^1.5] of the contact with the tool, by both materials; empty: they are not known.
  std::optional<double> hertz_stiffness = {};
  std::optional<BodyTexture> texture = {};  ///< nullopt: no image shows it, or none is wanted
};

/// An arm that stands in the scene.
struct SceneRobot {
  std::string urdf;                 ///< the description's text
  Pose T_base_robot;                ///< of its root link
  std::string tip;                  ///< the link that is the tool
  std::vector<std::string> joints;  ///< names of those that move it; all others stay at 0
  std::vector<double> position;     ///< of these joints at the recording's end [rad or m]
  struct Link {
    std::string name;
    TriangleMesh mesh_link;  ///< in the link's frame, not empty
    Pose T_base_link = {};   ///< with the joints at `position`; base is the scene's
  };
  std::vector<Link> links;  ///< those with a surface
};

/// An input of the recording that is inconsistent with the others, but not so much that the scene
/// would be invalid.
struct InputWarning {
  std::string input;  ///< "markers[0].size", "groundtruth.txt"
  std::string message;
  double factor = 1.0;     ///< >= 1, ratio of the inconsistency; 1 where it is not a ratio
  std::size_t frames = 0;  ///< that show it; 0 where found in the files alone
};

/// Quality figures of the build, for the summary and `scene.yaml`.
struct SceneQuality {
  std::size_t frames_recorded = 0;  ///< colour images in the recording
  std::size_t frames_used = 0;
  std::vector<std::pair<std::string, std::size_t>> frames_dropped;  ///< reason, count
  std::vector<SkippedRows> left_out;  ///< rows of the recording's files, by --skip-bad
  std::vector<std::pair<std::string, std::size_t>> tags_seen;  ///< tag, frames
  std::optional<double> tag_reprojection_rms = {};  ///< [px]; empty where no tag was used
  double tracking_rms = 0.0;                        ///< [m]
  double camera_position_std = 0.0;                 ///< median over the frames used [m]
  double camera_rotation_std = 0.0;                 ///< [rad]
  /// Point-to-plane, frames used to mesh, median [m]; empty without frames.
  std::optional<double> surface_rms = {};
  bool is_fixed_camera = false;
  std::vector<InputWarning> input_warnings = {};
  std::vector<StageTime> times;
};

/// The texture of the static mesh's levels of detail.
struct SceneTexture {
  std::string jpeg;  ///< the image's file
  /// By level of detail and vertex: in the unit square, the origin at the upper left (as in glTF).
  std::vector<std::vector<Eigen::Vector2f>> coordinates;
  int width = 0;               ///< [px]
  int height = 0;              ///< [px]
  double texel = 0.0;          ///< root mean square edge of a texel on the surface [m]
  std::size_t views = 0;       ///< images that it was made from
  double seen_fraction = 0.0;  ///< of the texels: with colours from an image
  CameraModel color_camera;    ///< that took the colour images
  Pose T_color_depth;          ///< its offset from the depth camera
  double vignetting = 0.0;     ///< its: see ColorRegistration
};

/// A point-cloud augmented VR scene in the robot's base frame.
struct Scene {
  TriangleMesh mesh_base;  ///< static, full detail
  /// Simplified for display, finest first; the first has at most 300 000 triangles.
  std::vector<TriangleMesh> levels_of_detail_base;
  /// Texture of the levels of detail; nullopt: they have the colours of their vertices only.
  std::optional<SceneTexture> texture = {};
  /// The measured points of all frames, static, averaged in voxels of `voxel_size`.
  PointCloud cloud_base;
  OccupancyMap occupancy;
  std::vector<SupportPlane> support_planes;
  /// Parts of the support planes that only movable bodies or the tool hid: a guess for display, not
  /// part of the static mesh.
  TriangleMesh unseen_support_base = {};
  std::vector<SceneObject> objects;
  std::optional<SceneRobot> robot = {};
  /// The printed tags: of base, and of the objects above.
  std::vector<MarkerEntry> tags = {};
  Trajectory camera_trajectory;  ///< T_base_camera of the frames used
  SceneQuality quality;
  std::string recording;    ///< the source recording, as named by the user
  double voxel_size = 0.0;  ///< [m]
  /// Options that differed from their defaults: "section.key", value.
  std::vector<std::pair<std::string, std::string>> configuration = {};
};

}  // namespace pcavr
