// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_robot.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/core/thread_priority.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"

#include "ros2_camera.hpp"
#include "ros2_intake.hpp"
#include "ros2_joints.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kSampleQueue = 1U << 18U;    // [bytes]: some 2000 samples
constexpr std::size_t kPictureQueue = 1U << 15U;   // [bytes]
constexpr std::size_t kNoticeQueue = 1U << 14U;    // [bytes]
constexpr std::size_t kSetpointQueue = 1U << 13U;  // [bytes]: 100 cycles
constexpr std::size_t kMaxSamplesPerCycle = 100;   // a flood of messages must not delay the site
constexpr std::chrono::milliseconds kWait{50};     // of the reading thread, until it looks about
constexpr double kMaxSetpointAge = 0.02;  // [s]: an older one is of a site that stands still
constexpr double kStartTolerance = 1e-6;  // [s]

double boot_clock() { return read_clock(CLOCK_BOOTTIME); }

struct Setpoint {
  double t = 0.0;  ///< CLOCK_BOOTTIME [s]
  std::array<double, 3> p_base_tip{};
  std::array<double, 4> q_base_tool{};  ///< x y z w
};

template <typename Record>
std::span<const std::uint8_t> record_bytes(const Record& record) {
  return {reinterpret_cast<const std::uint8_t*>(&record), sizeof(record)};
}

/// False if there is none.
template <typename Record>
bool pop_record(RecordQueue& queue, std::vector<std::uint8_t>& buffer, Record& record) {
  if (!queue.pop(buffer) || buffer.size() != sizeof(record)) return false;
  std::memcpy(&record, buffer.data(), sizeof(record));
  return true;
}

class Ros2Robot final : public RobotInterface, private PictureSource {
 public:
  Ros2Robot(const Ros2Setup& setup, std::vector<std::size_t> objects, std::size_t scene_objects)
      : setup_(setup),
        samples_(kSampleQueue),
        pictures_(kPictureQueue),
        notices_(kNoticeQueue),
        setpoints_(kSetpointQueue),
        notes_(notices_),
        intake_(setup_, std::move(objects), samples_, notes_),
        last_tracked_(scene_objects) {
    buffer_.reserve(sizeof(Ros2Sample));
  }
  Ros2Robot(const Ros2Robot&) = delete;
  Ros2Robot& operator=(const Ros2Robot&) = delete;
  ~Ros2Robot() override {
    is_stopped_ = true;
    if (reader_.joinable()) reader_.join();
    camera_.reset();
    if (publisher_.joinable()) publisher_.join();
  }

  [[nodiscard]] std::optional<Error> start(const Ros2Opener& open, const TeleopInput& world) {
    if (!setup_.tool_urdf.empty()) {
      Expected<Ros2ToolJoints> joints = read_tool_joints(setup_);
      if (!joints) return joints.error();
      intake_.set_joints(std::move(*joints));
    }
    if (setup_.is_command_of_joints) {
      Expected<Ros2JointCommand> command = read_joint_command(setup_);
      if (!command) return command.error();
      joint_command_ = std::move(*command);
    }
    if (setup_.camera) {
      Expected<std::unique_ptr<Ros2CameraTracker>> camera =
          make_ros2_camera(*setup_.camera, world, intake_, pictures_);
      if (!camera) return camera.error();
      camera_ = std::move(*camera);
      intake_.set_picture_sink(
          [this](std::size_t topic, bool is_image, std::span<const std::uint8_t> message,
                 double now) { camera_->on_message(topic, is_image, message, now); });
    }
    std::vector<Ros2Topic> subscribed;
    for (const Ros2Subscription& one : subscriptions_of(setup_)) subscribed.push_back(one.topic);
    std::vector<Ros2Topic> published;
    if (setup_.command) published.push_back(*setup_.command);
    Expected<std::unique_ptr<Ros2Transport>> transport = open(subscribed, published, setup_.dds);
    if (!transport) return transport.error();
    transport_ = std::move(*transport);
    if (std::optional<Error> error = wait_for_tool()) return error;
    reader_ = std::thread([this] { read(); });
    if (setup_.command) publisher_ = std::thread([this] { publish(); });
    return std::nullopt;
  }

  [[nodiscard]] std::string name() const override { return "ROS 2"; }
  [[nodiscard]] bool follows_commands() const override { return setup_.command.has_value(); }
  [[nodiscard]] Eigen::Vector3d p_base_start() const override {
    return T_base_start_.translation();
  }

  void set_command(const Eigen::Vector3d& p_base_tip,
                   const Eigen::Quaterniond& q_base_tool) override {
    if (!setup_.command) return;
    follow_loop();
    Setpoint setpoint{boot_clock(), {p_base_tip.x(), p_base_tip.y(), p_base_tip.z()}};
    Eigen::Map<Eigen::Vector4d>(setpoint.q_base_tool.data()) = q_base_tool.coeffs();
    setpoints_.push(record_bytes(setpoint), {});
  }

  void advance(double t, RobotSamples& samples) override {
    if (!scene_offset_) {
      scene_offset_ = t - boot_clock();
      picture_offset_ = *scene_offset_;
    }
    Ros2Sample sample;
    for (std::size_t i = 0; i < kMaxSamplesPerCycle; ++i) {
      if (!pop_record(samples_, buffer_, sample) && !pop_record(pictures_, buffer_, sample)) return;
      // No sample is of the future: the offset of its clock is known to the fastest message only.
      sample.t = std::min(sample.t + *scene_offset_, t);
      if (sample.t >= -kStartTolerance) append(sample, samples);
    }
  }

  [[nodiscard]] std::vector<std::string> take_notices() override {
    std::vector<std::string> lines;
    while (notices_.pop(buffer_)) lines.emplace_back(buffer_.begin(), buffer_.end());
    return lines;
  }

  [[nodiscard]] PictureSource* pictures() override {
    return camera_ ? static_cast<PictureSource*>(this) : nullptr;
  }

 private:
  // PictureSource.
  [[nodiscard]] Expected<std::optional<CameraPicture>> newest(double t) override {
    std::optional<CameraPicture> picture = camera_->take_picture();
    if (picture) picture->t = std::min(picture->t + picture_offset_, t);
    return picture;
  }

  struct Measured {
    Pose T_base_tool;
    double arrival = 0.0;  ///< [s]
    Eigen::VectorXd q;     ///< [rad or m] where joints are measured
  };

  [[nodiscard]] std::optional<Error> wait_for_tool() {
    const double end = boot_clock() + setup_.start_timeout;
    std::string seen;
    while (!intake_.tool() && boot_clock() < end) {
      receive();
      while (notices_.pop(buffer_)) seen += "; " + std::string(buffer_.begin(), buffer_.end());
    }
    if (!intake_.tool()) {
      return Error{
          .message = fmt::format("no {} on {} within {:g} s in domain {}{}", setup_.tool.type,
                                 setup_.tool.name, setup_.start_timeout, setup_.dds.domain, seen),
          .hint = "check topic, domain, network and the publisher's quality of service"};
    }
    T_base_start_ = intake_.tool()->T_base_tool;
    note_measured();
    return std::nullopt;
  }

  void receive() {
    transport_->wait(kWait, [&](std::size_t topic, std::span<const std::uint8_t> message) {
      try {
        intake_.on_message(topic, message, boot_clock());
      } catch (const std::exception& error) {  // must not end the site
        intake_.note(topic, std::string(error.what()) + ": ignored", boot_clock());
      }
    });
    const double now = boot_clock();
    if (now < next_look_) return;
    next_look_ = now + 1e-3 * static_cast<double>(kWait.count());
    for (const std::string& line : transport_->take_notices()) notes_.add(line, now);
  }

  void read() {
    while (!is_stopped_) {
      const bool has_received = succeeds("messages of the robot", [this] { receive(); });
      if (!has_received) std::this_thread::sleep_for(kWait);
      const double silence = boot_clock() - intake_.tool()->arrival;
      if (silence > setup_.silence_timeout) {
        notes_.add(setup_.tool.name + ": no message any more; nothing is commanded meanwhile",
                   boot_clock());
      }
      note_measured();
    }
  }

  /// Whether `work` of a thread ended without an exception, which must not end the site and is
  /// noted. `what` it is about.
  template <typename Work>
  bool succeeds(std::string_view what, const Work& work) {
    const auto done = caught([&] {
      work();
      return true;
    });
    if (!done)
      notes_.add(std::string(what) + ": " + done.error().message + ": ignored", boot_clock());
    return done.has_value();
  }

  /// The threads that the loop, which calls this, depends on: else a loaded machine delays samples
  /// and setpoints, and old setpoints are withheld.
  void follow_loop() {
    if (std::exchange(follows_loop_, true)) return;
    const int priority = real_time_priority();
    follow_real_time(reader_.native_handle(), priority);
    follow_real_time(publisher_.native_handle(), priority);
  }

  void note_measured() {
    const std::lock_guard lock(mutex_);
    measured_.T_base_tool = intake_.tool()->T_base_tool;
    measured_.arrival = intake_.tool()->arrival;
    if (intake_.joint_positions()) measured_.q = *intake_.joint_positions();
  }

  void publish() {
    std::vector<std::uint8_t> buffer;
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(1.0 / setup_.command_rate));
    auto next = std::chrono::steady_clock::now();
    while (!is_stopped_) {
      next = std::max(next + period, std::chrono::steady_clock::now());
      std::this_thread::sleep_until(next);
      std::optional<Setpoint> newest;
      for (Setpoint setpoint; pop_record(setpoints_, buffer, setpoint);) newest = setpoint;
      Measured measured;
      {
        const std::lock_guard lock(mutex_);
        measured = measured_;
      }
      if (newest && is_allowed(*newest, measured)) {
        const bool is_published =
            succeeds(setup_.command->name, [&] { publish(*newest, measured); });
        if (!is_published) q_base_command_.reset();  // as after a silence
      } else if (boot_clock() - last_published_ > kMaxSetpointAge) {
        q_base_command_.reset();  // the next one begins at the measured tool
      }
    }
  }

  [[nodiscard]] bool is_allowed(const Setpoint& setpoint, const Measured& measured) {
    const double now = boot_clock();
    if (now - setpoint.t > kMaxSetpointAge) return false;
    if (now - measured.arrival > setup_.silence_timeout) return false;
    const Eigen::Vector3d p(setpoint.p_base_tip[0], setpoint.p_base_tip[1], setpoint.p_base_tip[2]);
    const double distance = (p - measured.T_base_tool.translation()).norm();
    if (distance <= setup_.max_command_distance) return true;
    notes_.add(fmt::format("{}: the setpoint is more than {:g} m from the measured tip: withheld",
                           setup_.command->name, setup_.max_command_distance),
               now);
    return false;
  }

  void publish(const Setpoint& setpoint, const Measured& measured) {
    const double dt = 1.0 / setup_.command_rate;
    if (!q_base_command_) {
      q_base_command_ =
          setup_.follows_orientation ? measured.T_base_tool.rotation() : T_base_start_.rotation();
      if (joint_command_) joint_command_->restart(measured.q);
    }
    if (setup_.follows_orientation) {
      const Eigen::Quaterniond target(setpoint.q_base_tool.data());
      const double angle = q_base_command_->angularDistance(target);
      const double max_angle = setup_.max_command_rotation * dt;
      q_base_command_ =
          angle > max_angle ? q_base_command_->slerp(max_angle / angle, target) : target;
    }
    const auto& [x, y, z] = setpoint.p_base_tip;
    const Pose T_base_tool(*q_base_command_, {x, y, z});
    last_published_ = boot_clock();
    if (joint_command_) return publish_joints(T_base_tool, dt);
    const Stamp stamp = Stamp::from_seconds(read_clock(CLOCK_REALTIME));
    publish(cdr::pose_stamped(stamp, T_base_tool, setup_.base_frame));
  }

  void publish_joints(const Pose& T_base_tool, double dt) {
    if (joint_command_->follow(T_base_tool, dt) > setup_.max_command_distance) {
      notes_.add(setup_.command->name + ": the joints do not reach the setpoint: withheld",
                 boot_clock());
      return;
    }
    // A stamp of 0: from its arrival on, whatever the robot's clock says.
    publish(cdr::joint_trajectory({}, joint_command_->names(), joint_command_->positions(),
                                  setup_.command_time));
  }

  void publish(const std::vector<std::uint8_t>& message) {
    if (transport_->publish(0, message)) return;
    notes_.add(setup_.command->name + ": could not be published", boot_clock());
  }

  void append(const Ros2Sample& sample, RobotSamples& samples) {
    const std::array<double, 7>& v = sample.values;
    const Eigen::Vector3d first(v[0], v[1], v[2]);
    switch (sample.kind) {
      case Ros2Sample::Kind::tool:
        if (ascends(last_tool_, sample.t)) {
          samples.tool.push_back({sample.t, first, Eigen::Quaterniond(v[6], v[3], v[4], v[5])});
        }
        break;
      case Ros2Sample::Kind::wrench:
        if (ascends(last_wrench_, sample.t)) {
          samples.wrench.push_back({sample.t, first, Eigen::Vector3d(v[3], v[4], v[5])});
        }
        break;
      case Ros2Sample::Kind::tracked:
        if (sample.object < last_tracked_.size() &&
            ascends(last_tracked_[sample.object], sample.t)) {
          const Pose T_base_object(Eigen::Quaterniond(v[6], v[3], v[4], v[5]), first);
          samples.tracked.push_back(
              {sample.object, {sample.t, T_base_object, sample.std[0], sample.std[1]}});
        }
        break;
    }
  }

  static bool ascends(std::optional<double>& last, double t) {
    if (last && t <= *last) return false;
    last = t;
    return true;
  }

  const Ros2Setup setup_;
  RecordQueue samples_;    ///< from the reading thread to the site's
  RecordQueue pictures_;   ///< from the camera's thread to the site's
  RecordQueue notices_;    ///< the same; notes_ has a lock for its writers
  RecordQueue setpoints_;  ///< from the site's thread to the publishing one
  Ros2Notices notes_;
  Ros2Intake intake_;
  std::unique_ptr<Ros2CameraTracker> camera_;
  std::unique_ptr<Ros2Transport> transport_;
  double next_look_ = 0.0;  ///< [s]
  Pose T_base_start_;
  std::mutex mutex_;
  Measured measured_;

  // The following belong to the publishing thread.
  std::optional<Ros2JointCommand> joint_command_;
  std::optional<Eigen::Quaterniond> q_base_command_;  ///< the last published; none lately
  double last_published_ = 0.0;                       ///< [s]

  // The following belong to the site's thread.
  std::optional<double> scene_offset_;  ///< [s] scene's time less CLOCK_BOOTTIME
  std::vector<std::uint8_t> buffer_;
  std::optional<double> last_tool_;  ///< [s]
  std::optional<double> last_wrench_;
  std::vector<std::optional<double>> last_tracked_;  ///< by object

  std::atomic<double> picture_offset_ = 0.0;  ///< the first, for the thread of the pictures
  std::atomic<bool> is_stopped_ = false;
  std::thread reader_;
  std::thread publisher_;
  bool follows_loop_ = false;  ///< the threads have the loop's priority
};

/// Index in the world of each of Ros2Setup::objects.
Expected<std::vector<std::size_t>> find_objects(const Ros2Setup& setup, const TeleopInput& world) {
  std::vector<std::size_t> found;
  for (const Ros2Object& object : setup.objects) {
    const auto at = std::find_if(world.objects.begin(), world.objects.end(),
                                 [&](const TeleopObject& one) { return one.name == object.name; });
    if (at == world.objects.end()) {
      return Error{.message = object.name + " is not an object of the scene",
                   .place = "objects",
                   .hint = "give it the name that the scene has"};
    }
    found.push_back(static_cast<std::size_t>(at - world.objects.begin()));
  }
  return found;
}

}  // namespace

Expected<std::unique_ptr<RobotInterface>> make_ros2_robot(const Ros2Setup& setup,
                                                          const TeleopInput& world,
                                                          const Ros2Opener& open) {
  Expected<std::vector<std::size_t>> objects = find_objects(setup, world);
  if (!objects) return objects.error();
  auto robot = std::make_unique<Ros2Robot>(setup, std::move(*objects), world.objects.size());
  if (const std::optional<Error> error = robot->start(open, world)) return *error;
  return std::unique_ptr<RobotInterface>(std::move(robot));
}

}  // namespace pcavr
