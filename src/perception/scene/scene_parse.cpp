// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "pcavr/perception/scene/scene_text.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

namespace pcavr {
namespace {

constexpr char kFormat[] = "pcavr-scene/1";
constexpr double kUnitTolerance = 1e-3;  ///< of a normal's length

/// Volume of a body within ranges::kBodySize, above the rounding error of its bounding cube's
/// volume.
constexpr InputRange kVolume{"volume", 1e-20, 1e9, "m^3", "see ranges::kBodySize"};
/// [m^2] A square centimetre: a smaller plane supports nothing.
constexpr double kMinPlaneArea = 1e-4;
/// Smallest z of a plane's normal: objects slide off a slope of 60 degrees.
constexpr double kMinNormalZ = 0.5;

/// Signed area of a polygon in the x-y plane (shoelace formula) [m^2]; negative where clockwise.
double signed_area_xy(const std::vector<Eigen::Vector3d>& corners) {
  double doubled = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d& a = corners[i];
    const Eigen::Vector3d& b = corners[(i + 1) % corners.size()];
    doubled += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * doubled;
}

Eigen::Vector3d vector_of(const YamlValue& value) {
  const std::vector<double> numbers = value.numbers_in(3, ranges::kCoordinate);
  return {numbers[0], numbers[1], numbers[2]};
}

Eigen::Vector3d unit_vector_of(const YamlValue& value) {
  const Eigen::Vector3d vector = vector_of(value);
  if (!(std::abs(vector.norm() - 1.0) <= kUnitTolerance)) {
    value.fail("is not a unit vector", "write a direction with a length of 1");
  }
  return vector;
}

std::filesystem::path path_of(const YamlValue& value) {
  const std::filesystem::path path = std::filesystem::path(value.text()).lexically_normal();
  if (path.empty() || path.is_absolute() || *path.begin() == "..") {
    value.fail("is outside the scene's folder", "write a path inside it");
  }
  return path;
}

struct PoseValues {
  double translation = 0.0;
  double rotation = 0.0;
};

PoseValues pose_values_of(const YamlValue& value) {
  value.expect_keys({"translation", "rotation"});
  return {value.at("translation").number_in(ranges::kPositionStd),
          value.at("rotation").number_in(ranges::kRotationStd)};
}

std::size_t count_of(const YamlValue& value) {
  return static_cast<std::size_t>(value.integer(0, std::numeric_limits<int>::max()));
}

/// The four keys occur together.
SceneObjectEntry::Simplified simplified_of(const YamlValue& object) {
  SceneObjectEntry::Simplified simplified;
  simplified.simplification.max_error =
      object.at("simplified_error").number_in(ranges::kPositionStd);
  simplified.simplification.full_triangles = count_of(object.at("full_triangles"));
  simplified.volume = object.at("volume").number_in(kVolume);
  simplified.centre_of_mass_object = vector_of(object.at("centre_of_mass"));
  return simplified;
}

BodyTextureEntry body_texture_of(const YamlValue& value) {
  value.expect_keys({"width", "height", "texel", "views", "seen_fraction"});
  return {.width = static_cast<int>(count_of(value.at("width"))),
          .height = static_cast<int>(count_of(value.at("height"))),
          .texel = value.at("texel").number_in(ranges::kFigure),
          .views = count_of(value.at("views")),
          .seen_fraction = value.at("seen_fraction").number_in(ranges::kShare)};
}

SceneObjectEntry object_of(const YamlValue& value) {
  value.expect_keys({"name", "mesh", "movable", "mass", "hertz_stiffness", "pose", "start",
                     "evidence", "sigma", "refinement", "simplified_error", "full_triangles",
                     "volume", "centre_of_mass", "texture"});
  SceneObjectEntry object;
  object.name = value.at("name").text();
  expect_object_name(object.name, value.at("name"));
  object.mesh = path_of(value.at("mesh"));
  object.is_movable = value.at("movable").boolean();
  if (const auto mass = value.find("mass")) object.mass = mass->number_in(ranges::kMass);
  if (const auto stiffness = value.find("hertz_stiffness")) {
    object.hertz_stiffness = stiffness->number_in(ranges::kStiffness);
  }
  object.T_base_object = pose_of(value.at("pose"));
  object.T_base_object_start = pose_of(value.at("start"));
  object.evidence = value.at("evidence").text();
  const PoseValues std_values = pose_values_of(value.at("sigma"));
  object.position_std = std_values.translation;
  object.rotation_std = std_values.rotation;
  const PoseValues refinement = pose_values_of(value.at("refinement"));
  object.refinement_translation = refinement.translation;
  object.refinement_rotation = refinement.rotation;
  if (value.find("simplified_error")) object.simplified = simplified_of(value);
  if (const auto texture = value.find("texture")) object.texture = body_texture_of(*texture);
  return object;
}

NotFoundObject not_found_of(const YamlValue& value) {
  value.expect_keys({"name", "reason"});
  NotFoundObject object{value.at("name").text(), value.at("reason").text()};
  expect_object_name(object.name, value.at("name"));
  return object;
}

SceneRobotEntry robot_of(const YamlValue& value) {
  value.expect_keys({"urdf", "pose", "tip", "joints", "position", "links"});
  SceneRobotEntry robot;
  robot.urdf = path_of(value.at("urdf"));
  robot.T_base_robot = pose_of(value.at("pose"));
  robot.tip = value.at("tip").text();
  for (const YamlValue& joint : value.at("joints").items()) robot.joints.push_back(joint.text());
  robot.position = value.at("position").numbers(robot.joints.size());
  for (const YamlValue& link : value.at("links").items()) {
    link.expect_keys({"name", "mesh"});
    robot.links.push_back({link.at("name").text(), path_of(link.at("mesh"))});
  }
  return robot;
}

/// A tag of base, unless it has an object.
MarkerEntry tag_of(const YamlValue& value) {
  value.expect_keys({"family", "id", "size", "object", "pose"});
  MarkerEntry tag;
  tag.id.family = value.at("family").text();
  tag.id.id = value.at("id").integer(0, std::numeric_limits<int>::max());
  tag.size = value.at("size").number_in(ranges::kTagSize);
  if (const auto object = value.find("object")) {
    tag.role = MarkerRole::object;
    tag.object = object->text();
  }
  tag.T_parent_marker = pose_of(value.at("pose"));
  return tag;
}

SupportPlane plane_of(const YamlValue& value) {
  value.expect_keys({"normal", "offset", "rms", "objects", "outline"});
  SupportPlane plane;
  const YamlValue normal = value.at("normal");
  plane.plane_base.normal = unit_vector_of(normal);
  if (plane.plane_base.normal.z() < kMinNormalZ) {
    normal.fail("does not point upward", "write the normal of a plane that can support objects");
  }
  plane.plane_base.offset = value.at("offset").number_in(ranges::kCoordinate);
  plane.rms = value.at("rms").number_in(ranges::kFigure);
  for (const YamlValue& name : value.at("objects").items()) plane.objects.push_back(name.text());
  const YamlValue outline = value.at("outline");
  for (const YamlValue& corner : outline.items()) plane.outline_base.push_back(vector_of(corner));
  if (!(signed_area_xy(plane.outline_base) > kMinPlaneArea)) {
    outline.fail("encloses no area", "write the corners counter-clockwise as seen from above");
  }
  return plane;
}

/// [m] Size of a guard's box or sheet.
constexpr InputRange kGuardSize{"guard size", 1e-3, 1e3, "m", "that of a cell or a building"};
/// [m] Less than a millimetre is below the map's cells; more than a metre leaves no room to work.
constexpr InputRange kGuardMargin{"guard margin", 1e-3, 1.0, "m", "beyond the map's accuracy"};

GuardBox guard_box_of(const YamlValue& value) {
  value.expect_keys({"size", "pose"});
  const std::vector<double> size = value.at("size").numbers_in(3, kGuardSize);
  return {.T_base_box = pose_of(value.at("pose")), .size = {size[0], size[1], size[2]}};
}

GuardPlane guard_plane_of(const YamlValue& value) {
  value.expect_keys({"point", "normal", "size"});
  GuardPlane plane{.point = vector_of(value.at("point")),
                   .normal = unit_vector_of(value.at("normal"))};
  if (const auto size = value.find("size")) plane.size = size->number_in(kGuardSize);
  return plane;
}

GuardSurface guard_of(const YamlValue& value) {
  value.expect_keys({"name", "box", "plane", "scan"});
  GuardSurface guard;
  guard.name = value.at("name").text();
  const auto box = value.find("box"), plane = value.find("plane"), scan = value.find("scan");
  if (int{box.has_value()} + int{plane.has_value()} + int{scan.has_value()} != 1) {
    value.fail("has not exactly one shape", "write one of box, plane and scan");
  }
  if (box) guard.shape = guard_box_of(*box);
  if (plane) guard.shape = guard_plane_of(*plane);
  if (scan) {
    scan->expect_keys({"margin"});
    guard.shape = GuardScan{scan->at("margin").number_in(kGuardMargin)};
  }
  return guard;
}

std::vector<std::pair<std::string, std::size_t>> counts_of(const YamlValue& value,
                                                           const char* what) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const YamlValue& item : value.items()) {
    item.expect_keys({what, "frames"});
    counts.emplace_back(item.at(what).text(), count_of(item.at("frames")));
  }
  return counts;
}

std::vector<InputWarning> warnings_of(const YamlValue& value) {
  std::vector<InputWarning> warnings;
  for (const YamlValue& item : value.items()) {
    item.expect_keys({"input", "message", "factor", "frames"});
    warnings.push_back({item.at("input").text(), item.at("message").text(),
                        item.at("factor").number_in(ranges::kFigure), count_of(item.at("frames"))});
  }
  return warnings;
}

std::vector<SkippedRows> left_out_of(const YamlValue& value) {
  std::vector<SkippedRows> left_out;
  for (const YamlValue& item : value.items()) {
    item.expect_keys({"file", "reason", "rows"});
    left_out.push_back(
        {item.at("file").text(), item.at("reason").text(), count_of(item.at("rows"))});
  }
  return left_out;
}

SceneQuality quality_of(const YamlValue& value) {
  value.expect_keys({"frames_recorded", "frames_used", "frames_dropped", "left_out", "tags_seen",
                     "tag_reprojection_rms", "tracking_rms", "camera_sigma", "surface_rms",
                     "input_warnings"});
  SceneQuality quality;
  quality.frames_recorded = count_of(value.at("frames_recorded"));
  quality.frames_used = count_of(value.at("frames_used"));
  quality.frames_dropped = counts_of(value.at("frames_dropped"), "reason");
  if (const auto left_out = value.find("left_out")) quality.left_out = left_out_of(*left_out);
  quality.tags_seen = counts_of(value.at("tags_seen"), "tag");
  if (const auto rms = value.find("tag_reprojection_rms")) {
    quality.tag_reprojection_rms = rms->number_in(ranges::kFigure);
  }
  quality.tracking_rms = value.at("tracking_rms").number_in(ranges::kFigure);
  const PoseValues std_values = pose_values_of(value.at("camera_sigma"));
  quality.camera_position_std = std_values.translation;
  quality.camera_rotation_std = std_values.rotation;
  if (const auto rms = value.find("surface_rms")) {
    quality.surface_rms = rms->number_in(ranges::kFigure);
  }
  if (const auto warnings = value.find("input_warnings")) {
    quality.input_warnings = warnings_of(*warnings);
  }
  return quality;
}

/// The colour camera's keys are those of a recording's.
CameraModel camera_of(const YamlValue& value) {
  CameraModel camera;
  camera.width = static_cast<int>(count_of(value.at("width")));
  camera.height = static_cast<int>(count_of(value.at("height")));
  camera.fx = value.at("fx").number_in(ranges::kFigure);
  camera.fy = value.at("fy").number_in(ranges::kFigure);
  camera.cx = value.at("cx").number();
  camera.cy = value.at("cy").number();
  return camera;
}

SceneTextureEntry texture_of(const YamlValue& value) {
  value.expect_keys({"width", "height", "texel", "views", "seen_fraction", "color_camera"});
  const YamlValue camera = value.at("color_camera");
  camera.expect_keys({"width", "height", "fx", "fy", "cx", "cy", "T_color_depth", "vignetting"});
  return {.width = static_cast<int>(count_of(value.at("width"))),
          .height = static_cast<int>(count_of(value.at("height"))),
          .texel = value.at("texel").number_in(ranges::kFigure),
          .views = count_of(value.at("views")),
          .seen_fraction = value.at("seen_fraction").number_in(ranges::kShare),
          .color_camera = camera_of(camera),
          .T_color_depth = pose_of(camera.at("T_color_depth")),
          .vignetting = camera.at("vignetting").number_in(ranges::kFigure)};
}

/// The file names are part of the format; only the number of levels of detail varies.
std::vector<std::filesystem::path> levels_of(const YamlValue& files) {
  const std::pair<const char*, const char*> names[] = {
      {"display", kDisplayFile}, {"mesh", kMeshFile},
      {"cloud", kCloudFile},     {"occupancy", kOccupancyFile},
      {"preview", kPreviewFile}, {"camera_trajectory", kTrajectoryFile}};
  files.expect_keys({"display", "mesh", "cloud", "occupancy", "camera_trajectory", "preview",
                     "levels_of_detail"});
  for (const auto& [key, name] : names) {
    const YamlValue value = files.at(key);
    if (value.text() != name) value.fail("is not " + std::string(name), "keep the file's name");
  }
  std::vector<std::filesystem::path> levels;
  for (const YamlValue& level : files.at("levels_of_detail").items()) {
    levels.push_back(path_of(level));
  }
  return levels;
}

SceneManifest manifest_of_yaml(const YamlValue& root) {
  root.expect_keys({"format", "made_by", "recording", "camera", "voxel_size", "files", "up",
                    "texture", "objects", "not_found", "robot", "tags", "support_planes", "guards",
                    "lines", "quality", "configuration"});
  const YamlValue format = root.at("format");
  if (format.text() != kFormat) {
    format.fail("is '" + format.text() + "'", std::string("this version reads ") + kFormat);
  }
  SceneManifest manifest;
  manifest.recording = root.at("recording").text();
  const YamlValue camera = root.at("camera");
  if (camera.text() != "fixed" && camera.text() != "moving") {
    camera.fail("is '" + camera.text() + "'", "write fixed or moving");
  }
  manifest.is_fixed_camera = camera.text() == "fixed";
  manifest.voxel_size = root.at("voxel_size").number_in(ranges::kVoxel);
  manifest.levels_of_detail = levels_of(root.at("files"));
  if (const auto up = root.find("up")) manifest.up_base = unit_vector_of(*up);
  if (const auto texture = root.find("texture")) manifest.texture = texture_of(*texture);
  for (const YamlValue& object : root.at("objects").items()) {
    SceneObjectEntry entry = object_of(object);
    if (entry.evidence == kNotSeen) {  // as older versions wrote it
      manifest.not_found.push_back({std::move(entry.name), "it was not seen in any frame"});
    } else {
      manifest.objects.push_back(std::move(entry));
    }
  }
  if (const auto not_found = root.find("not_found")) {
    for (const YamlValue& object : not_found->items()) {
      manifest.not_found.push_back(not_found_of(object));
    }
  }
  if (const auto robot = root.find("robot")) manifest.robot = robot_of(*robot);
  if (const auto tags = root.find("tags")) {
    for (const YamlValue& tag : tags->items()) manifest.tags.push_back(tag_of(tag));
  }
  for (const YamlValue& plane : root.at("support_planes").items()) {
    manifest.support_planes.push_back(plane_of(plane));
  }
  if (const auto guards = root.find("guards")) {
    for (const YamlValue& guard : guards->items()) manifest.guards.push_back(guard_of(guard));
  }
  if (const auto lines = root.find("lines")) {
    manifest.lines.emplace();
    for (const auto& [file, count] : lines->entries())
      manifest.lines->emplace(file, count_of(count));
  }
  if (const auto changed = root.find("configuration")) {
    for (const auto& [key, value] : changed->entries()) {
      manifest.configuration.emplace_back(key, value.text());
    }
  }
  manifest.quality = quality_of(root.at("quality"));
  manifest.quality.is_fixed_camera = manifest.is_fixed_camera;
  return manifest;
}

}  // namespace

std::string NotFoundObject::to_string() const { return name + " is not in the scene: " + reason; }

Expected<SceneManifest> parse_scene_manifest(const std::string& text, const std::string& file) {
  return parse_yaml<SceneManifest>(text, file, manifest_of_yaml);
}

}  // namespace pcavr
