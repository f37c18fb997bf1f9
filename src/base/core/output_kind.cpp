// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "base/core/output_kind.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

#include "base/core/output_entries.hpp"
#include "base/core/output_error.hpp"
#include "base/core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// Length of the part of a manifest that is searched for its format [bytes]: pcavr writes it in the
/// first line or two, and a user hardly after this.
constexpr std::size_t kManifestBytes = 1U << 20U;

struct OutputKindInfo {
  OutputKind kind;
  const char* name;
  const char* manifest;
  std::vector<std::string_view> formats;  ///< without the version
  /// The entries that pcavr writes into the folder itself. A file that is missing in this list
  /// prevents --force from replacing such an output.
  std::vector<std::string_view> entries;
  /// Files of its own that name others, with the manifest.
  std::vector<std::string_view> texts;
  /// Patterns of the files that it writes into sub-folders besides those that the texts name; see
  /// matches().
  std::vector<std::string_view> nested;
};

const std::array<OutputKindInfo, 4>& all_kinds() {
  static const std::array<OutputKindInfo, 4> kinds{
      OutputKindInfo{
          OutputKind::recording,
          "recording",
          "recording.yaml",
          {"pcavr-recording/"},
          {"recording.yaml", "rgb", "rgb.txt", "depth", "depth.txt", "groundtruth.txt", "tool.csv",
           "wrench.csv", "joints.csv", "robot.urdf", "objects", "tracked", "truth", "written.yaml"},
          {"recording.yaml", "written.yaml", "rgb.txt", "depth.txt"},
          {"tracked/objects/*/tracked.txt", "tracked/objects/*/tracking.csv", "truth/camera.txt",
           "truth/scene.ply", "truth/phase.csv", "truth/impacts.csv", "truth/parameters.yaml",
           "truth/objects/*.txt"}},
      OutputKindInfo{OutputKind::scene,
                     "scene",
                     "scene.yaml",
                     {"pcavr-scene/"},
                     {"scene.yaml", "scene.glb", "lod", "mesh.ply", "cloud.ply", "cloud.pcd",
                      "occupancy.bt", "camera_trajectory.txt", "objects", "robot", "preview.png"},
                     {"scene.yaml"},
                     {"objects/*.glb", "robot/link_#.glb", "lod/static_mesh_#.glb"}},
      OutputKindInfo{
          OutputKind::run,
          "run",
          "run.yaml",
          {"pcavr-run/"},
          {"run.yaml", "objects", "force.csv", "phases.csv", "corrections.csv", "parameters.csv",
           "parameters.yaml"},
          {"run.yaml"},
          {"objects/*/predicted.txt", "objects/*/tracked.txt", "objects/*/tracking.csv"}},
      OutputKindInfo{OutputKind::report,
                     "report",
                     "report.json",
                     {"pcavr-report/", "pcavr-identification/", "pcavr-pooled-identification/",
                      "pcavr-evaluated-runs/"},
                     {"report.json", "report.html", "report_data.json", "mesh_errors.ply",
                      "runs.csv", "parameters.tex", "evaluations.csv", "paired.csv",
                      "friction_atlas.csv", "friction_atlas.parquet", "parameters"},
                     {"report.json"},
                     {"parameters/*.yaml"}}};
  return kinds;
}

const OutputKindInfo& info_of(OutputKind kind) {
  const auto& kinds = all_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const OutputKindInfo& info) { return info.kind == kind; });
}

std::string read_beginning(const fs::path& file) {
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return {};
  std::ifstream stream(file, std::ios::binary);
  std::string text(kManifestBytes, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

/// Whether a YAML or JSON text has a key `format` at the beginning of a line whose value begins
/// with `format`; both may be quoted.
bool has_format(const std::string& text, std::string_view format) {
  constexpr std::string_view kBlank = " \t\"'";
  for (std::size_t at = text.find("format"); at != text.npos; at = text.find("format", at + 1)) {
    const std::size_t before = at == 0 ? text.npos : text.find_last_not_of(kBlank, at - 1);
    if (before != text.npos && text[before] != '\n') continue;
    std::size_t next = text.find_first_not_of(kBlank, at + std::string_view("format").size());
    if (next == text.npos || text[next] != ':') continue;
    next = text.find_first_not_of(kBlank, next + 1);
    if (next != text.npos && text.compare(next, format.size(), format) == 0) return true;
  }
  return false;
}

bool holds(const fs::path& folder, const OutputKindInfo& info) {
  const std::string text = read_beginning(folder / info.manifest);
  return std::any_of(info.formats.begin(), info.formats.end(),
                     [&](std::string_view format) { return has_format(text, format); });
}

Error not_replaceable(const fs::path& folder, const std::string& reason) {
  return {.message = "already exists, and --force does not replace it: " + reason,
          .file = folder.string(),
          .hint = "choose another name, or move away what is there"};
}

}  // namespace

std::string_view manifest_name(OutputKind kind) { return info_of(kind).manifest; }

bool is_manifest_name(std::string_view file_name) {
  const auto& kinds = all_kinds();
  return std::any_of(kinds.begin(), kinds.end(),
                     [&](const OutputKindInfo& info) { return file_name == info.manifest; });
}

bool is_ignored_entry(std::string_view name) {
  return name == "lost+found" || PartialNames::is_inside_name(name);
}

Expected<void> check_replaceable(const fs::path& folder, OutputKind kind) {
  const OutputKindInfo& info = info_of(kind);
  if (!holds(folder, info)) {
    for (const OutputKindInfo& other : all_kinds()) {
      if (!holds(folder, other)) continue;
      return not_replaceable(
          folder, std::string("it contains a ") + other.name + ", and this is a " + info.name);
    }
    return not_replaceable(folder, std::string("it does not contain a ") + info.name + " (no " +
                                       info.manifest + " of pcavr)");
  }
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (is_ignored_entry(name)) continue;
    if (std::find(info.entries.begin(), info.entries.end(), name) == info.entries.end()) {
      return not_replaceable(folder,
                             "it also contains " + name + ", which is not part of a " + info.name);
    }
  }
  if (code) return can_not_write(folder, code);
  if (const auto foreign = find_foreign_file(folder, info.texts, info.nested)) {
    return not_replaceable(
        folder, "it also contains " + *foreign + ", which its " + info.manifest + " does not name");
  }
  return {};
}

}  // namespace pcavr
