// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "planned_recordings.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

#include "pcavr/base/core/output_paths.hpp"
#include "pcavr/pipeline/support_name.hpp"
#include "pcavr/recordings/recording/recording.hpp"

#include "input_content.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

/// What must be the same of all objects of one name.
struct Body {
  std::string mesh;  ///< SHA-256 of the CAD file, empty without one
  std::optional<double> mass;
  fs::path recording;
};
using Bodies = std::map<std::string, Body>;

Error differing(const fs::path& recording, const std::string& object, const std::string& what,
                const fs::path& other) {
  return {.message = fmt::format("{} has another {} than in {}", object, what, other.string()),
          .file = recording.string(),
          .place = {},
          .hint = "give one object one name, and others another; or make a plan of each"};
}

Expected<void> check_bodies(const Recording& recording, Bodies& bodies) {
  for (const ObjectEntry& object : recording.manifest.objects) {
    Body body{{}, object.mass, recording.folder};
    if (!object.mesh.empty()) {
      const Expected<InputContent> mesh = input_content(recording.folder / object.mesh);
      if (!mesh) return mesh.error();
      body.mesh = mesh->content;
    }
    const auto [entry, is_new] = bodies.try_emplace(object.name, body);
    if (is_new) continue;
    const Body& before = entry->second;
    if (before.mesh != body.mesh)
      return differing(recording.folder, object.name, "CAD file", before.recording);
    if (before.mass != body.mass)
      return differing(recording.folder, object.name, "mass", before.recording);
  }
  return {};
}

/// SUPPORT/FOLDER; a number follows where another recording has this name.
std::string unique_name(const std::string& support, const fs::path& folder,
                        std::set<std::string>& names) {
  const std::string first = support + '/' + folder.filename().string();
  std::string name = first;
  for (int i = 2; !names.insert(name).second; ++i) name = fmt::format("{}-{}", first, i);
  return name;
}

Expected<PlannedRecording> plan_recording(const fs::path& folder, Bodies& bodies) {
  const Expected<Recording> recording = read_recording(folder);
  if (!recording) return recording.error();
  const Expected<void> checked = check_bodies(*recording, bodies);
  if (!checked) return checked.error();
  Expected<PlannedInput> files = planned_input(folder, "truth");
  if (!files) return files.error();
  PlannedRecording planned{.name = {}, .support = {}, .files = *std::move(files)};
  std::error_code code;
  if (fs::is_directory(folder / "truth", code)) {
    Expected<PlannedInput> truth = planned_input(folder / "truth");
    if (!truth) return truth.error();
    planned.truth = *std::move(truth);
  }
  for (const ObjectEntry& object : recording->manifest.objects) {
    if (object.is_movable) planned.objects.push_back(object.name);
  }
  planned.frames = recording->frames.size();
  planned.samples = recording->tool.size() + recording->wrench.size();
  return planned;
}

Error given_twice(const fs::path& folder, const fs::path& before) {
  return {.message = "is the same recording as " + before.string(),
          .file = folder.string(),
          .place = {},
          .hint = "give each one once"};
}

}  // namespace

bool is_support_name(const std::string& name) {
  return !name.empty() && name.front() != '.' && name.front() != '_' &&
         name.find('/') == std::string::npos;
}

std::string support_of(const fs::path& recording) {
  const std::string name = recording.parent_path().filename().string();
  return is_support_name(name) ? name : "unnamed";
}

Expected<PlannedInput> planned_input(const fs::path& path, const std::string& without) {
  const Expected<fs::path> absolute = resolve_path(path);
  if (!absolute) return absolute.error();
  Expected<InputContent> content = input_content(*absolute, without);
  if (!content) return content.error();
  return PlannedInput{*absolute, std::move(content->content), std::move(content->listing)};
}

Expected<std::vector<PlannedRecording>> planned_recordings(const std::vector<std::string>& folders,
                                                           const std::string& support,
                                                           const Observer& observer) {
  if (!support.empty() && !is_support_name(support)) {
    return Error{
        .message = "is no name of a support",
        .file = "--support",
        .place = support,
        .hint = "give a name without '/' that does not begin with '.' or '_', such as wood"};
  }
  std::vector<PlannedRecording> all;
  std::map<std::string, fs::path> by_content;
  std::set<std::string> names;
  Bodies bodies;
  for (const std::string& given : folders) {
    const Expected<fs::path> folder = resolve_path(given);
    if (!folder) return folder.error();
    Expected<PlannedRecording> planned = plan_recording(*folder, bodies);
    if (!planned) return planned.error();
    const auto [before, is_new] = by_content.try_emplace(planned->files.content, *folder);
    if (!is_new) return given_twice(given, before->second);
    planned->support = support.empty() ? support_of(*folder) : support;
    planned->name = unique_name(planned->support, *folder, names);
    all.push_back(*std::move(planned));
    observer.on_progress("reading recordings", all.size(), folders.size());
  }
  return all;
}

}  // namespace pcavr
