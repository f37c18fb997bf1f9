// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Tag files of other programs: apriltag_ros (config/tags.yaml) and TagSLAM (tagslam.yaml).
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "pcavr/base/core/decimal.hpp"
#include "pcavr/base/core/input_ranges.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/pipeline/calibrate_tags.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"
#include "pcavr/recordings/recording/time_series.hpp"
#include "pcavr/recordings/recording/yaml_map.hpp"

#include "yaml_text.hpp"

namespace pcavr {
namespace {

constexpr int kMaxTagId = 1'000'000;

MarkerEntry placed_tag(const YamlValue& tag, const std::string& family, double size) {
  MarkerEntry placed;
  placed.id = {family, tag.at("id").integer(0, kMaxTagId)};
  placed.size = size;
  return placed;
}

double size_of(const YamlValue& tag) { return tag.at("size").number_in(ranges::kTagSize); }

/// apriltag_ros: x, y, z, qw, qx, qy, qz; what is absent is that of the identity.
Pose flat_pose(const YamlValue& tag) {
  const auto number = [&](const char* key, double absent) {
    const std::optional<YamlValue> value = tag.find(key);
    return value ? value->number_in(ranges::kCoordinate) : absent;
  };
  const std::vector<double> q{number("qx", 0.0), number("qy", 0.0), number("qz", 0.0),
                              number("qw", 1.0)};
  if (const std::optional<Error> error = check_unit_quaternion(q)) {
    tag.fail(error->message, error->hint);
  }
  return Pose(Eigen::Quaterniond(q[3], q[0], q[1], q[2]),
              {number("x", 0.0), number("y", 0.0), number("z", 0.0)});
}

/// TagSLAM: maps of position [m] and rotation vector [rad].
Pose vector_pose(const YamlValue& pose) {
  const auto vector = [&](const char* key) {
    const YamlValue value = pose.at(key);
    return Eigen::Vector3d(value.at("x").number_in(ranges::kCoordinate),
                           value.at("y").number_in(ranges::kCoordinate),
                           value.at("z").number_in(ranges::kCoordinate));
  };
  Vector6d rotation = Vector6d::Zero();
  rotation.tail<3>() = vector("rotation");
  return Pose::from_translation(vector("position")) * Pose::exp(rotation);
}

void set_body(const std::string& name, bool is_base, MarkerEntry& tag) {
  tag.role = is_base ? MarkerRole::base : MarkerRole::object;
  if (!is_base) tag.object = name;
}

TagFile read_apriltag_ros(const YamlValue& root, const std::string& family) {
  TagFile file;
  std::size_t bundles = 0;
  if (const std::optional<YamlValue> standalone = root.find("standalone_tags")) {
    for (const YamlValue& tag : standalone->items()) {
      file.unplaced.emplace_back(placed_tag(tag, family, 0.0).id, size_of(tag));
    }
  }
  if (const std::optional<YamlValue> list = root.find("tag_bundles")) {
    const std::vector<YamlValue> items = list->items();
    bundles = items.size();
    for (const YamlValue& bundle : items) {
      const std::string name = bundle.at("name").text();
      for (const YamlValue& entry : bundle.at("layout").items()) {
        MarkerEntry tag = placed_tag(entry, family, size_of(entry));
        tag.T_parent_marker = flat_pose(entry);
        set_body(name, name == "base" || bundles == 1, tag);
        file.markers.push_back(std::move(tag));
      }
    }
  }
  file.format = fmt::format("apriltag_ros, {} bundle{}, {} standalone", bundles,
                            bundles == 1 ? "" : "s", file.unplaced.size());
  return file;
}

TagFile read_tagslam(const YamlValue& root, const std::string& family) {
  TagFile file;
  std::size_t bodies = 0;
  for (const YamlValue& item : root.at("bodies").items()) {
    for (const auto& [name, body] : item.entries()) {
      const std::optional<YamlValue> tags = body.find("tags");
      if (!tags) continue;
      ++bodies;
      const bool is_base = body.at("is_static").boolean();
      const std::optional<YamlValue> own = body.find("pose");
      // A static body's tags are in base (TagSLAM's map), through the body's own pose.
      const Pose T_parent_body = is_base && own ? vector_pose(*own) : Pose();
      for (const YamlValue& entry : tags->items()) {
        const bool has_size = entry.find("size").has_value();
        const double size =
            has_size ? size_of(entry) : body.at("default_tag_size").number_in(ranges::kTagSize);
        MarkerEntry tag = placed_tag(entry, family, size);
        const std::optional<YamlValue> pose = entry.find("pose");
        if (!pose) {
          file.unplaced.emplace_back(tag.id, size);
          continue;
        }
        tag.T_parent_marker = T_parent_body * vector_pose(*pose);
        set_body(name, is_base, tag);
        file.markers.push_back(std::move(tag));
      }
    }
  }
  file.format = fmt::format("TagSLAM, {} bod{} with tags", bodies, bodies == 1 ? "y" : "ies");
  return file;
}

/// The `markers:` of a recording's manifest, or of a calibration.
TagFile read_pcavr(const YamlValue& root) {
  TagFile file{.format = "pcavr"};
  for (const YamlValue& entry : root.at("markers").items()) {
    file.markers.push_back(marker_of(entry));
  }
  return file;
}

std::string number_text(const char* key, double number) {
  return std::string(key) + ": " + shortest_decimal(number);
}

std::string apriltag_ros_text(const CalibratedTags& found) {
  std::string text = std::string(kForeignCalibration) +
                     "\n# apriltag_ros, config/tags.yaml: poses of the tags in their bundle [m]\n"
                     "standalone_tags: []\ntag_bundles:\n";
  for (const CalibratedBody& body : found.bodies) {
    text += fmt::format("  - name: {}\n    layout:\n", body.name.empty() ? "base" : body.name);
    for (const LaidOutTag& tag : body.layout.tags) {
      const Eigen::Vector3d& p = tag.T_body_tag.translation();
      const Eigen::Quaterniond& q = tag.T_body_tag.rotation();
      text +=
          fmt::format("      - {{id: {}, {}, {}, {}, {}, {}, {}, {}, {}}}\n", tag.id.id,
                      number_text("size", tag.size), number_text("x", p.x()),
                      number_text("y", p.y()), number_text("z", p.z()), number_text("qw", q.w()),
                      number_text("qx", q.x()), number_text("qy", q.y()), number_text("qz", q.z()));
    }
  }
  return text;
}

std::string vector_text(const char* key, const Eigen::Vector3d& v) {
  return fmt::format("{}: {{{}, {}, {}}}", key, number_text("x", v.x()), number_text("y", v.y()),
                     number_text("z", v.z()));
}

std::string tagslam_text(const CalibratedTags& found) {
  std::string text =
      std::string(kForeignCalibration) +
      "\n# TagSLAM, tagslam.yaml: poses of the tags in their body [m, rad]\nbodies:\n";
  for (const CalibratedBody& body : found.bodies) {
    const bool is_base = body.name.empty();
    text += fmt::format("  - {}:\n      is_static: {}\n      type: simple\n",
                        is_base ? "base" : body.name, is_base);
    if (is_base) {
      text +=
          "      pose:\n        position: {x: 0, y: 0, z: 0}\n        rotation: {x: 0, y: 0, z: "
          "0}\n"
          "        position_noise: {x: 0.0001, y: 0.0001, z: 0.0001}\n"
          "        rotation_noise: {x: 1.0e-05, y: 1.0e-05, z: 1.0e-05}\n";
    }
    text += "      tags:\n";
    for (const LaidOutTag& tag : body.layout.tags) {
      const Eigen::Vector3d spread = Eigen::Vector3d::Constant(std::max(1e-4, tag.position_std()));
      const Eigen::Vector3d turn = Eigen::Vector3d::Constant(std::max(1e-5, tag.rotation_std()));
      text += fmt::format("        - id: {}\n          size: {}\n          pose:\n", tag.id.id,
                          shortest_decimal(tag.size));
      for (const std::string& line :
           {vector_text("position", tag.T_body_tag.translation()),
            vector_text("rotation", tag.T_body_tag.log().tail<3>()),
            vector_text("position_noise", spread), vector_text("rotation_noise", turn)}) {
        text += "            " + line + '\n';
      }
    }
  }
  return text;
}

/// The markers as a recording lists them, and how sure each is.
std::string pcavr_text(const CalibratedTags& found, const TagWalkInput& input) {
  Manifest manifest;
  std::string accuracy;
  for (const CalibratedBody& body : found.bodies) {
    for (const LaidOutTag& tag : body.layout.tags) {
      manifest.markers.push_back({.id = tag.id,
                                  .size = tag.size,
                                  .role = body.name.empty() ? MarkerRole::base : MarkerRole::object,
                                  .object = body.name,
                                  .T_parent_marker = tag.T_body_tag});
      accuracy += fmt::format(
          "  - tag: {}\n    position_std: {}  # m, in the worst direction\n    rotation_std: {}  "
          "# rad\n    images: {}\n    left_out: {}\n    is_reference: {}\n",
          tag.id.to_string(), shortest_decimal(tag.position_std()),
          shortest_decimal(tag.rotation_std()), tag.views, tag.rejected, tag.is_reference);
      accuracy += "    covariance:  # of the twist [v (m); w (rad)] in the tag's axes\n";
      accuracy += row_lists(tag.covariance, "      ");
    }
  }
  std::string markers = format_manifest(manifest);
  markers.erase(0, markers.find('\n') + 1);  // its own format line
  return "format: pcavr-calibration/1\nkind: tags\nsource: " + quoted(input.input.string()) + '\n' +
         markers + "accuracy:\n" + accuracy;
}

}  // namespace

Expected<TagFile> read_tag_file(const std::filesystem::path& file, const std::string& family) {
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse_yaml<TagFile>(*text, file.string(), [&](const YamlValue& root) {
    if (root.find("markers")) return read_pcavr(root);
    if (root.find("bodies")) return read_tagslam(root, family);
    if (root.find("tag_bundles") || root.find("standalone_tags")) {
      return read_apriltag_ros(root, family);
    }
    root.fail("has no tags",
              "give a file with markers (pcavr), tag_bundles (apriltag_ros) or bodies (TagSLAM)");
  });
}

std::string format_tags(const CalibratedTags& found, const TagWalkInput& input,
                        TagFileFormat format) {
  switch (format) {
    case TagFileFormat::apriltag_ros:
      return apriltag_ros_text(found);
    case TagFileFormat::tagslam:
      return tagslam_text(found);
    case TagFileFormat::pcavr:
      break;
  }
  return pcavr_text(found, input);
}

}  // namespace pcavr
