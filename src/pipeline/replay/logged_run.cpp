// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/pipeline/logged_run.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pcavr/physics/inputs/input_findings.hpp"
#include "pcavr/recordings/rosbag/bag_reader.hpp"
#include "pcavr/recordings/rosbag/ros_messages.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {
namespace {

constexpr double kSameTime = 5e-7;     // [s] half the last digit in files
constexpr double kMaxForceGap = 0.02;  // [s] between a predicted force and a wrench beside it
// [m] and [rad]: of tracked poses whose std is not logged, as read_tracked_poses.
constexpr double kPositionStd = 1e-3;
constexpr double kRotationStd = 1e-2;

struct TimedForce {
  double t = 0.0;  ///< [s]
  Eigen::Vector3d force_base;
};

struct LoggedPhase {
  double t = 0.0;  ///< [s]
  bool is_robot = false;
  MotionPhase phase = MotionPhase::free;
};

struct LoggedObject {
  std::vector<ShownPose> predicted;
  std::vector<TrackedPose> tracked;
  std::vector<TimedForce> rendered;
  std::vector<LoggedPhase> phases;
};

template <typename Row>
void sort_by_time(std::vector<Row>& rows) {
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.t < b.t; });
  const auto is_same = [](const Row& a, const Row& b) { return b.t - a.t < kSameTime; };
  rows.erase(std::unique(rows.begin(), rows.end(), is_same), rows.end());
}

std::optional<double> number_in(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

std::string text_in(const nlohmann::json& json, const char* key) {
  const auto found = json.find(key);
  return found == json.end() || !found->is_string() ? std::string() : found->get<std::string>();
}

std::optional<MotionPhase> phase_of(const std::string& name) {
  for (const MotionPhase phase : {MotionPhase::free, MotionPhase::static_contact,
                                  MotionPhase::critical, MotionPhase::sliding}) {
    if (name_of(phase) == name) return phase;
  }
  return std::nullopt;
}

std::optional<CorrectionCase> case_of(const std::string& name) {
  for (const CorrectionCase one :
       {CorrectionCase::both_static_force, CorrectionCase::touched_by_operator,
        CorrectionCase::touched_by_robot, CorrectionCase::both_sliding,
        CorrectionCase::phases_differ}) {
    if (name_of(one) == name) return one;
  }
  return std::nullopt;
}

/// Collects what one log states. Stamps are converted once its time zero is known.
class LoggedSession {
 public:
  explicit LoggedSession(const SceneManifest& scene) : objects_(scene.objects.size()) {
    for (const SceneObjectEntry& object : scene.objects) names_.push_back(object.name);
    for (const std::string& part : topic_parts_of(names_)) {
      index_by_topic_.emplace(part, index_by_topic_.size());
    }
  }

  void add(const BagTopic& topic, const BagMessage& message) {
    if (topic.encoding == "json") {
      const nlohmann::json json =
          nlohmann::json::parse(message.payload.begin(), message.payload.end(), nullptr, false);
      if (json.is_object()) add_json(topic.name, message.log_time.seconds(), json);
      return;
    }
    const Expected<RosMessage> decoded = decode_ros_message(topic, message.payload);
    if (!decoded) return;
    if (const auto* pose = std::get_if<RosPose>(&*decoded)) {
      add_pose(topic.name, *pose);
    } else if (const auto* wrench = std::get_if<RosWrench>(&*decoded)) {
      add_wrench(topic.name, *wrench);
    }
  }

  [[nodiscard]] bool has_session() const { return zero_.has_value(); }
  [[nodiscard]] bool has_objects() const {
    return std::any_of(objects_.begin(), objects_.end(),
                       [](const LoggedObject& object) { return !object.predicted.empty(); });
  }

  [[nodiscard]] Replay take() {
    Replay replay;
    replay.objects_are_logged = true;
    TeleopRun run;
    sort_by_time(wrench_);
    std::size_t frames = 0;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      LoggedObject& object = objects_[i];
      sort_by_time(object.predicted);
      sort_by_time(object.tracked);
      sort_by_time(object.rendered);
      frames += object.tracked.size();
      ReplayedObject& replayed = replay.objects.emplace_back();
      replayed.name = names_[i];
      replayed.tracked = std::move(object.tracked);
      run.shown.push_back(std::move(object.predicted));
      add_forces(i, run.forces);
      add_phases(i, run.phases);
    }
    std::stable_sort(run.phases.begin(), run.phases.end(),
                     [](const PhaseRow& a, const PhaseRow& b) { return a.t < b.t; });
    std::stable_sort(corrections_.begin(), corrections_.end(),
                     [](const SentCorrection& a, const SentCorrection& b) { return a.t < b.t; });
    for (const SentCorrection& sent : corrections_) run.correction_bytes += sent.bytes;
    run.corrections = std::move(corrections_);
    run.sent_corrections = run.corrections.size();
    // The operator's site has no more than the states, at a rate of their own.
    if (!lead_) run.streaming_bytes = streaming_bytes_of(wrench_.size(), frames);
    run.parameters.resize(names_.size());
    run.assumed.resize(names_.size());
    run.notes = std::move(notes_);
    replay.teleop = std::move(run);
    const double forward = lead_.value_or(0.5 * correction_delay_);
    replay.teleop_options.forward_delay = forward;
    replay.teleop_options.backward_delay = std::max(correction_delay_ - forward, 0.0);
    replay.parameters_file = "none";
    return replay;
  }

 private:
  [[nodiscard]] double since_zero(double stamp) const { return stamp - *zero_; }

  [[nodiscard]] std::optional<std::size_t> object_of(const std::string& topic,
                                                     const std::string& group) const {
    if (topic.rfind(group, 0) != 0) return std::nullopt;
    const auto found = index_by_topic_.find(topic.substr(group.size()));
    if (found == index_by_topic_.end()) return std::nullopt;
    return found->second;
  }

  void add_pose(const std::string& topic, const RosPose& message) {
    if (!zero_ || !message.header.stamp || !message.orientation) return;
    const double t = to_seconds(*message.header.stamp - *zero_stamp_);
    const Pose pose(message.orientation->normalized(), message.position);
    if (const auto predicted = object_of(topic, "/predicted/")) {
      objects_[*predicted].predicted.push_back({t, pose});
    } else if (const auto tracked = object_of(topic, "/tracked/")) {
      objects_[*tracked].tracked.push_back({t, pose, kPositionStd, kRotationStd});
    }
  }

  void add_wrench(const std::string& topic, const RosWrench& message) {
    if (!zero_ || !message.header.stamp) return;
    const double t = to_seconds(*message.header.stamp - *zero_stamp_);
    if (topic == "/wrench") {
      wrench_.push_back({t, message.force});
    } else if (const auto object = object_of(topic, "/predicted_force/")) {
      objects_[*object].rendered.push_back({t, message.force});
    }
  }

  void add_json(const std::string& topic, double log_time, const nlohmann::json& json) {
    if (topic == "/session" && text_in(json, "message") == "start") {
      begin(json);
    } else if (topic == "/link") {
      lead_ = number_in(json, "lead");
    } else if (topic == "/corrections" && zero_) {
      add_correction(json);
    } else if (topic == "/phases" && zero_) {
      add_phase(json);
    } else if (topic == "/events" && zero_ && text_in(json, "level") == "warning") {
      notes_.push_back(at_time(since_zero(log_time)) + ": " + text_in(json, "text"));
    }
  }

  /// Takes time zero from the first session: later ones of the same log have the same, unless the
  /// robot's site was started again.
  void begin(const nlohmann::json& json) {
    numbers_.clear();
    correction_delay_ = number_in(json, "correction_delay").value_or(correction_delay_);
    const std::optional<double> zero = number_in(json, "time");
    if (zero_ || !zero) return;
    zero_ = zero;
    zero_stamp_ = Stamp::from_seconds(*zero);
  }

  void add_correction(const nlohmann::json& json) {
    const std::string action = text_in(json, "action");
    const auto number = number_in(json, "number");
    const auto time = number_in(json, "time");
    const std::optional<CorrectionCase> which = case_of(text_in(json, "case"));
    const auto object = std::find(names_.begin(), names_.end(), text_in(json, "object"));
    if ((action != "sent" && action != "received") || !number || !time || !which) return;
    if (object == names_.end() || !numbers_.insert(*number).second) return;  // sent again
    corrections_.push_back({.t = since_zero(*time),
                            .object = static_cast<std::size_t>(object - names_.begin()),
                            .which = *which,
                            .what = text_in(json, "what"),
                            .bytes = text_in(json, "data").size() / 2});
  }

  void add_phase(const nlohmann::json& json) {
    const std::optional<MotionPhase> phase = phase_of(text_in(json, "phase"));
    const auto time = number_in(json, "time");
    const auto object = std::find(names_.begin(), names_.end(), text_in(json, "object"));
    if (!phase || !time || object == names_.end()) return;
    objects_[static_cast<std::size_t>(object - names_.begin())].phases.push_back(
        {since_zero(*time), text_in(json, "site") == "robot", *phase});
  }

  /// The force at `t` [s], linearly between the samples beside it: as the tip leaves a stiff
  /// object, the force changes by a newton within a sample's interval. Empty where the samples are
  /// too far.
  [[nodiscard]] std::optional<Eigen::Vector3d> measured_force_at(double t) const {
    const auto after =
        std::lower_bound(wrench_.begin(), wrench_.end(), t,
                         [](const TimedForce& sample, double time) { return sample.t < time; });
    if (after == wrench_.end() || after->t - t > kMaxForceGap) return std::nullopt;
    if (after->t - t < kSameTime) return after->force_base;
    if (after == wrench_.begin()) return std::nullopt;
    const TimedForce& before = *std::prev(after);
    if (t - before.t > kMaxForceGap) return std::nullopt;
    const double share = (t - before.t) / (after->t - before.t);
    return Eigen::Vector3d(before.force_base + share * (after->force_base - before.force_base));
  }

  /// Adds forces along the rendered one, which is that of the push: the log does not state another
  /// one.
  void add_forces(std::size_t index, std::vector<ForceRow>& rows) const {
    for (const TimedForce& rendered : objects_[index].rendered) {
      const double size = rendered.force_base.norm();
      if (size <= 0.0) continue;
      const std::optional<Eigen::Vector3d> measured = measured_force_at(rendered.t);
      if (!measured) continue;
      rows.push_back({rendered.t, index, measured->dot(rendered.force_base) / size, size});
    }
  }

  void add_phases(std::size_t index, std::vector<PhaseRow>& rows) {
    std::vector<LoggedPhase>& phases = objects_[index].phases;
    std::stable_sort(phases.begin(), phases.end(),
                     [](const LoggedPhase& a, const LoggedPhase& b) { return a.t < b.t; });
    std::optional<PhaseRow> row;
    for (const LoggedPhase& one : phases) {
      if (!row) row = PhaseRow{one.t, index};
      if (one.t - row->t > kSameTime) rows.push_back(*row);
      row->t = std::max(row->t, one.t);
      (one.is_robot ? row->measured : row->predicted) = one.phase;
    }
    if (row) rows.push_back(*row);
  }

  std::vector<std::string> names_;
  std::map<std::string, std::size_t> index_by_topic_;
  std::vector<LoggedObject> objects_;
  std::vector<TimedForce> wrench_;
  std::vector<SentCorrection> corrections_;
  std::set<double> numbers_;  ///< of the session's corrections so far
  std::vector<std::string> notes_;
  std::optional<double> zero_ = {};  ///< [s] as stamps: time zero of the scene
  std::optional<Stamp> zero_stamp_ = {};
  std::optional<double> lead_ = {};  ///< [s]
  double correction_delay_ = 0.0;    ///< [s]
};

}  // namespace

Expected<Replay> read_logged_run(const std::filesystem::path& log, const SceneManifest& scene) {
  Expected<std::unique_ptr<BagReader>> reader = open_bag(log);
  if (!reader) return reader.error();
  LoggedSession session(scene);
  for (;;) {
    const Expected<std::optional<BagMessage>> message = (*reader)->next();
    if (!message) return message.error();
    if (!*message) break;
    session.add((*reader)->topics()[(*message)->topic], **message);
  }
  if (!session.has_session()) {
    return Error{.message = "is no black box with a session",
                 .file = log.string(),
                 .hint =
                     "give the file of --log of robot-site or operator-site; 'pcavr import' "
                     "makes a recording of other bags"};
  }
  if (!session.has_objects()) {
    return Error{.message = "has no object of the scene",
                 .file = log.string(),
                 .hint = "give --scene the scene of the session"};
  }
  Replay replay = session.take();
  for (const std::string& warning : (*reader)->warnings()) {
    replay.teleop->notes.push_back(warning);
  }
  return replay;
}

}  // namespace pcavr
