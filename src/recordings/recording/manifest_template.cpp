// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/recording/manifest_template.hpp"

#include <cmath>
#include <set>
#include <string>
#include <system_error>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/depth_units.hpp"
#include "pcavr/recordings/recording/manifest_parser.hpp"

namespace pcavr {

Expected<Manifest> read_manifest_template(const std::filesystem::path& file) {
  if (file.empty()) return Manifest{};
  const Expected<std::string> text = read_file(file);
  if (!text) return text.error();
  // An empty folder would mean: not known, and calibrations would not be taken.
  const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
  Expected<Manifest> manifest = parse_manifest(*text, file.string(), folder);
  if (manifest) manifest->camera.reset();
  return manifest;
}

bool state_depth_units(double units_per_metre, Manifest& manifest) {
  // The scale of no depth camera is off by a fifth; usual units differ by two and more.
  constexpr double kCorrected = 0.2;
  if (std::abs(manifest.depth_scale / units_per_metre - 1.0) < kCorrected) return false;
  const bool had_offset = manifest.depth_offset != 0.0;
  manifest.depth_scale = units_per_metre;
  manifest.depth_offset = 0.0;
  return had_offset;
}

Expected<void> copy_manifest_files(const Manifest& manifest, const std::filesystem::path& from,
                                   const std::filesystem::path& target) {
  std::set<std::filesystem::path> files;
  for (const ObjectEntry& object : manifest.objects) {
    if (!object.mesh.empty()) files.insert(object.mesh);
  }
  if (manifest.robot) files.insert(manifest.robot->urdf);
  for (const std::filesystem::path& file : files) {
    const Expected<std::string> bytes = read_file(from / file);
    if (!bytes) return bytes.error();
    std::error_code code;
    std::filesystem::create_directories((target / file).parent_path(), code);
    if (auto written = write_file(target / file, *bytes); !written) return written.error();
  }
  return {};
}

}  // namespace pcavr
