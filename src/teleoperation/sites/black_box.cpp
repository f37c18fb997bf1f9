// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/sites/black_box.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstring>
#include <ctime>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "pcavr/base/core/options.hpp"
#include "pcavr/base/core/record_queue.hpp"

#include "black_box_writer.hpp"
#include "site_log.hpp"

namespace pcavr {
namespace {

constexpr auto kBlackBoxFields = std::to_array<OptionField<BlackBoxOptions>>({
    // Together with the time until the thread runs again it is below 0.1 s.
    {"flush_interval", &BlackBoxOptions::flush_interval, 0.05, 0.001, 60.0, "s",
     "time after which a record is in the file: what a crash loses",
     "lower: many small blocks in the file; higher: a crash loses more"},
    {"display_rate", &BlackBoxOptions::display_rate, 100.0, 1.0, 1000.0, "Hz",
     "rate of the predicted poses and forces, and of the transforms",
     "lower: their motion is coarse; higher: larger files"},
    // Some 8 s of a site at 1 kHz.
    {"queue_size", &BlackBoxOptions::queue_size, 8.0, 1.0, 1024.0, "MiB",
     "records that wait for the file, rounded up to a power of two",
     "lower: a slow disk loses records; higher: memory"},
});
static_assert(are_valid_fields(kBlackBoxFields));

constexpr std::chrono::milliseconds kPeriod(5);  // of the thread that writes
constexpr std::size_t kMebibyte = 1U << 20U;

std::int64_t realtime() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

std::array<double, 7> numbers_of(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) {
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

template <typename T>
std::span<const std::uint8_t> bytes_of(const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const std::uint8_t*>(&value), sizeof(T)};
}

/// The site's side of the queue.
class QueuedLog final : public SiteLog {
 public:
  explicit QueuedLog(RecordQueue& queue) : queue_(queue) {}

  void on_start(double now) override { push(RecordKind::start, now, bytes_of(realtime())); }
  void on_sent(double now, std::span<const std::uint8_t> bytes) override {
    push(RecordKind::sent, now, bytes);
  }
  void on_received(double now, std::span<const std::uint8_t> bytes) override {
    push(RecordKind::received, now, bytes);
  }
  void on_event(double now, Level level, std::string_view text) override {
    std::array<std::uint8_t, 512> body{};
    body[0] = static_cast<std::uint8_t>(level);
    const std::size_t length = std::min(text.size(), body.size() - 1);
    std::memcpy(body.data() + 1, text.data(), length);
    push(RecordKind::event, now, std::span(body).first(length + 1));
  }
  void on_tool(double t, const RobotSamples::Tool& tool) override {
    push(RecordKind::tool, t, bytes_of(numbers_of(tool.p_base_tip, tool.q_base_tool)));
  }
  void on_wrench(double t, const RobotSamples::Wrench& wrench) override {
    const Eigen::Vector3d& f = wrench.force_base;
    const Eigen::Vector3d& m = wrench.torque_base;
    const std::array<double, 6> numbers{f.x(), f.y(), f.z(), m.x(), m.y(), m.z()};
    push(RecordKind::wrench, t, bytes_of(numbers));
  }
  void on_tracked(double t, const RobotSamples::Tracked& tracked) override {
    struct Body {
      std::uint64_t object;
      std::array<double, 7> numbers;
    };
    const Pose& pose = tracked.pose.T_base_object;
    const Body body{tracked.object, numbers_of(pose.translation(), pose.rotation())};
    push(RecordKind::tracked, t, bytes_of(body));
  }
  void on_phase(double t, std::size_t object, MotionPhase phase) override {
    const std::array<std::uint64_t, 2> words{object, static_cast<std::uint64_t>(phase)};
    push(RecordKind::phase, t, bytes_of(words));
  }
  void on_applied(double now, std::uint32_t, const LinkCorrection& correction,
                  bool is_valid) override {
    const std::array<std::uint32_t, 2> words{correction.number, is_valid ? 1U : 0U};
    push(RecordKind::applied, now, bytes_of(words));
  }
  void on_delays(double now, const DelayStamps& stamps) override {
    push(RecordKind::delays, now, bytes_of(stamps));
  }
  void on_link(double now, const LinkStatistics& link) override {
    push(RecordKind::link, now, bytes_of(link));
  }
  [[nodiscard]] std::optional<std::string> take_fault() override {
    if (!has_fault_.exchange(false, std::memory_order_acquire)) return std::nullopt;
    return fault_;
  }

  /// The file's thread, once.
  void set_fault(std::string text) {
    fault_ = std::move(text);
    has_fault_.store(true, std::memory_order_release);
  }

 private:
  void push(RecordKind kind, double t, std::span<const std::uint8_t> body) {
    const RecordHead head{t, kind};
    queue_.push(bytes_of(head), body);
  }

  RecordQueue& queue_;
  std::string fault_;
  std::atomic<bool> has_fault_{false};
};

std::size_t queue_bytes(const BlackBoxOptions& options) {
  return std::bit_ceil(static_cast<std::size_t>(options.queue_size) * kMebibyte);
}

}  // namespace

struct BlackBox::Content {
  Content(McapWriter file, const SiteScene& scene, const BlackBoxOptions& options)
      : queue(queue_bytes(options)),
        log(queue),
        writer(std::move(file), scene, options.display_rate),
        thread([this] { run(); }) {}
  ~Content() { end(); }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  void run() {
    bool has_fault = false;
    for (bool is_last = false; !is_last;) {
      is_last = is_ending.load(std::memory_order_acquire);
      drain();
      if (writer.error() && !std::exchange(has_fault, true)) {
        log.set_fault(writer.error()->to_string());
      }
      if (!is_last) std::this_thread::sleep_for(kPeriod);
    }
  }

  void drain() {
    while (queue.pop(record)) writer.write(record);
    if (const std::uint64_t dropped = queue.dropped(); dropped != stated) {
      writer.write_dropped(dropped - stated);
      stated = dropped;
    }
    writer.flush_if_due();
  }

  void end() {
    is_ending.store(true, std::memory_order_release);
    if (thread.joinable()) thread.join();
  }

  RecordQueue queue;
  QueuedLog log;
  BlackBoxWriter writer;             ///< the thread's, while it runs
  std::vector<std::uint8_t> record;  ///< the same
  std::uint64_t stated = 0;          ///< the same: dropped records that the file states
  std::atomic<bool> is_ending{false};
  std::thread thread;  // last: it uses the others
};

BlackBoxOptions::BlackBoxOptions() { set_defaults(*this, kBlackBoxFields); }
OptionSection section_of(BlackBoxOptions& options) {
  return make_section("black_box", options, kBlackBoxFields);
}

BlackBox::BlackBox(std::unique_ptr<Content> content) : content_(std::move(content)) {}
BlackBox::~BlackBox() = default;

Expected<std::unique_ptr<BlackBox>> BlackBox::create(const std::filesystem::path& file,
                                                     const SiteScene& scene,
                                                     const BlackBoxOptions& options) {
  Expected<McapWriter> writer = McapWriter::create(
      file, {.profile = "ros2", .flush_interval = options.flush_interval, .replace = false});
  if (!writer) return writer.error();
  return std::unique_ptr<BlackBox>(
      new BlackBox(std::make_unique<Content>(std::move(*writer), scene, options)));
}

SiteLog& BlackBox::log() { return content_->log; }

Expected<BlackBox::Summary> BlackBox::close() {
  content_->end();
  const Expected<void> closed = content_->writer.close();
  if (!closed) return closed.error();
  return Summary{content_->writer.messages(), content_->writer.bytes(), content_->queue.dropped()};
}

}  // namespace pcavr
