// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/replay_log.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/base/core/output.hpp"
#include "pcavr/base/core/output_file.hpp"
#include "pcavr/recordings/rosbag/cdr_camera_info.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"

#include "viewer_messages.hpp"

namespace pcavr {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using Json = nlohmann::ordered_json;

constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";
constexpr double kStampRounding = 1e-6;  ///< [s] of times since 1970 as double

bool is_mcap_file(const fs::path& file) {
  std::array<char, kMcapMagic.size()> start{};
  std::ifstream(file, std::ios::binary).read(start.data(), start.size());
  return std::string_view(start.data(), start.size()) == kMcapMagic;
}

OutputFileOptions log_options(bool replace) {
  return {.replace = replace, .kind = "MCAP file", .is_replaceable = is_mcap_file};
}

Bytes json_bytes(const Json& json) {
  const std::string text = json_text(json);
  return {text.begin(), text.end()};
}

/// Messages of a replay, encoded as they are written: their order is that of time, images are not
/// kept in memory.
class ReplayMessages {
 public:
  ReplayMessages(const Recording& recording, const Replay& replay, const ViewerScene& scene,
                 const JointLog* joints, double rate, McapWriter& file)
      : recording_(recording),
        replay_(replay),
        scene_(scene),
        joints_(joints),
        interval_(1.0 / rate),
        file_(file),
        names_(names_of(replay)),
        frames_(topic_parts_of(names_)) {}

  Expected<void> write() {
    add_recording();
    if (joints_) add_joints(*joints_);
    add_tracking();
    if (replay_.teleop) add_run(*replay_.teleop);
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& a, const Message& b) { return a.stamp < b.stamp; });
    const Stamp start = messages_.empty() ? Stamp() : messages_.front().stamp;
    const Expected<void> begun = write_scene(start);
    if (!begun) return begun;
    for (const Message& message : messages_) {
      const Expected<Bytes> bytes = message.encode();
      if (!bytes) return bytes.error();
      const Expected<void> written = file_.write(message.channel, message.stamp, *bytes);
      if (!written) return written;
    }
    return {};
  }

 private:
  struct Message {
    Stamp stamp;
    std::uint16_t channel = 0;
    std::function<Expected<Bytes>()> encode;
  };

  static std::vector<std::string> names_of(const Replay& replay) {
    std::vector<std::string> names;
    for (const ReplayedObject& object : replay.objects) names.push_back(object.name);
    return names;
  }

  std::uint16_t cdr_channel(const std::string& topic, std::string_view type,
                            const std::string& schema) {
    auto known = schemas_.find(type);
    if (known == schemas_.end())
      known = schemas_.emplace(type, file_.add_schema(type, "ros2msg", schema)).first;
    return file_.add_channel(topic, "cdr", known->second);
  }

  std::uint16_t json_channel(const std::string& topic, const Json& properties) {
    const Json schema{{"type", "object"}, {"properties", properties}};
    const std::string name = "pcavr" + topic;
    return file_.add_channel(topic, "json",
                             file_.add_schema(name, "jsonschema", json_text(schema)));
  }

  void add(double t, std::uint16_t channel, std::function<Expected<Bytes>()> encode) {
    messages_.push_back({Stamp::from_seconds(t), channel, std::move(encode)});
  }

  void add_pose(Stamp stamp, std::uint16_t channel, const std::string& frame, const Pose& pose) {
    messages_.push_back({stamp, channel, [=] { return cdr::pose_stamped(stamp, pose); }});
    add_transform(stamp, frame, pose);
  }

  void add_transform(Stamp stamp, const std::string& frame, const Pose& pose) {
    messages_.push_back({stamp, transforms_, [=] {
                           return cdr::tf_message(stamp, {{frame, pose}});
                         }});
  }

  /// What does not change: geometry, and parameters as they are known at the end.
  Expected<void> write_scene(Stamp start) {
    // Without a prediction the bodies are where they were tracked.
    std::vector<std::string> frames = frames_;
    for (std::string& frame : frames) frame += replay_.teleop ? kPredictedFrame : "";
    const auto put = [&](const char* topic, std::string_view type, const std::string& schema,
                         const Bytes& bytes) {
      return file_.write(cdr_channel(topic, type, schema), start, bytes);
    };
    Expected<void> written = put("/scene", cdr::kMarkerArrayType, cdr::marker_array_definition(),
                                 cdr::marker_array(start, scene_markers(scene_, names_, frames)));
    if (!written) return written;
    written = put("/points", cdr::kPointCloudType, cdr::point_cloud_definition(),
                  cdr::point_cloud(start, scene_.points_base));
    if (!written) return written;
    if (!scene_.urdf.empty()) {
      written = put("/robot_description", cdr::kStringType, cdr::string_definition(),
                    cdr::text_message(scene_.urdf));
      if (!written) return written;
    }
    return put("/parameters", cdr::kParametersType, cdr::parameters_definition(),
               cdr::parameters(start, parameter_rows(parameters())));
  }

  [[nodiscard]] ParameterTable parameters() const {
    if (!replay_.teleop) return scene_.parameters;
    ParameterTable table;
    for (std::size_t i = 0; i < std::min(names_.size(), replay_.teleop->parameters.size()); ++i) {
      table[names_[i]] = replay_.teleop->parameters[i];
    }
    return table;
  }

  /// Tool, force and the camera's images.
  void add_recording() {
    transforms_ = cdr_channel("/tf", cdr::kTfMessageType, cdr::tf_message_definition());
    if (!recording_.tool.empty()) {
      const std::uint16_t tool =
          cdr_channel("/tool", cdr::kPoseStampedType, cdr::pose_stamped_definition());
      for (const auto& [stamp, pose] : recording_.tool.poses()) add_pose(stamp, tool, "tool", pose);
    }
    if (!recording_.wrench.empty()) {
      const std::uint16_t wrench =
          cdr_channel("/wrench", cdr::kWrenchStampedType, cdr::wrench_stamped_definition());
      for (const WrenchSample& sample : recording_.wrench) {
        messages_.push_back(
            {sample.stamp, wrench,
             [&sample] { return cdr::wrench_stamped(sample.stamp, sample.force, sample.torque); }});
      }
    }
    if (recording_.manifest.camera && !recording_.frames.empty()) {
      add_images(*recording_.manifest.camera);
    }
  }

  /// As logged, at the rate of what is predicted.
  void add_joints(const JointLog& log) {
    const std::uint16_t channel =
        cdr_channel("/joint_states", cdr::kJointStateType, cdr::joint_state_definition());
    double next = -1.0;
    for (std::size_t row = 0; row < log.stamps.size(); ++row) {
      if (log.t[row] < next) continue;
      next = log.t[row] + interval_ - kStampRounding;
      messages_.push_back(
          {log.stamps[row], channel, [this, &log, row] {
             const Eigen::VectorXd q = log.position.row(static_cast<Eigen::Index>(row));
             return cdr::joint_state(log.stamps[row], scene_.joints,
                                     {q.data(), static_cast<std::size_t>(q.size())});
           }});
    }
  }

  void add_images(const CameraModel& camera) {
    const std::uint16_t images = cdr_channel("/camera/image/compressed", cdr::kCompressedImageType,
                                             cdr::compressed_image_definition());
    const std::uint16_t info =
        cdr_channel("/camera/camera_info", cdr::kCameraInfoType, cdr::camera_info_definition());
    for (const FrameFiles& frame : recording_.frames) {
      messages_.push_back({frame.color_stamp, info, [&frame, camera] {
                             return cdr::camera_info(frame.color_stamp, kCameraFrame, camera);
                           }});
      messages_.push_back({frame.color_stamp, images, [this, &frame] { return image(frame); }});
    }
    for (const auto& [stamp, pose] : replay_.camera_trajectory.poses()) {
      add_transform(stamp, kCameraFrame, pose);
    }
  }

  [[nodiscard]] Expected<Bytes> image(const FrameFiles& frame) const {
    const fs::path path = recording_.folder / frame.color_path;
    const Expected<std::string> file = read_file(path);
    if (!file) return file.error();
    const std::string extension = path.extension().string();
    const std::string_view format = extension == ".png" ? "png" : "jpeg";
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(file->data()), file->size());
    return cdr::compressed_image(frame.color_stamp, kCameraFrame, format, bytes);
  }

  void add_tracking() {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::uint16_t channel = cdr_channel("/tracked/" + frames_[i], cdr::kPoseStampedType,
                                                cdr::pose_stamped_definition());
      for (const TrackedPose& seen : replay_.objects[i].tracked) {
        add_pose(Stamp::from_seconds(seen.t), channel, frames_[i], seen.T_base_object);
      }
    }
  }

  void add_run(const TeleopRun& run) {
    for (std::size_t i = 0; i < std::min(names_.size(), run.shown.size()); ++i) {
      const std::uint16_t channel = cdr_channel("/predicted/" + frames_[i], cdr::kPoseStampedType,
                                                cdr::pose_stamped_definition());
      double next = -1.0;
      for (const ShownPose& shown : run.shown[i]) {
        if (shown.t < next) continue;
        next = shown.t + interval_ - kStampRounding;
        add_pose(Stamp::from_seconds(shown.t), channel, frames_[i] + kPredictedFrame,
                 shown.T_base_object);
      }
    }
    add_forces(run);
    add_phases(run);
    add_corrections(run);
  }

  /// Along the push: a run has no direction of the predicted force.
  void add_forces(const TeleopRun& run) {
    const Json number{{"type", "number"}};
    std::vector<std::uint16_t> channels;
    for (const std::string& frame : frames_) {
      channels.push_back(
          json_channel("/push_force/" + frame, {{"measured", number}, {"predicted", number}}));
    }
    std::vector<double> next(channels.size(), -1.0);
    for (const ForceRow& row : run.forces) {
      if (row.object >= channels.size() || row.t < next[row.object]) continue;
      next[row.object] = row.t + interval_ - kStampRounding;
      add(row.t, channels[row.object], [&row] {
        return json_bytes({{"measured", row.measured}, {"predicted", row.predicted}});
      });
    }
  }

  void add_phases(const TeleopRun& run) {
    const std::uint16_t predicted =
        cdr_channel("/phases", cdr::kPhasesType, cdr::phases_definition());
    const std::uint16_t measured =
        cdr_channel("/measured_phases", cdr::kPhasesType, cdr::phases_definition());
    for (const PhaseRow& row : run.phases) {
      if (row.object >= names_.size()) continue;
      for (const auto& [channel, phase] :
           {std::pair(predicted, row.predicted), std::pair(measured, row.measured)}) {
        const cdr::ObjectPhase one{.object = names_[row.object],
                                   .phase = std::string(name_of(phase))};
        const Stamp stamp = Stamp::from_seconds(row.t);
        add(row.t, channel, [=] { return cdr::phases(stamp, {one}); });
      }
    }
  }

  void add_corrections(const TeleopRun& run) {
    const Json text{{"type", "string"}};
    const std::uint16_t channel = json_channel("/corrections", {{"object", text},
                                                                {"case", text},
                                                                {"what", text},
                                                                {"bytes", {{"type", "number"}}},
                                                                {"lost", {{"type", "boolean"}}}});
    for (const SentCorrection& sent : run.corrections) {
      if (sent.object >= names_.size()) continue;
      add(sent.t, channel, [this, &sent] {
        return json_bytes({{"object", names_[sent.object]},
                           {"case", std::string(name_of(sent.which))},
                           {"what", sent.what},
                           {"bytes", sent.bytes},
                           {"lost", sent.is_lost}});
      });
    }
  }

  const Recording& recording_;
  const Replay& replay_;
  const ViewerScene& scene_;
  const JointLog* joints_;  ///< null: none
  double interval_;         ///< [s]
  McapWriter& file_;
  std::vector<std::string> names_;
  std::vector<std::string> frames_;  ///< of the objects, in characters of topics
  std::map<std::string_view, std::uint16_t> schemas_;
  std::vector<Message> messages_;
  std::uint16_t transforms_ = 0;
};

}  // namespace

Expected<void> check_replay_log(const fs::path& file, bool replace) {
  if (file.extension() != ".mcap") {
    return Error{.message = "is not the name of an MCAP file",
                 .file = file.string(),
                 .hint = "use the extension .mcap"};
  }
  return OutputFile::check(file, log_options(replace));
}

Expected<std::uint64_t> write_replay_log(const fs::path& file, const Recording& recording,
                                         const Replay& replay, const ViewerScene& scene,
                                         const ReplayLogOptions& options,
                                         const std::optional<JointLog>& joints) {
  Expected<OutputFile> output = OutputFile::create(file, log_options(options.replace));
  if (!output) return output.error();
  McapWriterOptions format;
  format.profile = "ros2";
  format.replace = true;        // the output's own empty file
  format.flush_interval = 1e9;  // chunks by size alone: the same bytes at each run
  Expected<McapWriter> writer = McapWriter::create(output->path(), format);
  if (!writer) return writer.error();
  const Expected<void> written =
      ReplayMessages(recording, replay, scene, joints ? &*joints : nullptr, options.rate, *writer)
          .write();
  if (!written) return written.error();
  const Expected<void> closed = writer->close();
  if (!closed) return closed.error();
  const Expected<void> committed = output->commit();
  if (!committed) return committed.error();
  return writer->message_count();
}

}  // namespace pcavr
