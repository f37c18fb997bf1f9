// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/manifest.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "pcavr/base/core/input_file.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"
#include "pcavr/recordings/recording/time_series.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "recordings/recording/camera_keys.hpp"
#include "recordings/recording/manifest_calibration.hpp"
#include "recordings/recording/mesh_units.hpp"

namespace pcavr {
namespace {

constexpr char kFormat[] = "pcavr-recording/1";
/// Indices of pixels, and of four samples in each, stay far below 2^31; a colour and a depth image
/// of this size take 0.7 GB.
constexpr std::int64_t kMaxImagePixels = 100'000'000;

/// A path inside the folder; where the folder is known, the file must exist.
std::filesystem::path path_of(const YamlValue& value, const std::filesystem::path& folder) {
  const Expected<std::filesystem::path> path = path_inside_folder(value.text());
  if (!path) value.fail(path.error().message, path.error().hint);
  if (folder.empty()) return *path;
  const Expected<bool> exists = is_present(folder / *path);
  if (exists && !*exists) {
    value.fail("the file " + path->string() + " is missing", "add it, or correct the path");
  }
  const Expected<std::uintmax_t> size = regular_file_size(folder / *path);
  if (!size) value.fail(path->string() + ' ' + size.error().message, size.error().hint);
  return *path;
}

void read_camera(const YamlValue& value, Manifest& manifest) {
  value.expect_keys({"width", "height", "fx", "fy", "cx", "cy", "model", "distortion",
                     "depth_scale", "depth_offset"});
  manifest.camera = camera_of(value);
  if (std::int64_t{manifest.camera->width} * manifest.camera->height > kMaxImagePixels) {
    value.fail("an image of " + std::to_string(manifest.camera->width) + " x " +
                   std::to_string(manifest.camera->height) + " pixels is too large",
               "use images of at most 100 megapixels");
  }
  manifest.depth_scale = value.at("depth_scale").number_in(ranges::kDepthScale);
  if (const std::optional<YamlValue> offset = value.find("depth_offset")) {
    manifest.depth_offset = offset->number_in(ranges::kDepthOffset);
  }
}

MarkerRole role_of(const YamlValue& value) {
  const std::string role = value.text();
  if (role != "base" && role != "object") value.fail("is '" + role + "'", "write base or object");
  return role == "base" ? MarkerRole::base : MarkerRole::object;
}

bool has_object(const Manifest& manifest, const std::string& name) {
  return std::any_of(manifest.objects.begin(), manifest.objects.end(),
                     [&](const ObjectEntry& object) { return object.name == name; });
}

MaterialEntry material_of(const YamlValue& value, bool has_radius) {
  if (has_radius) {
    value.expect_keys({"youngs_modulus", "poisson_ratio", "radius"});
  } else {
    value.expect_keys({"youngs_modulus", "poisson_ratio"});
  }
  MaterialEntry material{value.at("youngs_modulus").number_in(ranges::kYoungsModulus),
                         value.at("poisson_ratio").number_in(ranges::kPoissonRatio),
                         {}};
  if (const auto radius = has_radius ? value.find("radius") : std::nullopt) {
    material.radius = radius->number_in(ranges::kBodySize);
  }
  return material;
}

void read_object(const YamlValue& value, const std::filesystem::path& folder, Manifest& manifest) {
  value.expect_keys(
      {"name", "mesh", "unit", "mass", "movable", "pose", "tracked_to_object", "material"});
  ObjectEntry object;
  const YamlValue name = value.at("name");
  object.name = name.text();
  expect_object_name(object.name, name);
  if (has_object(manifest, object.name)) {
    name.fail("object '" + object.name + "' is listed twice", "give each object its own name");
  }
  if (const std::optional<YamlValue> mesh = value.find("mesh")) {
    object.mesh = path_of(*mesh, folder);
  }
  if (const std::optional<YamlValue> unit = value.find("unit")) {
    object.mesh_unit = mesh_unit_of(*unit);
  }
  if (const std::optional<YamlValue> mass = value.find("mass")) {
    object.mass = mass->number_in(ranges::kMass);
  }
  if (const std::optional<YamlValue> movable = value.find("movable")) {
    object.is_movable = movable->boolean();
  }
  if (const std::optional<YamlValue> pose = value.find("pose")) {
    object.T_base_object = pose_of(*pose);
  }
  if (const std::optional<YamlValue> offset = value.find("tracked_to_object")) {
    object.T_tracked_object = pose_of(*offset);
  }
  if (const std::optional<YamlValue> material = value.find("material")) {
    object.material = material_of(*material, true);
  }
  manifest.objects.push_back(std::move(object));
}

void read_calibrations(const YamlValue& value, const std::filesystem::path& folder,
                       Manifest& manifest) {
  const std::vector<YamlValue> files = value.is_list() ? value.items() : std::vector{value};
  for (const YamlValue& item : files) {
    const std::filesystem::path file = path_of(item, folder);
    if (!folder.empty()) take_calibration(folder / file, item, manifest);
  }
}

Manifest read_manifest(const YamlValue& root, const std::filesystem::path& folder) {
  root.expect_keys(
      {"format", "camera", "markers", "wrench", "calibration", "objects", "tool", "robot"});
  const YamlValue format = root.at("format");
  if (format.text() != kFormat) {
    format.fail("is '" + format.text() + "'", std::string("this version reads ") + kFormat);
  }
  Manifest manifest;
  if (const std::optional<YamlValue> camera = root.find("camera")) read_camera(*camera, manifest);
  if (const std::optional<YamlValue> objects = root.find("objects")) {
    for (const YamlValue& object : objects->items()) read_object(object, folder, manifest);
  }
  if (const std::optional<YamlValue> markers = root.find("markers")) {
    for (const YamlValue& marker : markers->items()) add_marker(marker, manifest);
  }
  if (const std::optional<YamlValue> wrench = root.find("wrench")) {
    wrench->expect_keys({"direction_std"});
    manifest.force_direction_std = wrench->at("direction_std").number_in(ranges::kRotationStd);
  }
  if (const std::optional<YamlValue> calibration = root.find("calibration")) {
    read_calibrations(*calibration, folder, manifest);
  }
  if (const std::optional<YamlValue> tool = root.find("tool")) {
    tool->expect_keys({"radius", "material"});
    manifest.tool_radius = tool->at("radius").number_in(ranges::kToolRadius);
    if (const std::optional<YamlValue> material = tool->find("material")) {
      manifest.tool_material = material_of(*material, false);
    }
  }
  if (const std::optional<YamlValue> objects = root.find("objects")) {
    for (const YamlValue& object : objects->items()) {
      const std::optional<YamlValue> material = object.find("material");
      if (!material || manifest.tool_material) continue;
      material->fail("is given, but the tool has none", "add a material to the tool");
    }
  }
  if (const std::optional<YamlValue> robot = root.find("robot")) {
    robot->expect_keys({"urdf", "pose", "tip"});
    if (const std::optional<YamlValue> urdf = robot->find("urdf")) {
      manifest.robot = RobotEntry{.urdf = path_of(*urdf, folder)};
      if (const auto pose = robot->find("pose")) manifest.robot->T_base_robot = pose_of(*pose);
      if (const auto tip = robot->find("tip")) manifest.robot->tip = tip->text();
    } else if (robot->find("pose") || robot->find("tip")) {
      robot->fail("has no urdf", "add the arm's description, or remove the robot");
    }
  }
  return manifest;
}

}  // namespace

Pose pose_of(const YamlValue& value) {
  value.expect_keys({"t", "q"});
  const std::vector<double> t = value.at("t").numbers_in(3, ranges::kCoordinate);
  const YamlValue rotation = value.at("q");
  const std::vector<double> q = rotation.numbers(4);
  if (const std::optional<Error> error = check_unit_quaternion(q)) {
    rotation.fail(error->message, error->hint);
  }
  return Pose(Eigen::Quaterniond(q[3], q[0], q[1], q[2]), {t[0], t[1], t[2]});
}

double mesh_unit_of(const YamlValue& value) {
  const std::string name = value.text();
  for (const auto& [known, metres] : kMeshUnits) {
    if (name == known) return metres;
  }
  if (!name.empty() && std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
    return value.number_in(ranges::kMeshUnit);
  }
  value.fail("is '" + name + "'", "write m, cm, mm, in, or a number of metres");
}

MarkerEntry marker_of(const YamlValue& value) {
  value.expect_keys({"family", "id", "size", "role", "object", "pose", "covariance"});
  MarkerEntry marker;
  marker.id.family = value.at("family").text();
  marker.id.id = value.at("id").integer(0, 1'000'000);
  marker.size = value.at("size").number_in(ranges::kTagSize);
  marker.role = role_of(value.at("role"));
  const std::optional<YamlValue> object = value.find("object");
  if (marker.role == MarkerRole::object) {
    marker.object = value.at("object").text();
  } else if (object) {
    object->fail("a base marker has no object", "remove the key, or write role: object");
  }
  marker.T_parent_marker = pose_of(value.at("pose"));
  if (const std::optional<YamlValue> covariance = value.find("covariance")) {
    marker.covariance = covariance_of(*covariance);
  }
  return marker;
}

void add_marker(const YamlValue& value, Manifest& manifest) {
  MarkerEntry marker = marker_of(value);
  const bool is_known =
      std::any_of(manifest.markers.begin(), manifest.markers.end(),
                  [&](const MarkerEntry& other) { return other.id == marker.id; });
  if (is_known) {
    value.at("id").fail("tag " + marker.id.to_string() + " is listed twice",
                        "give each tag one entry");
  }
  if (marker.role == MarkerRole::object && !has_object(manifest, marker.object)) {
    value.at("object").fail("object '" + marker.object + "' is not declared",
                            "add it under objects");
  }
  manifest.markers.push_back(std::move(marker));
}

void expect_object_name(const std::string& name, const YamlValue& key) {
  const bool has_allowed_characters =
      name.find_first_of("/,\"\t") == std::string::npos && !has_controls(name);
  if (name.empty() || name == "." || name == ".." || !has_allowed_characters ||
      name.front() == ' ' || name.back() == ' ') {
    key.fail("'" + name + "' can't be the name of a file and a column",
             "choose a name without / , \" and control characters, and without spaces at its ends");
  }
}

Expected<Manifest> parse_manifest(const std::string& text, const std::string& file,
                                  const std::filesystem::path& folder) {
  return parse_yaml<Manifest>(text, file,
                              [&](const YamlValue& root) { return read_manifest(root, folder); });
}

Expected<Manifest> parse_manifest(const std::string& text, const std::string& file) {
  return parse_manifest(text, file, {});
}

}  // namespace pcavr
