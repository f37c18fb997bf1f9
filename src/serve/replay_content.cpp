// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/replay_content.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/serve/scene_joints.hpp"

#include "content_text.hpp"
#include "replay_rows.hpp"

namespace pcavr {
namespace {

using Json = nlohmann::ordered_json;

/// Time from the first to the last stamp of a replay's data [s].
struct ReplaySpan {
  double start = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();

  void add(double t) {
    start = std::min(start, t);
    end = std::max(end, t);
  }
  template <typename Rows>
  void add_ends(const Rows& rows) {
    if (rows.empty()) return;
    add(rows.front().t);
    add(rows.back().t);
  }
};

ReplaySpan span_of(const Recording& recording, const Replay& replay) {
  ReplaySpan span;
  for (const ReplayedObject& object : replay.objects) span.add_ends(object.tracked);
  if (replay.teleop) {
    for (const std::vector<ShownPose>& shown : replay.teleop->shown) span.add_ends(shown);
  }
  if (!recording.tool.empty()) {
    span.add(recording.tool.poses().front().stamp.seconds());
    span.add(recording.tool.poses().back().stamp.seconds());
  }
  for (const FrameFiles& frame : recording.frames) span.add(frame.color_stamp.seconds());
  if (span.end < span.start) span = {0.0, 0.0};
  return span;
}

/// The rows of a run for one object.
template <typename Row>
std::vector<Row> of_object(const std::vector<Row>& rows, std::size_t object) {
  std::vector<Row> own;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(own),
               [&](const Row& row) { return row.object == object; });
  return own;
}

Json table_json(const ReplayTable& table) { return {{"at", table.at}, {"rows", table.rows}}; }

Json phases_json(const std::vector<PhaseRow>& phases, double start) {
  Json json = Json::array();
  for (const PhaseRow& row : phases) {
    json.push_back({{"t", row.t - start},
                    {"measured", name_of(row.measured)},
                    {"predicted", name_of(row.predicted)}});
  }
  return json;
}

Json object_json(const Replay& replay, std::size_t i, double start, ReplayTables& tables) {
  const ReplayedObject& object = replay.objects[i];
  const TeleopRun none{};
  const TeleopRun& run = replay.teleop ? *replay.teleop : none;
  const std::vector<ShownPose> shown = replay.teleop ? run.shown[i] : std::vector<ShownPose>();
  const std::vector<PhaseRow> phases = of_object(run.phases, i);
  const std::vector<ReplayTables::Error> errors = replay_errors(shown, object.tracked);
  std::vector<double> keep = times_of_largest(errors);
  for (const PhaseRow& row : phases) keep.push_back(row.t);
  Json json = {{"name", object.name}};
  json["predicted"] = table_json(tables.add_predicted(shown, keep));
  json["tracked"] = table_json(tables.add_tracked(object.tracked));
  json["force"] = table_json(tables.add_force(of_object(run.forces, i)));
  json["error"] = table_json(tables.add_errors(errors));
  json["phases"] = phases_json(phases, start);
  return json;
}

Json corrections_json(const Replay& replay, double start) {
  Json json = Json::array();
  if (!replay.teleop) return json;
  for (const SentCorrection& sent : replay.teleop->corrections) {
    json.push_back({{"t", sent.t - start},
                    {"object", replay.objects[sent.object].name},
                    {"case", name_of(sent.which)},
                    {"what", sent.is_lost ? sent.what + "+lost" : sent.what},
                    {"bytes", sent.bytes}});
  }
  return json;
}

Json frames_json(const Recording& recording, double start) {
  Json times = Json::array();
  const std::optional<CameraModel>& camera = recording.manifest.camera;
  if (camera) {
    for (const FrameFiles& frame : recording.frames) {
      times.push_back(frame.color_stamp.seconds() - start);
    }
  }
  return {
      {"t", times}, {"width", camera ? camera->width : 0}, {"height", camera ? camera->height : 0}};
}

Json replay_json(const Recording& recording, const Replay& replay,
                 const std::optional<JointLog>& arm, ReplaySpan span, ReplayTables& tables) {
  Json json = {{"duration", span.end - span.start}, {"start", span.start}};
  json["delays"] = {{"forward", replay.teleop_options.forward_delay},
                    {"backward", replay.teleop_options.backward_delay}};
  const std::string& parameters = replay.parameters_file;
  json["parameters"] = nullptr;
  if (!parameters.empty() && parameters != "none") json["parameters"] = parameters;
  json["objects"] = Json::array();
  for (std::size_t i = 0; i < replay.objects.size(); ++i) {
    json["objects"].push_back(object_json(replay, i, span.start, tables));
  }
  json["tool"] = table_json(tables.add_tool(recording.tool, recording.wrench));
  json["arm"] = nullptr;
  if (arm) json["arm"] = table_json(tables.add_arm(*arm));
  json["corrections"] = corrections_json(replay, span.start);
  json["frames"] = frames_json(recording, span.start);
  return json;
}

}  // namespace

Expected<ReplayContent> ReplayContent::create(const Recording& recording,
                                              const SceneManifest& scene, const Replay& replay,
                                              const Observer& observer,
                                              const ContentOptions& options) {
  const ReplaySpan span = span_of(recording, replay);
  ReplayTables tables(span.start);
  const Expected<std::optional<JointLog>> arm = read_scene_joints(recording, scene);
  if (!arm) return arm.error();
  const Json json = replay_json(recording, replay, *arm, span, tables);
  ReplayContent content;
  content.json_ = std::make_shared<const Content>(make_content(kJsonMedia, json_text(json)));
  content.bytes_ = std::make_shared<const Content>(make_content(kBinaryMedia, tables.bytes()));
  if (!recording.manifest.camera || recording.frames.empty()) return content;
  Expected<AugmentedFrames> frames = AugmentedFrames::create(recording, scene, replay);
  if (!frames) return frames.error();
  if (frames->placed() == 0) {
    observer.on_warning(
        "the camera's pose is not known in any frame, so nothing is drawn over the images: omit "
        "--tracked to estimate it");
  }
  content.frames_.emplace(std::move(*frames), options.max_cached_frames);
  return content;
}

Expected<std::shared_ptr<const Content>> ReplayContent::find(std::string_view path) const {
  if (path == "/api/replay.json") return json_;
  if (path == "/api/replay.bin") return bytes_;
  if (frames_) return frames_->find(path);
  return std::shared_ptr<const Content>();
}

}  // namespace pcavr
