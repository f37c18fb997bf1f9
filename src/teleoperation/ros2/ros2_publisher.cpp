// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/ros2/ros2_publisher.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/core/record_queue.hpp"
#include "pcavr/recordings/rosbag/cdr_messages.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"
#include "pcavr/teleoperation/sites/black_box.hpp"
#include "pcavr/teleoperation/sites/site_clock.hpp"
#include "pcavr/teleoperation/teleop/live_sites.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kQueue = 1U << 18U;        // [bytes]: 40 bodies for a second at 100 Hz
constexpr std::chrono::milliseconds kPeriod(5);  // of the thread that publishes
constexpr double kRateTolerance = 1e-4;          // [s] of a cycle that comes a little early

constexpr char kTransformTopic[] = "/tf";

/// One body's prediction in the queue.
struct PredictionRecord {
  double t = 0.0;  ///< [s] CLOCK_REALTIME, for which it is predicted
  std::uint32_t object = 0;
  std::uint32_t phase = 0;
  std::array<float, 3> pose{};   ///< as LinkPrediction
  std::array<float, 3> force{};  ///< as rendered [N]
};
static_assert(std::is_trivially_copyable_v<PredictionRecord>);

std::array<float, 3> numbers_of(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3f vector_of(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

/// Three topics a body, then that of the transforms.
std::vector<Ros2Topic> topics_of(const Ros2Publication& publication,
                                 const std::vector<std::string>& parts) {
  const Ros2Qos qos{.is_reliable = true, .depth = 10};
  std::vector<Ros2Topic> topics;
  for (const std::string& part : parts) {
    const std::string& prefix = publication.prefix;
    topics.push_back({prefix + "/predicted/" + part, "geometry_msgs/msg/PoseStamped", qos});
    topics.push_back({prefix + "/predicted_force/" + part, "geometry_msgs/msg/WrenchStamped", qos});
    topics.push_back({prefix + "/phase/" + part, "std_msgs/msg/String", qos});
  }
  topics.push_back(
      {kTransformTopic, "tf2_msgs/msg/TFMessage", {.is_reliable = true, .depth = 100}});
  return topics;
}

}  // namespace

struct Ros2Publisher::Content {
  Content(const Ros2Publication& publication, const SiteScene& scene)
      : base_frame(publication.base_frame),
        interval(1.0 / publication.rate),
        parts(topic_parts_of(scene.objects)),
        T_base_starts(scene.T_base_objects),
        queue(kQueue) {}
  ~Content() {
    is_ending = true;
    if (thread.joinable()) thread.join();
  }

  void run() {
    std::vector<std::uint8_t> bytes;
    while (!is_ending.load(std::memory_order_relaxed)) {
      std::this_thread::sleep_for(kPeriod);
      while (queue.pop(bytes)) {
        PredictionRecord record;
        if (bytes.size() != sizeof(record)) continue;
        std::memcpy(&record, bytes.data(), sizeof(record));
        // What one message can't carry must not end the others.
        (void)caught([&] {
          publish(record);
          return true;
        });
      }
    }
  }

  void publish(const PredictionRecord& record) {
    const std::size_t i = record.object;
    if (i >= parts.size()) return;
    LinkPrediction prediction;
    prediction.pose = vector_of(record.pose);
    const Pose T_base_body = predicted_pose(prediction, T_base_starts[i]);
    const std::string frame = parts[i] + kPredictedFrame;
    const Stamp stamp = Stamp::from_seconds(record.t);
    // RViz draws a wrench at the origin of its frame: that of the body.
    const Eigen::Vector3d force_body =
        T_base_body.rotation().conjugate() * vector_of(record.force).cast<double>();
    transport->publish(3 * parts.size(),
                       cdr::tf_message(stamp, {{frame, T_base_body}}, base_frame));
    transport->publish(3 * i, cdr::pose_stamped(stamp, T_base_body, base_frame));
    transport->publish(3 * i + 1,
                       cdr::wrench_stamped(stamp, force_body, Eigen::Vector3d::Zero(), frame));
    transport->publish(3 * i + 2,
                       cdr::text_message(name_of(static_cast<MotionPhase>(record.phase))));
  }

  std::string base_frame;
  double interval;                  ///< [s]
  std::vector<std::string> parts;   ///< of topics and frames, by object
  std::vector<Pose> T_base_starts;  ///< by object
  RecordQueue queue;
  double next = 0.0;  ///< [s] CLOCK_REALTIME; the site's thread's
  std::unique_ptr<Ros2Transport> transport;
  std::atomic<bool> is_ending{false};
  std::thread thread;  ///< last: it uses the others
};

Ros2Publisher::Ros2Publisher(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Ros2Publisher::~Ros2Publisher() = default;

Expected<std::unique_ptr<Ros2Publisher>> Ros2Publisher::create(const Ros2Publication& publication,
                                                               const SiteScene& scene,
                                                               const Ros2Opener& open) {
  auto content = std::make_unique<Content>(publication, scene);
  Expected<std::unique_ptr<Ros2Transport>> transport =
      open({}, topics_of(publication, content->parts), publication.dds);
  if (!transport) return transport.error();
  content->transport = std::move(*transport);
  content->thread = std::thread([raw = content.get()] { raw->run(); });
  return std::unique_ptr<Ros2Publisher>(new Ros2Publisher(std::move(content)));
}

void Ros2Publisher::on_predictions(double ahead,
                                   const std::vector<LinkPrediction>& predictions) noexcept {
  Content& c = *content_;
  const double now = read_clock(CLOCK_REALTIME);
  // A clock that was set back must not silence it.
  if (now < c.next - kRateTolerance && c.next - now <= c.interval) return;
  c.next = now + c.interval;
  for (std::size_t i = 0; i < std::min(predictions.size(), c.parts.size()); ++i) {
    const LinkPrediction& prediction = predictions[i];
    const PredictionRecord record{.t = now + ahead,
                                  .object = static_cast<std::uint32_t>(i),
                                  .phase = static_cast<std::uint32_t>(prediction.phase),
                                  .pose = numbers_of(prediction.pose),
                                  .force = numbers_of(prediction.rendered_force)};
    c.queue.push({reinterpret_cast<const std::uint8_t*>(&record), sizeof(record)}, {});
  }
}

}  // namespace pcavr
