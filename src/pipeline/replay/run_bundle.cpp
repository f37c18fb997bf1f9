// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/utf8.hpp"
#include "pcavr/pipeline/replay.hpp"
#include "pcavr/recordings/recording/line_counts.hpp"
#include "pcavr/recordings/recording/trajectory_rows.hpp"

#include "run_writer.hpp"
#include "teleop_files.hpp"

namespace pcavr {
namespace {

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

/// Copies the tracking files unchanged; none where the folder has no such object.
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

/// The poses alone: a log has no evidence of each.
Expected<void> write_logged_tracking(const Replay& replay, const std::filesystem::path& folder) {
  for (const ReplayedObject& object : replay.objects) {
    std::string text(trajectory_header());
    for (const TrackedPose& seen : object.tracked) {
      append_trajectory_row(text, Stamp::from_seconds(seen.t), seen.T_base_object);
    }
    const Expected<void> written =
        write_file(folder / "objects" / object.name / "tracked.txt", text);
    if (!written) return written;
  }
  return {};
}

Expected<void> write_tracking(const Replay& replay, const std::filesystem::path& folder) {
  if (replay.tracked_folder) {
    for (const ReplayedObject& object : replay.objects) {
      const std::filesystem::path object_folder = std::filesystem::path("objects") / object.name;
      const Expected<void> copied =
          copy_tracking(*replay.tracked_folder / object_folder, folder / object_folder);
      if (!copied) return copied;
    }
    return {};
  }
  if (replay.objects_are_logged) return write_logged_tracking(replay, folder);
  // Streamed already.
  if (replay.run_folder && replay.frames_recorded > 0) return {};
  TrackingWriter writer;
  const Expected<void> opened = writer.open(folder, object_names(replay));
  if (!opened) return opened;
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    for (const ObjectObservation& seen : replay.objects[i].observations) {
      const Expected<void> added = writer.add(i, seen);
      if (!added) return added;
    }
  }
  return writer.close();
}

void emit_left_out(const Recording& recording, const Replay& replay, YAML::Emitter& yaml) {
  yaml << YAML::Key << "left_out" << YAML::Value << YAML::BeginSeq;
  for (const std::vector<SkippedRows>* rows : {&recording.left_out, &replay.left_out}) {
    for (const SkippedRows& entry : *rows) {
      yaml << YAML::Flow << YAML::BeginMap << YAML::Key << "file" << YAML::Value << entry.file;
      yaml << YAML::Key << "reason" << YAML::Value << entry.reason;
      yaml << YAML::Key << "rows" << YAML::Value << entry.count << YAML::EndMap;
    }
  }
  yaml << YAML::EndSeq;
}

void emit_lines(const LineCounts& lines, YAML::Emitter& yaml) {
  yaml << YAML::Key << "lines" << YAML::Value << YAML::BeginMap;
  for (const auto& [file, count] : lines) yaml << YAML::Key << file << YAML::Value << count;
  yaml << YAML::EndMap;
}

std::string format_run(const Replay& replay, const Recording& recording, const SceneManifest& scene,
                       const LineCounts& lines) {
  YAML::Emitter yaml;
  yaml << YAML::BeginMap;
  yaml << YAML::Key << "format" << YAML::Value << "pcavr-run/1";
  yaml << YAML::Key << "recording" << YAML::Value << as_utf8_text(recording.folder.string());
  yaml << YAML::Key << "scene" << YAML::Value << as_utf8_text(scene.folder.string());
  if (replay.tracked_folder) {
    yaml << YAML::Key << "tracked" << YAML::Value << as_utf8_text(replay.tracked_folder->string());
  } else if (replay.frames_recorded > 0) {
    emit_frames(replay, yaml);
  }
  yaml << YAML::Key << "objects" << YAML::Value << YAML::BeginSeq;
  for (const ReplayedObject& object : replay.objects) yaml << object.name;
  yaml << YAML::EndSeq;
  emit_left_out(recording, replay, yaml);
  emit_lines(lines, yaml);
  if (replay.teleop) {
    emit_teleop(replay, yaml);
  } else {
    yaml << YAML::Key << "notes" << YAML::Value << YAML::BeginSeq << kNothingPredicted
         << YAML::EndSeq;
  }
  if (!replay.configuration.empty()) {
    yaml << YAML::Key << "configuration" << YAML::Value << YAML::BeginMap;
    for (const auto& [key, value] : replay.configuration) {
      yaml << YAML::Key << key << YAML::Value << value;
    }
    yaml << YAML::EndMap;
  }
  yaml << YAML::EndMap;
  return std::string(yaml.c_str()) + '\n';
}

}  // namespace

Expected<void> write_run(const Replay& replay, const Recording& recording,
                         const SceneManifest& scene, const std::filesystem::path& folder) {
  PCAVR_REQUIRE(!replay.run_folder || *replay.run_folder == folder, folder.string());
  for (const ReplayedObject& object : replay.objects) {
    const std::filesystem::path object_folder = folder / "objects" / object.name;
    std::error_code code;
    std::filesystem::create_directories(object_folder, code);
    if (code)
      return Error{.message = "can't be created: " + code.message(),
                   .file = object_folder.string()};
  }
  const Expected<void> tracking = write_tracking(replay, folder);
  if (!tracking) return tracking;
  if (replay.teleop) {
    const Expected<void> done = write_teleop_files(replay, folder);
    if (!done) return done;
  }
  const Expected<LineCounts> lines = count_lines(folder);
  if (!lines) return lines.error();
  return write_file(folder / "run.yaml", format_run(replay, recording, scene, *lines));
}

}  // namespace pcavr
