// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/record/recorder.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <span>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/caught.hpp"
#include "pcavr/base/core/record_queue.hpp"
#include "pcavr/recordings/rosbag/cdr_camera_info.hpp"
#include "pcavr/recordings/rosbag/cdr_scene_messages.hpp"
#include "pcavr/recordings/rosbag/mcap_writer.hpp"
#include "pcavr/recordings/rosbag/ros_definitions.hpp"

#include "live_checks.hpp"
#include "record_clock.hpp"
#include "tag_watch.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMebibyte = 1U << 20U;
// Chunks are written by the interval; a fast camera must not make many of them, each of which stays
// in the index.
constexpr std::size_t kMaxChunk = 16 * kMebibyte;
constexpr std::chrono::milliseconds kPeriod(2);  // of the writing thread
constexpr std::chrono::milliseconds kWait(20);   // of the sources' threads
constexpr double kCountsInterval = 1.0;          // [s] between two records of the counts
constexpr double kChecksInterval = 0.1;          // [s]
constexpr double kCameraInfoInterval = 1.0;      // [s]
constexpr std::size_t kMaxPerTurn = 1000;  // messages of a source, before the others have theirs
constexpr std::size_t kMaxUntaken = 1000;

struct MessageHead {
  std::uint64_t topic = 0;
  std::int64_t log_time = 0;  ///< [ns]
};

/// Counts of a topic: written by its source's thread and by that of the file.
struct TopicCounts {
  std::atomic<std::uint64_t> messages = 0;
  std::atomic<std::uint64_t> dropped = 0;
  std::atomic<std::uint64_t> lost = 0;
};

struct Source {
  explicit Source(std::size_t queue_size) : queue(queue_size) {}
  RecordQueue queue;
  std::atomic<bool> has_ended = false;
  std::thread thread = {};
};

/// A camera's topics.
struct Camera {
  std::string name = {};
  std::size_t image = 0;
  std::optional<std::size_t> info = {};
  double next_info = 0.0;  ///< CLOCK_MONOTONIC [s]; of its source's thread
};

}  // namespace

struct Recorder::Content {
  Content(McapWriter writer, RecordInputs given, const RecorderOptions& chosen)
      : file(std::move(writer)), inputs(std::move(given)), options(chosen) {}

  void prepare();
  void start();
  std::size_t add_topic(RecordedTopic topic);
  [[nodiscard]] std::string free_camera_name() const;
  void push(Source& source, std::size_t topic, Stamp log_time,
            std::span<const std::uint8_t> message);
  void read_topics(Source& source);
  void read_camera(Source& source, std::size_t camera);
  void record_frame(Source& source, std::size_t camera, const CameraFrame& frame);
  void write_file();
  bool write_waiting();
  void write_message(const MessageHead& head, std::span<const std::uint8_t> message);
  void check(double now);
  void watch_tags(const MessageHead& head, std::span<const std::uint8_t> message);
  [[nodiscard]] Expected<void> write_counts();
  void warn(std::string line);
  void note(const Expected<void>& written);
  [[nodiscard]] double elapsed() const { return to_seconds(clock.now() - begin); }
  [[nodiscard]] RecordStatus status() const;

  McapWriter file;
  RecordInputs inputs;
  const RecorderOptions options;
  const RecordClock clock;
  const Stamp begin = clock.now();
  std::vector<RecordedTopic> topics;  ///< those of ROS 2, then two for each camera
  std::deque<TopicCounts> counts;     ///< by topic
  std::vector<std::uint16_t> channels;
  std::deque<Source> sources;
  std::deque<Camera> cameras;  ///< as inputs.cameras
  std::atomic<bool> is_stopped = false;
  std::atomic<bool> are_sources_ended = false;
  std::atomic<std::uint64_t> bytes = 0;
  std::atomic<bool> has_failed = false;
  std::thread writing;

  // The following belong to the writing thread.
  std::optional<LiveChecks> checks;
  std::unique_ptr<TagWatch> tags;
  std::map<std::size_t, double> next_tags;  ///< [s] by topic: when it is searched next
  std::map<std::string, std::uint64_t> written_counts;
  double next_counts = kCountsInterval;      ///< [s]
  std::vector<std::uint64_t> checked_drops;  ///< by topic
  double next_checks = 0.0;                  ///< [s]
  std::vector<std::uint8_t> record;
  std::optional<Error> error;  ///< read by others after it has ended

  std::mutex mutex;
  std::vector<std::string> warnings;
  std::optional<Expected<RecordStatus>> result;
};

std::size_t Recorder::Content::add_topic(RecordedTopic topic) {
  const std::string definition = ros_message_definition(topic.type);
  const std::uint16_t schema =
      file.add_schema(topic.type, definition.empty() ? "" : "ros2msg", definition);
  channels.push_back(file.add_channel(topic.name, "cdr", schema));
  counts.emplace_back();
  topics.push_back(std::move(topic));
  return topics.size() - 1;
}

/// A name that no topic begins with: a robot may have a camera of that name.
std::string Recorder::Content::free_camera_name() const {
  for (int number = 1;; ++number) {
    const std::string name = number == 1 ? "camera" : fmt::format("camera_{}", number);
    const bool is_free = std::none_of(
        topics.begin(), topics.end(),
        [&](const RecordedTopic& topic) { return topic.name.starts_with('/' + name + '/'); });
    if (is_free) return name;
  }
}

void Recorder::Content::prepare() {
  for (const RecordedTopic& topic : inputs.topics) add_topic(topic);
  for (const RecordedCamera& recorded : inputs.cameras) {
    Camera& camera = cameras.emplace_back();
    camera.name = free_camera_name();
    camera.image = add_topic({'/' + camera.name + "/image_raw/compressed",
                              std::string(cdr::kCompressedImageType), RecordRole::image});
    if (recorded.model) {
      camera.info = add_topic({'/' + camera.name + "/camera_info",
                               std::string(cdr::kCameraInfoType), RecordRole::camera_info});
    }
  }
  checks.emplace(topics, 0.0);
  checked_drops.resize(topics.size());
}

void Recorder::Content::start() {
  const std::size_t queue_size =
      std::bit_ceil(static_cast<std::size_t>(options.queue_size) * kMebibyte);
  if (inputs.transport) {
    Source& source = sources.emplace_back(queue_size);
    source.thread = std::thread([this, &source] { read_topics(source); });
  }
  for (std::size_t i = 0; i < inputs.cameras.size(); ++i) {
    Source& source = sources.emplace_back(queue_size);
    source.thread = std::thread([this, &source, i] { read_camera(source, i); });
  }
  writing = std::thread([this] { write_file(); });
}

void Recorder::Content::push(Source& source, std::size_t topic, Stamp log_time,
                             std::span<const std::uint8_t> message) {
  const MessageHead head{topic, log_time.nanoseconds};
  const bool is_taken =
      source.queue.push({reinterpret_cast<const std::uint8_t*>(&head), sizeof(head)}, message);
  if (!is_taken) ++counts[topic].dropped;
}

void Recorder::Content::read_topics(Source& source) {
  const Expected<bool> done = caught([&] {
    double next_look = 0.0;  // [s]
    while (!is_stopped) {
      inputs.transport->wait(kWait, [&](std::size_t topic, std::span<const std::uint8_t> message) {
        push(source, topic, clock.now(), message);
      });
      if (elapsed() < next_look) continue;
      next_look = elapsed() + kCountsInterval;
      for (std::string& notice : inputs.transport->take_notices()) warn(std::move(notice));
      for (std::size_t i = 0; i < inputs.topics.size(); ++i) {
        counts[i].lost = inputs.transport->lost(i);
      }
    }
    return true;
  });
  if (!done) warn("ROS 2: " + done.error().message + ": no more topics are recorded");
  source.has_ended = true;
}

void Recorder::Content::read_camera(Source& source, std::size_t camera) {
  CameraSource& device = *inputs.cameras[camera].source;
  const Expected<bool> done = caught([&]() -> bool {
    while (!is_stopped) {
      const Expected<std::optional<CameraFrame>> frame = device.next(kWait);
      counts[cameras[camera].image].lost = device.lost();
      if (!frame) {
        warn(frame.error().to_string() + ": this camera is no more recorded");
        return false;
      }
      if (*frame) record_frame(source, camera, **frame);
    }
    return true;
  });
  if (!done) warn(device.description() + ": " + done.error().message);
  source.has_ended = true;
}

void Recorder::Content::record_frame(Source& source, std::size_t camera, const CameraFrame& frame) {
  Camera& topics_of = cameras[camera];
  const std::string optical_frame = topics_of.name + "_optical_frame";
  const Stamp stamp = clock.at(frame.t);
  push(source, topics_of.image, clock.now(),
       cdr::compressed_image(stamp, optical_frame, frame.format, frame.bytes));
  if (!topics_of.info || frame.t < topics_of.next_info) return;
  topics_of.next_info = frame.t + kCameraInfoInterval;
  push(source, *topics_of.info, clock.now(),
       cdr::camera_info(stamp, optical_frame, *inputs.cameras[camera].model));
}

void Recorder::Content::write_file() {
  const Expected<bool> done = caught([&] {
    for (bool is_last = false; !error;) {
      is_last = are_sources_ended;  // before the queues are emptied: all of it is written
      // What arrived up to now is checked once all of it is written: a slow disk is no gap.
      const double now = elapsed();
      const bool has_more = write_waiting();
      if (!error) note(file.flush_if_due());
      if (!has_more) check(now);
      bytes = file.bytes_written();
      if (has_more) continue;
      if (is_last) break;
      std::this_thread::sleep_for(kPeriod);
    }
    return true;
  });
  if (!done && !error) error = done.error();
  if (!error) note(write_counts());
  if (!error) note(file.close());
  bytes = file.bytes_written();
  has_failed = error.has_value();
}

bool Recorder::Content::write_waiting() {
  bool has_more = false;
  for (Source& source : sources) {
    std::size_t taken = 0;
    while (!error && taken < kMaxPerTurn && source.queue.pop(record)) {
      MessageHead head;
      std::memcpy(&head, record.data(), sizeof(head));
      write_message(head, std::span<const std::uint8_t>(record).subspan(sizeof(head)));
      ++taken;
    }
    has_more = has_more || taken == kMaxPerTurn;
  }
  return has_more && !error;
}

void Recorder::Content::write_message(const MessageHead& head,
                                      std::span<const std::uint8_t> message) {
  const auto topic = static_cast<std::size_t>(head.topic);
  note(file.write(channels[topic], Stamp{head.log_time}, message));
  if (error) return;
  ++counts[topic].messages;
  checks->on_message(topic, to_seconds(Stamp{head.log_time} - begin), message);
  if (tags && topics[topic].role == RecordRole::image) watch_tags(head, message);
}

void Recorder::Content::watch_tags(const MessageHead& head, std::span<const std::uint8_t> message) {
  const auto topic = static_cast<std::size_t>(head.topic);
  const double t = to_seconds(Stamp{head.log_time} - begin);
  double& next = next_tags[topic];
  if (t < next || !tags->is_idle()) return;
  next = t + options.tag_interval;
  tags->offer(topic, topics[topic].type, message);
}

void Recorder::Content::check(double now) {
  if (now < next_checks) return;
  next_checks = now + kChecksInterval;
  if (tags) {
    if (const auto sight = tags->take()) checks->on_tags(sight->topic, now, sight->tags);
  }
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const std::uint64_t dropped = counts[i].dropped;
    if (dropped == checked_drops[i]) continue;
    checked_drops[i] = dropped;
    checks->on_dropped(i, now, dropped);
  }
  checks->on_time(now);
  for (std::string& line : checks->take_warnings()) warn(std::move(line));
  if (now < next_counts || error) return;
  next_counts = now + kCountsInterval;
  note(write_counts());
}

/// Writes the counts of what is missing, where they have changed.
Expected<void> Recorder::Content::write_counts() {
  std::map<std::string, std::uint64_t> missing;
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const std::uint64_t count = counts[i].dropped + counts[i].lost;
    if (count > 0) missing[topics[i].name] += count;
  }
  if (missing == written_counts) return {};
  written_counts = missing;
  return file.write_dropped(missing);
}

void Recorder::Content::note(const Expected<void>& written) {
  if (written || error) return;
  error = written.error();
  error->message += fmt::format("; it is readable up to some {} s before", options.flush_interval);
}

void Recorder::Content::warn(std::string line) {
  const std::lock_guard lock(mutex);
  if (warnings.size() < kMaxUntaken) warnings.push_back(std::move(line));
}

RecordStatus Recorder::Content::status() const {
  RecordStatus status{.elapsed = elapsed(), .messages = 0, .bytes = bytes, .topics = {}};
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const TopicCounts& topic = counts[i];
    status.topics.push_back({topics[i].name, topic.messages, topic.dropped, topic.lost});
    status.messages += topic.messages;
  }
  return status;
}

Recorder::Recorder(std::unique_ptr<Content> content) : content_(std::move(content)) {}

Recorder::~Recorder() { (void)finish(); }

Expected<std::unique_ptr<Recorder>> Recorder::start(const std::filesystem::path& file, bool replace,
                                                    RecordInputs inputs,
                                                    const RecorderOptions& options) {
  // Before the file is replaced.
  std::unique_ptr<TagWatch> tags;
  if (!inputs.tags.empty()) {
    Expected<std::unique_ptr<TagWatch>> watch = TagWatch::create(inputs.tags);
    if (!watch) return watch.error();
    tags = std::move(*watch);
  }
  Expected<McapWriter> writer = McapWriter::create(file, {.profile = "ros2",
                                                          .max_chunk = kMaxChunk,
                                                          .flush_interval = options.flush_interval,
                                                          .replace = replace});
  if (!writer) return writer.error();
  auto content = std::make_unique<Content>(std::move(*writer), std::move(inputs), options);
  content->tags = std::move(tags);
  content->prepare();
  content->start();
  return std::unique_ptr<Recorder>(new Recorder(std::move(content)));
}

RecordStatus Recorder::status() const { return content_->status(); }

std::vector<std::string> Recorder::take_warnings() {
  const std::lock_guard lock(content_->mutex);
  return std::exchange(content_->warnings, {});
}

bool Recorder::has_ended() const {
  if (content_->has_failed) return true;
  for (const Source& source : content_->sources) {
    if (!source.has_ended) return false;
  }
  return true;
}

Expected<RecordStatus> Recorder::finish() {
  if (content_->result) return *content_->result;
  RecordStatus status;
  status.elapsed = content_->elapsed();
  content_->is_stopped = true;
  for (Source& source : content_->sources) source.thread.join();
  content_->are_sources_ended = true;
  content_->writing.join();
  const double elapsed = status.elapsed;
  status = content_->status();
  status.elapsed = elapsed;
  if (content_->error) {
    content_->result = *content_->error;
  } else {
    content_->result = std::move(status);
  }
  return *content_->result;
}

}  // namespace pcavr
