// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "recordings/recording/manifest_calibration.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/solvers.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"

namespace pcavr {
namespace {

/// Of an entry of a covariance: variances of metres and radians.
constexpr InputRange kCovarianceEntry{"covariance", -1e6, 1e6, "m^2, rad^2",
                                      "the squares of the largest stds"};
/// Rounding makes a variance of a singular covariance negative by this much [m^2, rad^2].
constexpr double kRounding = 1e-12;

void take_tags(const YamlValue& root, Manifest& manifest) {
  Manifest found{.objects = manifest.objects};
  for (const YamlValue& entry : root.at("markers").items()) add_marker(entry, found);
  if (const auto accuracy = root.find("accuracy")) {
    for (const YamlValue& entry : accuracy->items()) {
      const std::string tag = entry.at("tag").text();
      const auto covariance = entry.find("covariance");
      for (MarkerEntry& marker : found.markers) {
        if (covariance && marker.id.to_string() == tag) {
          marker.covariance = covariance_of(*covariance);
        }
      }
    }
  }
  for (const MarkerEntry& marker : found.markers) {
    std::erase_if(manifest.markers,
                  [&](const MarkerEntry& listed) { return listed.id == marker.id; });
  }
  manifest.markers.insert(manifest.markers.end(), found.markers.begin(), found.markers.end());
}

void take_depth(const YamlValue& root, Manifest& manifest) {
  if (!manifest.camera) {
    root.fail("is of a depth camera, and the recording has none", "remove it from calibration");
  }
  manifest.depth_scale = root.at("depth_scale").number_in(ranges::kDepthScale);
  manifest.depth_offset = root.at("depth_offset").number_in(ranges::kDepthOffset);
}

/// The worst axis' std: by it the force in base may be turned, whatever its direction is.
void take_force(const YamlValue& root, Manifest& manifest) {
  const std::vector<double> stds = root.at("rotation_std").numbers_in(3, ranges::kRotationStd);
  manifest.force_direction_std = *std::max_element(stds.begin(), stds.end());
}

void take_objects(const YamlValue& root, Manifest& manifest) {
  for (const YamlValue& entry : root.at("objects").items()) {
    const std::string name = entry.at("name").text();
    const auto object = std::find_if(manifest.objects.begin(), manifest.objects.end(),
                                     [&](const ObjectEntry& other) { return other.name == name; });
    if (object == manifest.objects.end()) {
      entry.at("name").fail("object '" + name + "' is not declared", "add it under objects");
    }
    object->T_tracked_object = pose_of(entry.at("tracked_to_object"));
    object->mesh_unit = mesh_unit_of(entry.at("unit"));
  }
}

}  // namespace

Matrix6d covariance_of(const YamlValue& value) {
  const std::vector<YamlValue> rows = value.items();
  if (rows.size() != 6) value.fail("has no six rows", "write a row of six numbers for each");
  Matrix6d covariance;
  for (std::size_t row = 0; row < 6; ++row) {
    const std::vector<double> numbers = rows[row].numbers_in(6, kCovarianceEntry);
    for (std::size_t column = 0; column < 6; ++column) {
      covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          numbers[column];
    }
  }
  const Matrix6d symmetric = 0.5 * (covariance + covariance.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(symmetric);
  if (solver.eigenvalues().minCoeff() < -kRounding) {
    value.fail("is no covariance: a variance is negative", "take the file as calibrate wrote it");
  }
  return symmetric;
}

void take_calibration(const std::filesystem::path& file, const YamlValue& key, Manifest& manifest) {
  const Expected<std::string> text = read_file(file);
  if (!text) throw YamlFailure(text.error());
  const std::optional<Error> error = read_yaml(*text, file.string(), [&](const YamlValue& root) {
    const YamlValue format = root.at("format"), kind = root.at("kind");
    if (format.text() != kCalibrationFormat) {
      format.fail("is '" + format.text() + "'",
                  std::string("this version reads ") + kCalibrationFormat);
    }
    if (kind.text() == "tags") return take_tags(root, manifest);
    if (kind.text() == "depth") return take_depth(root, manifest);
    if (kind.text() == "objects") return take_objects(root, manifest);
    if (kind.text() == "force") return take_force(root, manifest);
    kind.fail("is '" + kind.text() + "'",
              "name files that pcavr calibrate tags, depth, objects or force wrote");
  });
  if (error) key.fail(error->to_string(), "");
}

}  // namespace pcavr
