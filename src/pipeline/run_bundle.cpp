// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string>

#include <yaml-cpp/yaml.h>

#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "follow_objects.hpp"
#include "teleop_files.hpp"

namespace pcavr {
namespace {

std::string format_tracking(const std::vector<ObjectObservation>& observations) {
  std::string text = "t,evidence,tags,position_sigma,rotation_sigma,surface_rms,at_rest\n";
  char row[160];
  for (const ObjectObservation& seen : observations) {
    const double position = std::sqrt(seen.covariance.topLeftCorner<3, 3>().trace());
    const double rotation = std::sqrt(seen.covariance.bottomRightCorner<3, 3>().trace());
    std::snprintf(row, sizeof row, "%s,%s,%d,%.6f,%.6f,%.6f,%d\n", format_stamp(seen.stamp).c_str(),
                  evidence_word(seen.evidence), seen.tags_used, position, rotation,
                  seen.surface_rms, seen.is_at_rest ? 1 : 0);
    text += row;
  }
  return text;
}

Trajectory tracked_trajectory(const std::vector<ObjectObservation>& observations) {
  Trajectory tracked;
  for (const ObjectObservation& seen : observations) {
    if (seen.evidence != ObjectEvidence::none) tracked.append(seen.stamp, seen.T_base_object);
  }
  return tracked;
}

void emit_frames(const Replay& replay, YAML::Emitter& yaml) {
  yaml << YAML::Key << "camera" << YAML::Value
       << (replay.camera_from_scene ? "from the scene" : "from this recording");
  yaml << YAML::Key << "frames" << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << "recorded" << YAML::Value << replay.frames_recorded;
  yaml << YAML::Key << "used" << YAML::Value << replay.frames_used;
  for (const auto& [reason, count] : replay.frames_dropped) {
    yaml << YAML::Key << reason << YAML::Value << count;
  }
  yaml << YAML::EndMap;
}

/// As they stand in the folder that tracking was taken from; none where the object was not in it.
Expected<void> copy_tracking(const std::filesystem::path& from, const std::filesystem::path& to) {
  for (const char* name : {"tracked.txt", "tracking.csv"}) {
    if (!std::filesystem::exists(from / name)) continue;
    const Expected<std::string> text = read_file(from / name);
    if (!text) return text.error();
    const Expected<void> written = write_file(to / name, *text);
    if (!written) return written;
  }
  return {};
}

Expected<void> write_tracking(const Replay& replay, const ReplayedObject& object,
                              const std::filesystem::path& place) {
  if (replay.tracked_folder) {
    return copy_tracking(*replay.tracked_folder / "objects" / object.name, place);
  }
  const auto tracked =
      write_file(place / "tracked.txt", format_trajectory(tracked_trajectory(object.observations)));
  if (!tracked) return tracked;
  return write_file(place / "tracking.csv", format_tracking(object.observations));
}

std::string format_run(const Replay& replay, const Recording& recording,
                       const SceneManifest& scene) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << "pcavr-run/1";
  yaml << YAML::Key << "recording" << YAML::Value << recording.folder.string();
  yaml << YAML::Key << "scene" << YAML::Value << scene.folder.string();
  if (replay.tracked_folder) {
    yaml << YAML::Key << "tracked" << YAML::Value << replay.tracked_folder->string();
  } else if (replay.frames_recorded > 0) {
    emit_frames(replay, yaml);
  }
  yaml << YAML::Key << "objects" << YAML::Value << YAML::BeginSeq;
  for (const ReplayedObject& object : replay.objects) yaml << object.name;
  yaml << YAML::EndSeq;
  if (replay.teleop) emit_teleop(replay, yaml);
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + '\n';
}

}  // namespace

Expected<void> write_run(const Replay& replay, const Recording& recording,
                         const SceneManifest& scene, const std::filesystem::path& folder) {
  for (const ReplayedObject& object : replay.objects) {
    const std::filesystem::path place = folder / "objects" / object.name;
    std::error_code code;
    std::filesystem::create_directories(place, code);
    if (code) return Error{.message = "can't be made: " + code.message(), .file = place.string()};
    const Expected<void> tracking = write_tracking(replay, object, place);
    if (!tracking) return tracking;
  }
  if (replay.teleop) {
    const Expected<void> done = write_teleop_files(replay, folder);
    if (!done) return done;
  }
  return write_file(folder / "run.yaml", format_run(replay, recording, scene));
}

}  // namespace pcavr
