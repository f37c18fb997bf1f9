// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "black_box_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/json_text.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {
namespace {

constexpr double kStatusInterval = 1.0;       // [s] between two that say the same
constexpr double kMinFrameInterval = 1e-3;    // [s] less is the rounding of a frame's age
constexpr std::size_t kMaxReceived = 10'000;  // corrections that wait to be applied

constexpr std::array<std::pair<LinkLimit, const char*>, 5> kLimits{
    {{LinkLimit::workspace, "workspace"},
     {LinkLimit::step, "step"},
     {LinkLimit::speed, "speed"},
     {LinkLimit::acceleration, "acceleration"},
     {LinkLimit::force, "force"}}};

template <typename T>
std::optional<T> read_plain(std::span<const std::uint8_t> bytes, std::size_t at = 0) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (bytes.size() < at + sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

Pose pose_of(const std::array<double, 7>& v) {
  return {Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized(), {v[0], v[1], v[2]}};
}

Pose pose_of(const Eigen::Vector3f& p, const Eigen::Quaternionf& q) {
  return {q.cast<double>().normalized(), p.cast<double>()};
}

const char* name_of_stop(LinkStop stop) {
  switch (stop) {
    case LinkStop::hold:
      return "hold";
    case LinkStop::resume:
      return "resume";
    case LinkStop::emergency_stop:
      return "emergency stop";
    case LinkStop::reset:
      return "release of the emergency stop";
  }
  return "";
}

std::string hex(const std::vector<std::uint8_t>& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

}  // namespace

BlackBoxWriter::BlackBoxWriter(McapWriter file, SiteScene scene, double display_rate)
    : file_(std::move(file)), scene_(std::move(scene)), display_interval_(1.0 / display_rate) {
  const std::vector<std::string> frames = topic_parts_of(scene_.objects);
  for (std::size_t i = 0; i < scene_.objects.size(); ++i) {
    Object object{.name = scene_.objects[i], .T_base_start = {}, .frame = {}};
    if (i < scene_.T_base_objects.size()) object.T_base_start = scene_.T_base_objects[i];
    object.frame = frames[i];
    objects_.push_back(std::move(object));
  }
  add_topics();
}

void BlackBoxWriter::add_topics() {
  const std::uint16_t pose =
      file_.add_schema(cdr::kPoseStampedType, "ros2msg", cdr::pose_stamped_definition());
  const std::uint16_t wrench =
      file_.add_schema(cdr::kWrenchStampedType, "ros2msg", cdr::wrench_stamped_definition());
  const std::uint16_t tf =
      file_.add_schema(cdr::kTfMessageType, "ros2msg", cdr::tf_message_definition());
  command_ = file_.add_channel("/command", "cdr", pose);
  tool_ = file_.add_channel("/tool", "cdr", pose);
  wrench_ = file_.add_channel("/wrench", "cdr", wrench);
  transforms_ = file_.add_channel("/tf", "cdr", tf);
  for (Object& object : objects_) {
    object.tracked = file_.add_channel("/tracked/" + object.frame, "cdr", pose);
    object.predicted = file_.add_channel("/predicted/" + object.frame, "cdr", pose);
    object.force = file_.add_channel("/predicted_force/" + object.frame, "cdr", wrench);
  }
  const Json number{{"type", "number"}}, text{{"type", "string"}}, flag{{"type", "boolean"}};
  corrections_ = add_json("/corrections", {{"action", text},
                                           {"number", number},
                                           {"time", number},
                                           {"object", text},
                                           {"case", text},
                                           {"what", text},
                                           {"data", text}});
  events_ = add_json("/events", {{"level", text}, {"text", text}});
  phases_ =
      add_json("/phases", {{"object", text}, {"site", text}, {"phase", text}, {"time", number}});
  status_ = add_json("/status", {{"engaged", flag},
                                 {"on_hold", flag},
                                 {"stopped", flag},
                                 {"limits", {{"type", "array"}, {"items", text}}},
                                 {"discarded_commands", number},
                                 {"corrections", number}});
  delays_ = add_json("/delays", {{"sent", number},
                                 {"received", number},
                                 {"applied", number},
                                 {"sensed", number},
                                 {"sent_back", number},
                                 {"received_back", number},
                                 {"stages", {{"type", "object"}}}});
  link_ = add_json("/link", {{"clock_offset", number},
                             {"clock_std", number},
                             {"round_trip", number},
                             {"delay_variation", number},
                             {"lead", number}});
  session_ = add_json("/session", {{"message", text},
                                   {"direction", text},
                                   {"text", text},
                                   {"time", number},
                                   {"correction_delay", number}});
}

std::uint16_t BlackBoxWriter::add_json(const char* topic, const Json& properties) {
  const Json schema{{"type", "object"}, {"properties", properties}};
  const std::string name = "pcavr" + std::string(topic);
  return file_.add_channel(topic, "json", file_.add_schema(name, "jsonschema", json_text(schema)));
}

void BlackBoxWriter::write(std::span<const std::uint8_t> record) {
  const auto head = read_plain<RecordHead>(record);
  if (!head || error_) return;
  last_ = head->t;
  const std::span<const std::uint8_t> body = record.subspan(sizeof(RecordHead));
  switch (head->kind) {
    case RecordKind::start:
      start_ = read_plain<std::int64_t>(body).value_or(0);
      t_start_ = head->t;
      return;
    case RecordKind::sent:
    case RecordKind::received:
      return on_message(head->t, head->kind == RecordKind::sent, body);
    case RecordKind::event: {
      if (body.empty()) return;
      const auto level = static_cast<SiteLog::Level>(body[0]);
      const std::string text(body.begin() + 1, body.end());
      return write_event(head->t, level == SiteLog::Level::warning ? "warning" : "info", text);
    }
    case RecordKind::tool:
    case RecordKind::wrench:
    case RecordKind::tracked:
      return write_sensor(head->t, head->kind, body);
    case RecordKind::applied:
      if (const auto words = read_plain<std::array<std::uint32_t, 2>>(body)) {
        on_applied(head->t, (*words)[0], (*words)[1] != 0);
      }
      return;
    case RecordKind::delays:
      if (const auto stamps = read_plain<DelayStamps>(body)) write_delays(head->t, *stamps);
      return;
    case RecordKind::link:
      if (const auto link = read_plain<LinkStatistics>(body)) write_link(head->t, *link);
      return;
    case RecordKind::phase:
      if (const auto words = read_plain<std::array<std::uint64_t, 2>>(body)) {
        const auto phase = static_cast<MotionPhase>((*words)[1]);
        if ((*words)[0] < objects_.size()) {
          write_phase(head->t, objects_[(*words)[0]], true, {head->t, phase});
        }
      }
      return;
  }
}

void BlackBoxWriter::write_sensor(double t, RecordKind kind, std::span<const std::uint8_t> body) {
  if (kind == RecordKind::wrench) {
    const auto v = read_plain<std::array<double, 6>>(body);
    if (!v) return;
    const Eigen::Vector3d force((*v)[0], (*v)[1], (*v)[2]), torque((*v)[3], (*v)[4], (*v)[5]);
    return put(wrench_, t, cdr::wrench_stamped(stamp_of(t), force, torque));
  }
  const bool is_tracked = kind == RecordKind::tracked;
  const auto v = read_plain<std::array<double, 7>>(body, is_tracked ? sizeof(std::uint64_t) : 0);
  if (!v) return;
  if (is_tracked) {
    return on_tracked(t, static_cast<std::size_t>(*read_plain<std::uint64_t>(body)), pose_of(*v));
  }
  T_base_tool_ = pose_of(*v);
  put(tool_, t, cdr::pose_stamped(stamp_of(t), *T_base_tool_));
}

void BlackBoxWriter::on_tracked(double t, std::size_t object, const Pose& T_base_object) {
  if (object >= objects_.size()) return;
  Object& seen = objects_[object];
  if (seen.T_base_tracked && t < seen.t_tracked + kMinFrameInterval) return;
  seen.T_base_tracked = T_base_object;
  seen.t_tracked = t;
  put(seen.tracked, t, cdr::pose_stamped(stamp_of(t), T_base_object));
}

void BlackBoxWriter::on_message(double now, bool is_sent, std::span<const std::uint8_t> bytes) {
  const Expected<LinkMessage> message = decode_link_message(bytes);
  if (!message) return write_event(now, "warning", "invalid message: " + message.error().message);
  if (const auto* command = std::get_if<LinkCommand>(&message->content)) {
    on_command(now, *command);
  } else if (const auto* state = std::get_if<LinkState>(&message->content)) {
    on_state(now, is_sent, message->header, *state);
  } else if (const auto* correction = std::get_if<LinkCorrection>(&message->content)) {
    on_correction(now, is_sent ? "sent" : "received", *correction);
    if (!is_sent && received_.size() < kMaxReceived) received_[correction->number] = *correction;
  } else if (const auto* stop = std::get_if<LinkStop>(&message->content)) {
    on_session(now, is_sent, {{"message", "stop"}, {"text", name_of_stop(*stop)}});
  } else if (const auto* hello = std::get_if<LinkHello>(&message->content)) {
    on_session(now, is_sent, {{"message", "hello"}, {"text", hello->name}});
  } else if (const auto* welcome = std::get_if<LinkWelcome>(&message->content)) {
    received_.clear();
    scene_start_ = welcome->start;
    on_session(now, is_sent, {{"message", "welcome"}, {"text", welcome->scene}});
  } else if (const auto* reject = std::get_if<LinkReject>(&message->content)) {
    on_session(now, is_sent, {{"message", "reject"}, {"text", reject->text}});
  }
}

void BlackBoxWriter::on_session(double now, bool is_sent, Json content) {
  content["direction"] = is_sent ? "sent" : "received";
  put(session_, now, content);
}

/// Called with the session's first command, because an operator's site knows the shared clock by
/// then.
void BlackBoxWriter::write_scene_start(double now, const LinkCommand& command) {
  put(session_, now,
      Json{{"message", "start"},
           {"time", stamp_of(local(*scene_start_)).seconds()},
           {"correction_delay", command.correction_delay}});
  scene_start_.reset();
}

void BlackBoxWriter::on_command(double now, const LinkCommand& command) {
  if (scene_start_) write_scene_start(now, command);
  T_base_command_ = pose_of(command.p_base_tip, command.q_base_tool);
  // The header's stamp is the time of execution, the log's that of sending or arrival.
  put(command_, now, cdr::pose_stamped(stamp_of(local(command.t)), *T_base_command_));
  const std::size_t count = std::min(objects_.size(), command.predictions.size());
  for (std::size_t i = 0; i < count; ++i) {
    write_changed_phase(now, objects_[i], false, {local(command.t), command.predictions[i].phase});
  }
  if (now < next_predictions_) return;
  next_predictions_ = now + display_interval_;
  for (std::size_t i = 0; i < count; ++i) {
    Object& object = objects_[i];
    const Stamp stamp = stamp_of(local(command.t));
    object.T_base_predicted = predicted_pose(command.predictions[i], object.T_base_start);
    put(object.predicted, now, cdr::pose_stamped(stamp, *object.T_base_predicted));
    put(object.force, now,
        cdr::wrench_stamped(stamp, command.predictions[i].rendered_force.cast<double>(),
                            Eigen::Vector3d::Zero()));
  }
}

void BlackBoxWriter::on_state(double now, bool is_sent, const LinkHeader& header,
                              const LinkState& state) {
  const std::size_t count = std::min(objects_.size(), state.objects.size());
  // The robot's site logs its samples and phases themselves.
  for (std::size_t i = 0; i < count && !is_sent; ++i) {
    write_changed_phase(now, objects_[i], true, {local(state.t), state.objects[i].phase});
  }
  write_status(now, state);
  if (!is_sent) {
    const double t = local(state.t);
    T_base_tool_ = pose_of(state.p_base_tip, state.q_base_tool);
    put(tool_, now, cdr::pose_stamped(stamp_of(t), *T_base_tool_));
    put(wrench_, now,
        cdr::wrench_stamped(stamp_of(t), state.force_base.cast<double>(),
                            state.torque_base.cast<double>()));
    for (std::size_t i = 0; i < count; ++i) {
      const LinkTrackedObject& object = state.objects[i];
      if (!object.is_tracked) continue;
      on_tracked(local(header.clock) - static_cast<double>(object.age), i,
                 pose_of(object.position, object.orientation));
    }
  }
  write_transforms(now);
}

void BlackBoxWriter::write_status(double now, const LinkState& state) {
  Json limits = Json::array();
  for (const auto& [limit, name] : kLimits) {
    if ((state.limits & static_cast<std::uint32_t>(limit)) != 0) limits.push_back(name);
  }
  Json status{{"engaged", state.is_engaged},
              {"on_hold", state.is_on_hold},
              {"stopped", state.is_stopped},
              {"limits", limits}};
  const std::string said = json_text(status);
  if (said == last_status_ && now < next_status_) return;
  last_status_ = said;
  next_status_ = now + kStatusInterval;
  status["discarded_commands"] = state.discarded_commands;
  status["corrections"] = state.corrections;
  put(status_, now, status);
}

void BlackBoxWriter::write_changed_phase(double now, Object& object, bool is_robot,
                                         const TimedPhase& seen) {
  std::optional<MotionPhase>& known = is_robot ? object.robot_phase : object.operator_phase;
  if (known == seen.phase) return;
  known = seen.phase;
  write_phase(now, object, is_robot, seen);
}

void BlackBoxWriter::write_phase(double now, const Object& object, bool is_robot,
                                 const TimedPhase& seen) {
  put(phases_, now,
      Json{{"object", object.name},
           {"site", is_robot ? "robot" : "operator"},
           {"phase", std::string(name_of(seen.phase))},
           {"time", stamp_of(seen.t).seconds()}});
}

void BlackBoxWriter::write_transforms(double now) {
  if (now < next_transforms_) return;
  next_transforms_ = now + display_interval_;
  std::vector<cdr::Transform> transforms;
  const auto add = [&](const std::string& frame, const std::optional<Pose>& pose) {
    if (pose) transforms.push_back({frame, *pose});
  };
  add("tool", T_base_tool_);
  add("command", T_base_command_);
  for (const Object& object : objects_) {
    add(object.frame, object.T_base_tracked);
    add(object.frame + kPredictedFrame, object.T_base_predicted);
  }
  if (!transforms.empty()) put(transforms_, now, cdr::tf_message(stamp_of(now), transforms));
}

void BlackBoxWriter::on_correction(double now, const char* action,
                                   const LinkCorrection& correction) {
  Json json{{"action", action},
            {"number", correction.number},
            {"time", stamp_of(local(correction.t)).seconds()}};
  if (const auto known = decode_correction(correction.bytes, correction.t)) {
    if (known->object < objects_.size()) json["object"] = objects_[known->object].name;
    json["case"] = std::string(name_of(known->which));
    json["what"] = known->what;
  }
  json["data"] = hex(correction.bytes);
  put(corrections_, now, json);
}

void BlackBoxWriter::on_applied(double now, std::uint32_t number, bool is_valid) {
  const auto found = received_.find(number);
  if (found == received_.end()) return;
  on_correction(now, is_valid ? "applied" : "not valid", found->second);
  received_.erase(received_.begin(), std::next(found));
}

void BlackBoxWriter::write_delays(double now, const DelayStamps& stamps) {
  DelayMeans one;
  one.add(stamps);
  Json stages = Json::object();
  for (const DelayMeans::Stage& stage : one.stages()) stages[std::string(stage.name)] = stage.mean;
  Json json{{"sent", stamps.sent},
            {"received", stamps.received},
            {"applied", stamps.applied},
            {"sensed", stamps.sensed},
            {"sent_back", stamps.sent_back},
            {"received_back", stamps.received_back},
            {"stages", stages}};
  if (stamps.device_clock) json["device"] = *stamps.device_clock;
  put(delays_, now, json);
}

void BlackBoxWriter::write_link(double now, const LinkStatistics& link) {
  clock_offset_ = link.clock_offset;
  put(link_, now,
      Json{{"clock_offset", link.clock_offset},
           {"clock_std", link.clock_std},
           {"round_trip", link.round_trip},
           {"delay_variation", link.delay_variation},
           {"lead", link.lead}});
}

void BlackBoxWriter::write_event(double now, std::string_view level, std::string_view text) {
  put(events_, now, Json{{"level", level}, {"text", text}});
}

void BlackBoxWriter::write_dropped(std::uint64_t records) {
  write_event(
      last_, "warning",
      fmt::format("{} records were dropped: the file could not be written as fast", records));
}

void BlackBoxWriter::put(std::uint16_t channel, double now,
                         const std::vector<std::uint8_t>& payload) {
  if (error_) return;
  note(file_.write(channel, stamp_of(now), std::span<const std::uint8_t>(payload)));
}

void BlackBoxWriter::put(std::uint16_t channel, double now, const Json& json) {
  if (error_) return;
  note(file_.write(channel, stamp_of(now), std::string_view(json_text(json))));
}

void BlackBoxWriter::note(const Expected<void>& result) {
  if (!result && !error_) error_ = result.error();
}

Stamp BlackBoxWriter::stamp_of(double t) const {
  const auto since = static_cast<std::int64_t>(std::llround(1e9 * (t - t_start_)));
  return {std::max<std::int64_t>(0, start_ + since)};
}

void BlackBoxWriter::flush_if_due() {
  if (!error_) note(file_.flush_if_due());
}

Expected<void> BlackBoxWriter::close() {
  if (!error_) note(file_.close());
  if (error_) return *error_;
  return {};
}

}  // namespace pcavr
