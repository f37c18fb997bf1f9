// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string>

#include <yaml-cpp/yaml.h>

#include "pcavr/core/output.hpp"
#include "pcavr/pipeline/replay.hpp"

#include "follow_objects.hpp"

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

std::string format_run(const Replay& replay, const Recording& recording,
                       const SceneManifest& scene) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << "pcavr-run/1";
  yaml << YAML::Key << "recording" << YAML::Value << recording.folder.string();
  yaml << YAML::Key << "scene" << YAML::Value << scene.folder.string();
  yaml << YAML::Key << "camera" << YAML::Value
       << (replay.camera_from_scene ? "from the scene" : "from this recording");
  yaml << YAML::Key << "frames" << YAML::Value << YAML::BeginMap;
  yaml << YAML::Key << "recorded" << YAML::Value << replay.frames_recorded;
  yaml << YAML::Key << "used" << YAML::Value << replay.frames_used;
  for (const auto& [reason, count] : replay.frames_dropped) {
    yaml << YAML::Key << reason << YAML::Value << count;
  }
  yaml << YAML::EndMap;
  yaml << YAML::Key << "objects" << YAML::Value << YAML::BeginSeq;
  for (const ReplayedObject& object : replay.objects) yaml << object.name;
  yaml << YAML::EndSeq << YAML::EndMap;
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
    const auto tracked = write_file(place / "tracked.txt",
                                    format_trajectory(tracked_trajectory(object.observations)));
    if (!tracked) return tracked;
    const auto tracking = write_file(place / "tracking.csv", format_tracking(object.observations));
    if (!tracking) return tracking;
  }
  return write_file(folder / "run.yaml", format_run(replay, recording, scene));
}

}  // namespace pcavr
