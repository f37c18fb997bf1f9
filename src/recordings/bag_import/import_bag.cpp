// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/recordings/bag_import/import_bag.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "pcavr/base/core/check.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/recordings/bag_import/camera_images.hpp"
#include "pcavr/recordings/recording/depth_units.hpp"
#include "pcavr/recordings/recording/manifest_template.hpp"
#include "pcavr/recordings/recording/recording_writer.hpp"

#include "recordings/bag_import/bag_streams.hpp"
#include "recordings/bag_import/frame_import.hpp"
#include "recordings/bag_import/import_checks.hpp"
#include "recordings/bag_import/series_import.hpp"

namespace pcavr {
namespace fs = std::filesystem;
namespace {

constexpr double kMillimetreScale = 1000.0;  // [units/m] of 16UC1
constexpr double kMetricScale = 5000.0;      // [units/m] for depth in metres: 0.2 mm up to 13 m

/// Frames by which a recorder's base is known, unlike the root of a camera's own tree.
bool may_place_camera(const BagSelection& selection) {
  return !selection.base_frame.empty() &&
         (selection.is_base_frame_given ||
          selection.base_frame.find("camera") == std::string::npos);
}

bool is_rectified(const SurveyedTopic& topic) {
  return topic.topic.name.find("rect") != std::string::npos;
}

/// The poses, each with its stamp as `row_of` changes it.
template <typename RowOf>
Trajectory changed(const Trajectory& poses, const RowOf& row_of) {
  std::vector<TimedPose> rows;
  rows.reserve(poses.size());
  for (const TimedPose& row : poses.poses()) rows.push_back(row_of(row));
  return Trajectory(std::move(rows));
}

Trajectory delayed(const Trajectory& poses, double seconds) {
  const Duration shift{static_cast<std::int64_t>(std::llround(1e9 * seconds))};
  return changed(poses, [shift](const TimedPose& row) {
    return TimedPose{row.stamp + shift, row.pose};
  });
}

/// Poses of the tool or of a body, as poses of a frame that is fixed to it.
Trajectory at_frame(const Trajectory& poses, const Pose& T_body_frame) {
  return changed(poses, [&](const TimedPose& row) {
    return TimedPose{row.stamp, row.pose * T_body_frame};
  });
}

/// One import: what its steps share.
class BagImport {
 public:
  BagImport(const fs::path& bag, const fs::path& target, const BagImportOptions& options,
            const Observer& observer)
      : bag_(bag), target_(target), options_(options), observer_(observer) {}

  Expected<BagImportReport> run() {
    const Expected<StampRule> collected = collect();
    if (!collected) return collected.error();
    const StampRule& stamps = *collected;
    if (const auto done = prepare_camera(); !done) return done.error();
    const SeriesImporter importer(bag_, selection_, options_, streams_, stamps, observer_);
    if (const auto done = read_series(importer); !done) return done.error();
    if (const auto placed = place_world(); !placed) return placed.error();
    if (selection_.depth == nullptr) state_first_poses();
    RecordingWriter writer(target_, manifest_);
    if (const auto done = write_series(importer, writer); !done) return done.error();
    if (const auto done = write_frames(importer, stamps, writer); !done) return done.error();
    const auto copied = copy_manifest_files(manifest_, options_.manifest.parent_path(), target_);
    if (!copied) return copied.error();
    if (const auto done = writer.finish(); !done) return done.error();
    return std::move(report_);
  }

  /// The time series alone, objects in their world frame.
  Expected<void> read_push() {
    const Expected<StampRule> stamps = collect();
    if (!stamps) return stamps.error();
    return read_series(SeriesImporter(bag_, selection_, options_, streams_, *stamps, observer_));
  }
  /// The push of the first object; its poses are empty where there is no object.
  [[nodiscard]] PushSeries push() const {
    static const Trajectory kNone;
    return {tool_.content, wrench_.content, objects_.empty() ? kNone : objects_.front().content};
  }

 private:
  Expected<StampRule> collect() {
    if (const auto done = prepare(); !done) return done.error();
    const StampRule stamps(survey_, selection_, options_.use_receive_stamps);
    report_other_clocks(stamps);
    Expected<BagStreams> streams = collect_streams(bag_, selection_, survey_, stamps, observer_);
    if (!streams) return streams.error();
    streams_ = *std::move(streams);
    if (const auto checked = check_spans(bag_, streams_); !checked) return checked.error();
    for (const std::string& frame : streams_.frames.reparented()) {
      warn("frame '" + frame + "' has several parents in TF; the first is used");
    }
    for (const auto& [frame, values] : streams_.frames.replaced()) {
      warn("frame '" + frame + "' " + replacement_text(values, stamps.arrival_of(survey_.first)));
    }
    return stamps;
  }

  void warn(const std::string& text) const { observer_.on_warning(bag_.string() + ": " + text); }

  /// Does all checks that are possible before the bag is read again.
  Expected<void> prepare() {
    Expected<BagSurvey> survey = survey_bag(bag_, observer_, options_.csv);
    if (!survey) return survey.error();
    survey_ = *std::move(survey);
    for (const std::string& warning : survey_.warnings) observer_.on_warning(warning);
    if (survey_.messages == 0) {
      return Error{.message = "has no messages", .file = bag_.string(), .hint = "record again"};
    }
    Expected<Manifest> manifest = read_manifest_template(options_.manifest);
    if (!manifest) return manifest.error();
    manifest_ = *std::move(manifest);
    BagTopicOptions topics = options_.topics;
    for (const ObjectEntry& object : manifest_.objects) topics.object_names.insert(object.name);
    Expected<BagSelection> selection = select_bag_topics(bag_, survey_, topics);
    if (!selection) return selection.error();
    selection_ = *std::move(selection);
    if (selection_.is_empty(options_.topics)) {
      return Error{.message = "has no topic to import",
                   .file = bag_.string(),
                   .hint = selection_.notes.empty()
                               ? "'pcavr inspect' lists its topics; depth, poses, forces and joint "
                                 "states are imported"
                               : selection_.notes.front()};
    }
    if (const auto declared = declare_objects(selection_, manifest_); !declared) return declared;
    report_.notes = selection_.notes;
    report_.base_frame = selection_.base_frame;
    report_.messages = survey_.messages;
    report_.duration = to_seconds(survey_.last - survey_.first);
    return {};
  }

  void report_other_clocks(const StampRule& stamps) const {
    for (const SurveyedTopic* topic : stamps.outliers()) {
      warn(topic->topic.name +
           ": its header stamps are on another clock than the recorder's; log times "
           "are used");
    }
  }

  /// The camera of the options or of the bag, for the size of the colour images.
  Expected<void> prepare_camera() {
    if (selection_.images() == nullptr) return {};
    if (options_.camera) {
      manifest_.camera = options_.camera;
    } else if (!streams_.camera_info) {
      if (may_leave_out_color("no camera info")) return {};
      return Error{.message = "has no camera info for " + selection_.images()->topic.name,
                   .file = bag_.string(),
                   .hint = "give --camera-info-topic, or --camera with a calibration file"};
    } else {
      const SurveyedTopic& image =
          selection_.color != nullptr ? *selection_.color : *selection_.depth;
      Expected<CameraModel> camera =
          camera_of(*streams_.camera_info, is_rectified(image), {image.width, image.height});
      if (!camera) {
        if (may_leave_out_color("a camera info that is not valid: " + camera.error().message)) {
          return {};
        }
        Error error = camera.error();
        error.file = bag_.string();
        error.place = selection_.camera_info->topic.name;
        return error;
      }
      manifest_.camera = *camera;
    }
    const bool is_metric =
        selection_.depth != nullptr && is_metric_depth(selection_.depth->image_format);
    depth_units_ = is_metric ? options_.depth_scale.value_or(kMetricScale)
                             : options_.raw_depth_scale.value_or(kMillimetreScale);
    const auto& asked_for = is_metric ? options_.depth_scale : options_.raw_depth_scale;
    if (asked_for) manifest_.depth_scale = 0.0;  // a template's is of other images
    if (state_depth_units(depth_units_, manifest_)) {
      warn("the depth's offset in " + options_.manifest.string() +
           " is left out: its depth_scale is not that of these images");
    }
    for (const std::string& doubt : color_doubts(selection_, streams_)) warn(doubt);
    return {};
  }

  /// Colour alone that nobody named, and whose camera is not known, is left out, with a note: the
  /// series are imported without it.
  bool may_leave_out_color(const std::string& reason) {
    const bool has_others = selection_.tool != nullptr || selection_.wrench != nullptr ||
                            selection_.joints != nullptr || !selection_.objects.empty() ||
                            !options_.topics.tool_frame.empty();
    if (selection_.depth != nullptr || !options_.topics.color_topic.empty() || !has_others) {
      return false;
    }
    report_.notes.push_back(selection_.color->topic.name + " has " + reason +
                            "; give --camera with a calibration file");
    selection_.color = nullptr;
    return true;
  }

  Expected<void> read_series(const SeriesImporter& importer) {
    Expected<ImportedSeries<Trajectory>> tool = tip_series(importer);
    if (!tool) return tool.error();
    tool_ = *std::move(tool);
    if (selection_.wrench != nullptr) {
      auto wrench = importer.wrench(tool_.content);
      if (!wrench) return wrench.error();
      wrench_ = *std::move(wrench);
    }
    const auto checked = check_placed_objects(bag_, selection_, options_.T_tracked_object);
    if (!checked) return checked;
    for (const auto& [name, topic] : selection_.objects) {
      auto poses = importer.poses(*topic, object_file(name).string());
      if (!poses) return poses.error();
      const auto placed = options_.T_tracked_object.find(name);
      if (placed != options_.T_tracked_object.end()) {
        poses->content = at_frame(poses->content, placed->second);
      }
      objects_.push_back(*std::move(poses));
    }
    return {};
  }

  /// Writes the first poses into the manifest: without images nothing else says where a body
  /// starts.
  void state_first_poses() {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      if (objects_[i].content.empty()) continue;
      for (ObjectEntry& entry : manifest_.objects) {
        const bool is_it = entry.name == selection_.objects[i].first && !entry.mesh.empty();
        if (is_it && !entry.T_base_object) {
          entry.T_base_object = objects_[i].content.poses().front().pose;
        }
      }
    }
  }

  Expected<void> write_series(const SeriesImporter& importer, RecordingWriter& writer) {
    if (!tool_.content.empty()) {
      if (auto written = writer.write_tool(tool_.content); !written) return written;
    }
    add_stream(tool_.stream);
    if (selection_.wrench != nullptr) {
      if (auto written = writer.write_wrench(wrench_.content); !written) return written;
      add_stream(wrench_.stream);
    }
    if (const auto written = write_joints(importer, writer); !written) return written;
    for (const ImportedSeries<Trajectory>& object : objects_) {
      if (const auto written = write_object(object); !written) return written;
    }
    return {};
  }

  Expected<void> write_joints(const SeriesImporter& importer, RecordingWriter& writer) {
    if (selection_.joints == nullptr) return {};
    const auto joints = importer.joints();
    if (!joints) return joints.error();
    if (joints->stream.rows > 0) {
      if (auto written = writer.write_joints(joints->content); !written) return written;
    }
    add_stream(joints->stream);
    return {};
  }

  /// Takes the objects' poses from their world frame, given or found, to base, and the tool's to
  /// the tracker's clock.
  Expected<void> place_world() {
    std::optional<Pose> T_base_world = options_.T_base_world;
    double tool_delay = options_.tool_delay;
    if (options_.pushed_sides && !objects_.empty()) {
      const Expected<WorldPlacement> found = find_world();
      if (!found) return found.error();
      T_base_world = found->T_base_world;
      tool_delay = found->tool_delay;
      report_.world = *found;
    }
    tool_.content = delayed(tool_.content, -tool_delay);
    if (!T_base_world) return {};
    for (ImportedSeries<Trajectory>& object : objects_) {
      object.content = changed(object.content, [&](const TimedPose& row) {
        return TimedPose{row.stamp, *T_base_world * row.pose};
      });
      object.stream.frame = "world, placed in base";
    }
    return {};
  }

  [[nodiscard]] Expected<WorldPlacement> find_world() const {
    std::vector<std::unique_ptr<BagImport>> others;  // of which the series stay in place
    std::vector<PushSeries> pushes{push()};
    for (const fs::path& bag : options_.world_bags) {
      others.push_back(std::make_unique<BagImport>(bag, target_, options_, observer_));
      if (const auto done = others.back()->read_push(); !done) return done.error();
      pushes.push_back(others.back()->push());
    }
    Expected<WorldPlacement> found = pcavr::find_world(pushes, *options_.pushed_sides);
    if (found) return found;
    Error error = found.error();
    error.file = bag_.string();
    return error;
  }

  /// The poses of the tip, computed from its place in the tool's frame.
  Expected<ImportedSeries<Trajectory>> tip_series(const SeriesImporter& importer) const {
    Expected<ImportedSeries<Trajectory>> tool = tool_series(importer);
    if (!tool || options_.p_tool_tip.isZero(0.0)) return tool;
    tool->content = at_frame(tool->content, Pose::from_translation(options_.p_tool_tip));
    return tool;
  }

  Expected<ImportedSeries<Trajectory>> tool_series(const SeriesImporter& importer) const {
    if (selection_.tool != nullptr) {
      const auto& rows = streams_.poses.at(selection_.tool).rows;
      if (!rows.empty() && !rows.front().value.has_orientation) {
        warn(selection_.tool->topic.name +
             ": points have no orientation; the tool keeps that of the base");
      }
      return importer.poses(*selection_.tool, "tool.csv");
    }
    if (options_.topics.tool_frame.empty()) return ImportedSeries<Trajectory>{};
    const std::string frame = frame_name(options_.topics.tool_frame);
    auto series = importer.frame(frame, "tool.csv", {});
    if (series && series->content.empty()) {  // all links are fixed
      series = importer.frame(frame, "tool.csv", {survey_.first, survey_.last});
    }
    if (!series) return series;
    if (const auto checked = check_span(bag_, frame, series->content); !checked) {
      return checked.error();
    }
    return series;
  }

  static fs::path object_file(const std::string& name) {
    return fs::path("tracked") / "objects" / name / "tracked.txt";
  }

  Expected<void> write_object(const ImportedSeries<Trajectory>& object) {
    const fs::path file = target_ / object.stream.file;
    std::error_code code;
    fs::create_directories(file.parent_path(), code);
    if (auto written = write_file(file, format_trajectory(object.content)); !written) {
      return written;
    }
    add_stream(object.stream);
    return {};
  }

  Expected<void> write_frames(const SeriesImporter& importer, const StampRule& stamps,
                              RecordingWriter& writer) {
    if (selection_.images() == nullptr) return {};
    const SurveyedTopic& images = *selection_.images();
    const std::vector<FramePlan> plan = plan_frames(streams_, options_);
    if (plan.empty()) {
      return Error{.message = "has no depth and colour images that are at most 20 ms apart",
                   .file = bag_.string(),
                   .hint = "choose other topics, or a smaller --first"};
    }
    const auto counts = import_frames(bag_, selection_, stamps, plan, *manifest_.camera,
                                      depth_units_, writer, observer_);
    if (!counts) return counts.error();
    if (counts->frames == 0) {
      return Error{.message = "no frame can be imported: " + counts->left_out_reason,
                   .file = bag_.string(),
                   .place = images.topic.name,
                   .hint =
                       "record depth that is registered to colour, or import depth alone with "
                       "--colour-topic none"};
    }
    const bool has_depth = selection_.depth != nullptr;
    ImportedStream stream{.file = has_depth ? "rgb, depth" : "rgb", .topic = images.topic.name};
    if (has_depth && selection_.color != nullptr) {
      stream.topic += ", " + selection_.color->topic.name;
    }
    stream.rows = counts->frames;
    stream.left_out = counts->left_out;
    stream.left_out_reason = counts->left_out_reason;
    stream.delay = images.delay;
    stream.has_receive_stamps = stamps.uses_log_time(images);
    stream.frame = joined(images.frames);
    add_stream(stream);
    return write_camera_poses(importer, plan, writer);
  }

  /// Writes the camera poses of their topic, or those of TF at the stamps of the images.
  Expected<void> write_camera_poses(const SeriesImporter& importer,
                                    const std::vector<FramePlan>& plan, RecordingWriter& writer) {
    const std::vector<std::string>& frames = selection_.images()->frames;
    const std::string frame = frames.empty() ? "" : frames.front();
    const bool is_in_tf = may_place_camera(selection_) && !frame.empty() &&
                          streams_.frames.chain(selection_.base_frame, frame).has_value();
    if (selection_.camera_pose == nullptr && !is_in_tf) return {};
    std::vector<Stamp> at;
    for (const FramePlan& images : plan) at.insert(at.end(), {images.depth, images.color});
    std::sort(at.begin(), at.end());
    at.erase(std::unique(at.begin(), at.end()), at.end());
    const auto poses = selection_.camera_pose != nullptr
                           ? importer.poses(*selection_.camera_pose, "groundtruth.txt")
                           : importer.frame(frame, "groundtruth.txt", at);
    if (!poses) return poses.error();
    add_stream(poses->stream);
    if (poses->content.empty()) return {};
    return writer.write_groundtruth(poses->content);
  }

  void add_stream(const ImportedStream& stream) {
    if (!stream.file.empty()) report_.streams.push_back(stream);
  }

  const fs::path& bag_;
  const fs::path& target_;
  const BagImportOptions& options_;
  const Observer& observer_;
  BagSurvey survey_;
  BagSelection selection_;  ///< points into survey_
  BagStreams streams_;
  Manifest manifest_;
  double depth_units_ = 0.0;  ///< [units/m] of the images that are written, before a calibration
  ImportedSeries<Trajectory> tool_ = {};
  ImportedSeries<std::vector<WrenchSample>> wrench_ = {};
  std::vector<ImportedSeries<Trajectory>> objects_;  ///< as selection_.objects
  BagImportReport report_;
};

}  // namespace

Expected<BagImportReport> import_bag(const fs::path& bag, const fs::path& target,
                                     const BagImportOptions& options, const Observer& observer) {
  PCAVR_REQUIRE(options.stride >= 1, options.stride);
  return BagImport(bag, target, options, observer).run();
}

}  // namespace pcavr
