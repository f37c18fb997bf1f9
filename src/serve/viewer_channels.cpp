// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "viewer_channels.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/recordings/rosbag/cdr_camera_info.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"

#include "viewer_messages.hpp"

namespace pcavr {
namespace {

using Bytes = std::vector<std::uint8_t>;

Pose pose_of(const LinkTrackedObject& object) {
  return {object.orientation.cast<double>().normalized(), object.position.cast<double>()};
}

/// The robot's state at an operator's site that has one; else null.
const LinkState* robot_in(const WorldSnapshot& snapshot) {
  return snapshot.link && snapshot.link->robot ? &*snapshot.link->robot : nullptr;
}

Pose tool_pose(const Eigen::Vector3d& tip) { return {Eigen::Quaterniond::Identity(), tip}; }

}  // namespace

ViewerChannels::ViewerChannels(PageWorld& world, const ContentSource& content, ViewerScene scene)
    : world_(world),
      content_(content),
      scene_(std::move(scene)),
      frames_(topic_parts_of(world.names())) {
  add_scene();
  add_motion();
  if (world_.is_remote()) add_link();
  add_state();
}

const ViewerChannels::Channel* ViewerChannels::find(std::uint64_t id) const {
  return id >= 1 && id <= channels_.size() ? &channels_[id - 1] : nullptr;
}

void ViewerChannels::add(std::string topic, std::string_view schema_name, std::string schema,
                         Rate rate, Encode encode) {
  const auto id = static_cast<std::uint32_t>(channels_.size() + 1);
  channels_.push_back({id, std::move(topic), schema_name, std::move(schema), rate});
  sources_.push_back({.encode = std::move(encode)});
}

void ViewerChannels::add_scene() {
  add("/scene", cdr::kMarkerArrayType, cdr::marker_array_definition(), Rate::once,
      [this](const WorldSnapshot&) {
        std::vector<std::string> frames;
        for (const std::string& frame : frames_) frames.push_back(frame + kPredictedFrame);
        return cdr::marker_array(stamp_, scene_markers(scene_, world_.names(), frames));
      });
  add("/points", cdr::kPointCloudType, cdr::point_cloud_definition(), Rate::once,
      [this](const WorldSnapshot&) { return cdr::point_cloud(stamp_, scene_.points_base); });
  add("/parameters", cdr::kParametersType, cdr::parameters_definition(), Rate::once,
      [this](const WorldSnapshot&) { return encode_parameters(); });
  if (scene_.urdf.empty()) return;
  add("/robot_description", cdr::kStringType, cdr::string_definition(), Rate::once,
      [this](const WorldSnapshot&) { return cdr::text_message(scene_.urdf); });
  add("/joint_states", cdr::kJointStateType, cdr::joint_state_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        if (!snapshot.arm) return Bytes();
        const Eigen::VectorXd& q = snapshot.arm->q;
        return cdr::joint_state(stamp_, scene_.joints,
                                {q.data(), static_cast<std::size_t>(q.size())});
      });
}

void ViewerChannels::add_motion() {
  const std::string pose = cdr::pose_stamped_definition();
  const std::string wrench = cdr::wrench_stamped_definition();
  add("/tf", cdr::kTfMessageType, cdr::tf_message_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) { return encode_transforms(snapshot); });
  add("/command", cdr::kPoseStampedType, pose, Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        return cdr::pose_stamped(stamp_, tool_pose(snapshot.world.p_base_hip));
      });
  add("/predicted_tool", cdr::kPoseStampedType, pose, Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        return cdr::pose_stamped(stamp_, tool_pose(snapshot.world.p_base_proxy));
      });
  add("/hand_force", cdr::kWrenchStampedType, wrench, Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        return cdr::wrench_stamped(stamp_, snapshot.world.force_base, Eigen::Vector3d::Zero());
      });
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    add("/predicted/" + frames_[i], cdr::kPoseStampedType, pose, Rate::changed,
        [this, i](const WorldSnapshot& snapshot) {
          return cdr::pose_stamped(stamp_, snapshot.world.bodies.at(i).T_base_object);
        });
    add("/predicted_force/" + frames_[i], cdr::kWrenchStampedType, wrench, Rate::changed,
        [this, i](const WorldSnapshot& snapshot) {
          return cdr::wrench_stamped(stamp_, snapshot.world.bodies.at(i).tool_force_base,
                                     Eigen::Vector3d::Zero());
        });
  }
}

void ViewerChannels::add_link() {
  add("/tool", cdr::kPoseStampedType, cdr::pose_stamped_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        const LinkState* robot = robot_in(snapshot);
        if (robot == nullptr) return Bytes();
        return cdr::pose_stamped(stamp_, {robot->q_base_tool.cast<double>().normalized(),
                                          robot->p_base_tip.cast<double>()});
      });
  add("/wrench", cdr::kWrenchStampedType, cdr::wrench_stamped_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) {
        const LinkState* robot = robot_in(snapshot);
        if (robot == nullptr) return Bytes();
        return cdr::wrench_stamped(stamp_, robot->force_base.cast<double>(),
                                   robot->torque_base.cast<double>());
      });
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    add("/tracked/" + frames_[i], cdr::kPoseStampedType, cdr::pose_stamped_definition(),
        Rate::changed, [this, i](const WorldSnapshot& snapshot) {
          const LinkState* robot = robot_in(snapshot);
          if (robot == nullptr || i >= robot->objects.size() || !robot->objects[i].is_tracked) {
            return Bytes();
          }
          // Stamp of the frame that shows the object.
          const Stamp seen = stamp_ + duration_from_seconds(-double{robot->objects[i].age});
          return cdr::pose_stamped(seen, pose_of(robot->objects[i]));
        });
  }
  add("/camera/image/compressed", cdr::kCompressedImageType, cdr::compressed_image_definition(),
      Rate::changed, [this](const WorldSnapshot& snapshot) { return encode_picture(snapshot); });
  add("/camera/camera_info", cdr::kCameraInfoType, cdr::camera_info_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) { return encode_camera(snapshot); });
}

void ViewerChannels::add_state() {
  add("/phases", cdr::kPhasesType, cdr::phases_definition(), Rate::changed,
      [this](const WorldSnapshot& snapshot) { return encode_phases(snapshot); });
  add("/diagnostics", cdr::kDiagnosticArrayType, cdr::diagnostic_array_definition(), Rate::slow,
      [this](const WorldSnapshot& snapshot) { return encode_diagnostics(snapshot); });
}

Bytes ViewerChannels::encode_transforms(const WorldSnapshot& snapshot) const {
  std::vector<cdr::Transform> transforms;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    transforms.push_back({frames_[i] + kPredictedFrame, snapshot.world.bodies.at(i).T_base_object});
  }
  transforms.push_back({"command", tool_pose(snapshot.world.p_base_hip)});
  const LinkState* robot = robot_in(snapshot);
  if (robot == nullptr) return cdr::tf_message(stamp_, transforms);
  transforms.push_back(
      {"tool", {robot->q_base_tool.cast<double>().normalized(), robot->p_base_tip.cast<double>()}});
  for (std::size_t i = 0; i < std::min(frames_.size(), robot->objects.size()); ++i) {
    if (!robot->objects[i].is_tracked) continue;
    transforms.push_back({frames_[i], pose_of(robot->objects[i])});
  }
  return cdr::tf_message(stamp_, transforms);
}

Bytes ViewerChannels::encode_parameters() const {
  return cdr::parameters(stamp_, parameter_rows(scene_.parameters));
}

Bytes ViewerChannels::encode_phases(const WorldSnapshot& snapshot) const {
  std::vector<cdr::ObjectPhase> objects;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const HapticBodyState& body = snapshot.world.bodies.at(i);
    objects.push_back({world_.names()[i], std::string(name_of(body.phase)), body.is_outside_model,
                       body.is_blocked, body.is_saturated});
  }
  return cdr::phases(stamp_, objects);
}

Bytes ViewerChannels::encode_diagnostics(const WorldSnapshot& snapshot) const {
  using Level = cdr::Diagnostic::Level;
  const bool is_held = snapshot.is_stopped || snapshot.is_on_hold;
  std::vector<cdr::Diagnostic> all;
  all.push_back({.level = is_held ? Level::warning : Level::ok,
                 .name = "world",
                 .message = snapshot.is_stopped   ? "emergency stop"
                            : snapshot.is_on_hold ? "on hold"
                                                  : "running",
                 .values = {{"cycles", std::to_string(snapshot.cycles)},
                            {"late_cycles", std::to_string(snapshot.late_cycles)},
                            {"cycle_p99_s", fmt::format("{:.6f}", snapshot.times.p99)},
                            {"cycle_longest_s", fmt::format("{:.6f}", snapshot.times.longest)},
                            {"time_scale", fmt::format("{:.3g}", snapshot.time_scale)}}});
  if (!snapshot.link) return cdr::diagnostic_array(stamp_, all);
  const LinkSnapshot& link = *snapshot.link;
  all.push_back({.level = link.is_connected ? Level::ok : Level::error,
                 .name = "link",
                 .message = link.is_connected ? "connected" : "no link to the robot's site",
                 .values = {{"silence_s", fmt::format("{:.3f}", link.silence)},
                            {"lead_s", fmt::format("{:.3f}", link.lead)},
                            {"round_trip_s", fmt::format("{:.4f}", link.round_trip)},
                            {"clock_std_s", fmt::format("{:.6f}", link.clock_std)}}});
  return cdr::diagnostic_array(stamp_, all);
}

Bytes ViewerChannels::encode_picture(const WorldSnapshot& snapshot) {
  if (!snapshot.link || snapshot.link->picture == picture_) return {};
  const std::uint32_t number = snapshot.link->picture;
  const Expected<std::shared_ptr<const Content>> found =
      content_.find("/api/robot/" + std::to_string(number) + ".jpg");
  if (!found || !*found || (*found)->is_gzipped) return {};
  picture_ = number;
  const std::string& body = (*found)->body;
  const std::span bytes(reinterpret_cast<const std::uint8_t*>(body.data()), body.size());
  return cdr::compressed_image(taken(*snapshot.link), kCameraFrame, "jpeg", bytes);
}

Stamp ViewerChannels::taken(const LinkSnapshot& link) const {
  return stamp_ + duration_from_seconds(-link.picture_age);
}

Bytes ViewerChannels::encode_camera(const WorldSnapshot& snapshot) {
  if (!snapshot.link || !snapshot.link->picture_camera) return {};
  const LinkSnapshot& link = *snapshot.link;
  if (link.picture == described_picture_) return {};
  described_picture_ = link.picture;
  const LinkPictureCamera& known = *link.picture_camera;
  if (known.lens != lens_.model() || known.coefficients != coefficients_) {
    coefficients_ = known.coefficients;
    const std::vector<double> values(known.coefficients.begin(), known.coefficients.end());
    lens_ = LensDistortion(known.lens, std::span(values).first(coefficient_count(known.lens)));
  }
  return cdr::camera_info(taken(link), kCameraFrame,
                          {.width = link.picture_width,
                           .height = link.picture_height,
                           .fx = double{known.fx},
                           .fy = double{known.fy},
                           .cx = double{known.cx},
                           .cy = double{known.cy},
                           .distortion = lens_});
}

void ViewerChannels::update(double now) {
  ++updates_;
  const auto system = std::chrono::system_clock::now().time_since_epoch();
  clock_start_ = Stamp{std::chrono::duration_cast<std::chrono::nanoseconds>(system).count()} +
                 duration_from_seconds(-now);
}

ViewerPayload ViewerChannels::payload(const Channel& channel) {
  Source& source = sources_.at(channel.id - 1);
  const bool is_new = source.update != updates_;
  if (source.newest && (channel.rate == Rate::once || !is_new)) return source.newest;
  if (!is_new) return nullptr;
  source.update = updates_;
  const WorldSnapshot& snapshot = world_.newest();
  stamp_ = clock_start_ + duration_from_seconds(snapshot.published);
  Bytes bytes = source.encode(snapshot);
  source.newest = bytes.empty() ? nullptr : std::make_shared<const Bytes>(std::move(bytes));
  return source.newest;
}

}  // namespace pcavr
