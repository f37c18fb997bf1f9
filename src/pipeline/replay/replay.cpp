// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/replay.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/recording/stream_clocks.hpp"

#include "assemble_input.hpp"
#include "pipeline/build/scene_bodies.hpp"
#include "pipeline/checks/clock_checks.hpp"
#include "run_writer.hpp"
#include "track_bodies.hpp"

namespace pcavr {
namespace {

/// Keeps the displayed poses around the frames' stamps, and the first and the last: enough to draw
/// the augmented frames.
class ShownAroundFrames {
 public:
  ShownAroundFrames(const std::vector<FrameFiles>& frames, std::vector<ShownPose>& kept)
      : frames_(&frames), kept_(&kept) {}

  void add(const ShownPose& shown) {
    const Stamp stamp = Stamp::from_seconds(shown.t);
    while (next_ < frames_->size() && newest_ &&
           (*frames_)[next_].color_stamp < Stamp::from_seconds(newest_->t)) {
      ++next_;
    }
    const bool is_near = next_ < frames_->size() && (*frames_)[next_].color_stamp <= stamp;
    if (is_near) keep_newest();
    newest_ = shown;
    is_kept_ = false;
    if (is_near || kept_->empty()) keep_newest();
  }
  void keep_newest() {
    if (newest_ && !is_kept_) kept_->push_back(*newest_);
    is_kept_ = true;
  }

 private:
  const std::vector<FrameFiles>* frames_;
  std::vector<ShownPose>* kept_;
  std::size_t next_ = 0;
  std::optional<ShownPose> newest_;
  bool is_kept_ = false;
};

/// Shifts times from the recording's start to its clock.
void shift_to_clock(Stamp start, TeleopRun& run) {
  const double seconds = start.seconds();
  for (std::vector<ShownPose>& shown : run.shown) {
    for (ShownPose& pose : shown) pose.t += seconds;
  }
  for (ForceRow& row : run.forces) row.t += seconds;
  for (PhaseRow& row : run.phases) row.t += seconds;
  for (SentCorrection& sent : run.corrections) sent.t += seconds;
}

/// Runs both sites; their output is streamed to the replay's folder where it has one.
Expected<TeleopRun> run_sites(const std::vector<FrameFiles>& frames, Stamp start,
                              const TeleopInput& input, const ReplayOptions& options,
                              const Replay& replay, const Observer& observer) {
  if (!options.run_folder) {
    Expected<TeleopRun> run = run_teleop(input, options.teleop, observer);
    if (run) shift_to_clock(start, *run);
    return run;
  }
  TeleopWriter writer;
  const Expected<void> opened = writer.open(*options.run_folder, object_names(replay));
  if (!opened) return opened.error();
  std::vector<std::vector<ShownPose>> kept(input.objects.size());
  std::vector<ShownAroundFrames> around;
  around.reserve(kept.size());
  for (std::vector<ShownPose>& shown : kept) around.emplace_back(frames, shown);
  const auto on_clock = [seconds = start.seconds()](auto row) {
    row.t += seconds;
    return row;
  };
  TeleopSink sink = writer.sink();
  sink.take_shown = [&](std::size_t object, const ShownPose& shown) {
    around[object].add(on_clock(shown));
    return writer.add_shown(object, on_clock(shown));
  };
  sink.take_force = [&](const ForceRow& row) { return writer.add_force(on_clock(row)); };
  sink.take_correction = [&](const SentCorrection& sent) {
    return writer.add_correction(on_clock(sent));
  };
  Expected<TeleopRun> run = run_teleop(input, options.teleop, sink, observer);
  if (!run) return run;
  const Expected<void> closed = writer.close();
  if (!closed) return closed.error();
  for (ShownAroundFrames& shown : around) shown.keep_newest();
  shift_to_clock(start, *run);  // the phases only: the sink has all other rows
  run->shown = std::move(kept);
  return run;
}

/// `release` is called when the recording's series are no longer needed.
Expected<Replay> replay(const Recording& recording, const SceneManifest& scene,
                        const ReplayOptions& options, const Observer& observer,
                        const std::function<void()>& release) {
  const ImageUse images = options.tracked ? ImageUse::none : ImageUse::tracking;
  if (const auto conflict = check_clocks(recording, images, observer)) return *conflict;
  if (recording.tool.empty()) observer.on_warning(kNothingPredicted);
  Expected<SceneBodies> bodies = read_scene_bodies(recording, scene, options, observer);
  if (!bodies) return bodies.error();
  Expected<Replay> replay = track_bodies(recording, scene, bodies->movable, options, observer);
  if (replay) add_immovable(bodies->immovable, *replay);
  if (replay) replay->configuration = options.configuration;
  if (!replay || recording.tool.empty()) return replay;
  StageClock clock;
  clock.begin("both sites");
  Expected<TeleopInput> input =
      assemble_teleop_input(recording, scene, std::move(*bodies), *replay);
  if (!input) return input.error();
  const Stamp start = start_of(recording);
  release();
  replay->run_folder = options.run_folder;
  Expected<TeleopRun> run = run_sites(recording.frames, start, *input, options, *replay, observer);
  if (!run) {
    Error error = run.error();
    const std::filesystem::path named = recording.folder / error.file;
    if (!error.file.empty() && std::filesystem::exists(named)) error.file = named.string();
    return error;
  }
  clock.end();
  replay->teleop = std::move(*run);
  replay->parameters_file = options.parameters ? options.parameters_file : "none";
  replay->teleop_options = options.teleop;
  const std::vector<StageTime> times = clock.times();
  replay->times.insert(replay->times.end(), times.begin(), times.end());
  return replay;
}

}  // namespace

Expected<Replay> replay_recording(const Recording& recording, const SceneManifest& scene,
                                  const ReplayOptions& options, const Observer& observer) {
  return replay(recording, scene, options, observer, [] {});
}

Expected<Replay> replay_and_release(Recording& recording, const SceneManifest& scene,
                                    const ReplayOptions& options, const Observer& observer) {
  return replay(recording, scene, options, observer, [&recording] {
    recording.tool = {};
    recording.wrench = {};
  });
}

}  // namespace pcavr
