// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "core/output_kind.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <initializer_list>
#include <string>

#include "core/output_error.hpp"
#include "core/partial_names.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// [bytes] of a manifest that are searched for its format: pcavr writes it in the first line or
/// two, and a person hardly behind this.
constexpr std::size_t kManifestBytes = 1U << 20U;

struct KindFacts {
  OutputKind kind;
  const char* name;
  const char* manifest;
  std::initializer_list<std::string_view> formats;  ///< without the version
  /// What pcavr writes in the folder itself. A file that is missing here keeps --force from
  /// replacing such an output.
  std::initializer_list<std::string_view> entries;
};

const std::array<KindFacts, 4>& all_kinds() {
  static const std::array<KindFacts, 4> kinds{
      KindFacts{
          OutputKind::recording,
          "recording",
          "recording.yaml",
          {"pcavr-recording/"},
          {"recording.yaml", "rgb", "rgb.txt", "depth", "depth.txt", "groundtruth.txt", "tool.csv",
           "wrench.csv", "joints.csv", "objects", "tracked", "truth", "written.yaml"}},
      KindFacts{OutputKind::scene,
                "scene",
                "scene.yaml",
                {"pcavr-scene/"},
                {"scene.yaml", "scene.glb", "lod", "mesh.ply", "cloud.ply", "occupancy.bt",
                 "camera_trajectory.txt", "objects", "preview.png"}},
      KindFacts{
          OutputKind::run,
          "run",
          "run.yaml",
          {"pcavr-run/"},
          {"run.yaml", "objects", "force.csv", "phases.csv", "corrections.csv", "parameters.yaml"}},
      KindFacts{OutputKind::report,
                "report",
                "report.json",
                {"pcavr-report/", "pcavr-identification/"},
                {"report.json", "report.html"}}};
  return kinds;
}

const KindFacts& facts_of(OutputKind kind) {
  const auto& kinds = all_kinds();
  return *std::find_if(kinds.begin(), kinds.end(),
                       [&](const KindFacts& facts) { return facts.kind == kind; });
}

std::string beginning_of(const fs::path& file) {
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return {};
  std::ifstream stream(file, std::ios::binary);
  std::string text(kManifestBytes, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

/// Whether a YAML or JSON text has a key `format` whose value begins with `format`: at the begin of
/// a line, either of them in quotes or not.
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

bool holds(const fs::path& folder, const KindFacts& facts) {
  const std::string text = beginning_of(folder / facts.manifest);
  return std::any_of(facts.formats.begin(), facts.formats.end(),
                     [&](std::string_view format) { return has_format(text, format); });
}

Error not_replaceable(const fs::path& folder, const std::string& reason) {
  return {.message = "is there already, and --force does not replace it: " + reason,
          .file = folder.string(),
          .hint = "choose another name, or move away what is there"};
}

}  // namespace

std::string_view manifest_name(OutputKind kind) { return facts_of(kind).manifest; }

bool is_manifest_name(std::string_view file_name) {
  const auto& kinds = all_kinds();
  return std::any_of(kinds.begin(), kinds.end(),
                     [&](const KindFacts& facts) { return file_name == facts.manifest; });
}

bool is_ignored_entry(std::string_view name) {
  return name == "lost+found" || PartialNames::is_inside_name(name);
}

Expected<void> check_replaceable(const fs::path& folder, OutputKind kind) {
  const KindFacts& facts = facts_of(kind);
  if (!holds(folder, facts)) {
    for (const KindFacts& other : all_kinds()) {
      if (!holds(folder, other)) continue;
      return not_replaceable(
          folder, std::string("it holds a ") + other.name + ", and this is a " + facts.name);
    }
    return not_replaceable(folder, std::string("it does not hold a ") + facts.name + " (no " +
                                       facts.manifest + " of pcavr)");
  }
  std::error_code code;
  for (const auto& entry : fs::directory_iterator(folder, code)) {
    const std::string name = entry.path().filename().string();
    if (is_ignored_entry(name)) continue;
    if (std::find(facts.entries.begin(), facts.entries.end(), name) == facts.entries.end()) {
      return not_replaceable(folder,
                             "it also holds " + name + ", which is not part of a " + facts.name);
    }
  }
  if (code) return can_not_write(folder, code.message());
  return {};
}

}  // namespace pcavr
