// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/teleoperation/devices/space_mouse_device.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <optional>
#include <string>
#include <thread>

#include <poll.h>
#include <spnav.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "pcavr/base/core/check.hpp"

#include "teleoperation/devices/newest.hpp"
#include "teleoperation/devices/rate_tip.hpp"
#include "teleoperation/devices/stop_button.hpp"

namespace pcavr {
namespace {

constexpr int kLeftButton = 0;

Eigen::Vector3d deflection_of(const spnav_event_motion& motion, double full_deflection) {
  // The daemon's x is to the right, y up, z away from the operator.
  return Eigen::Vector3d(motion.z, -motion.x, motion.y) / full_deflection;
}

/// libspnav has one connection, in global variables: one instance at a time.
class Connection {
 public:
  Connection() : was_taken_(is_taken_.exchange(true)) {
    if (was_taken_) return;
    is_open_ = spnav_open() == 0;
    if (!is_open_) is_taken_ = false;
  }
  ~Connection() {
    if (!is_open_) return;
    spnav_close();
    is_taken_ = false;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] bool was_taken() const { return was_taken_; }

 private:
  inline static std::atomic<bool> is_taken_{false};
  bool was_taken_;
  bool is_open_ = false;
};

/// The product's name; empty if the daemon has no device. Motion events at the same time corrupt
/// libspnav's replies, so retries.
std::optional<std::string> product_name() {
  std::array<char, 64> name{};
  for (int attempt = 0; attempt < 3; ++attempt) {
    if (spnav_dev_name(name.data(), static_cast<int>(name.size()) - 1) >= 0) return name.data();
  }
  return std::nullopt;
}

bool has_ended(int socket) {
  char byte = 0;
  const ssize_t count = recv(socket, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

}  // namespace

struct SpaceMouseDevice::Content {
  Content(const SpaceMouseOptions& options, const RateOptions& rate)
      : full_deflection(options.full_deflection), stop_button(options.stop_button), tip(rate) {}
  ~Content() {
    if (reader.joinable()) {
      eventfd_write(wake, 1);
      reader.join();
    }
    if (wake >= 0) ::close(wake);
  }
  Content(const Content&) = delete;
  Content& operator=(const Content&) = delete;

  void read() noexcept;
  void process(const spnav_event& event) noexcept;

  Connection connection;  // closed after the thread has ended
  std::string name = "SpaceMouse";
  double full_deflection;  ///< [counts]
  int stop_button;
  RateTip tip;
  Newest<RateCommand> newest;
  StopButton stop;
  RateCommand command{.is_present = true};  ///< of the thread
  int wake = eventfd(0, EFD_CLOEXEC);       ///< ends the thread
  std::thread reader;
};

void SpaceMouseDevice::Content::process(const spnav_event& event) noexcept {
  if (event.type == SPNAV_EVENT_MOTION) {
    command.deflection = deflection_of(event.motion, full_deflection);
  }
  if (event.type == SPNAV_EVENT_BUTTON && event.button.bnum == kLeftButton) {
    command.is_engaged = event.button.press != 0;
  }
  if (event.type == SPNAV_EVENT_BUTTON && event.button.bnum == stop_button) {
    stop.set(event.button.press != 0);
  }
  if (event.type == SPNAV_EVENT_DEV) {
    stop.set(false);
    command = {.is_present = event.dev.op == SPNAV_DEV_ADD};
  }
  newest.put(command);
}

void SpaceMouseDevice::Content::read() noexcept {
  newest.put(command);
  std::array<pollfd, 2> files{{{spnav_fd(), POLLIN, 0}, {wake, POLLIN, 0}}};
  for (;;) {
    if (poll(files.data(), files.size(), -1) < 0) continue;
    if (files[1].revents != 0) return;
    if (has_ended(files[0].fd)) break;
    spnav_event event;
    if (spnav_poll_event(&event) != 0) process(event);
  }
  stop.set(false);
  newest.put({});
}

SpaceMouseDevice::SpaceMouseDevice(std::unique_ptr<Content> content)
    : content_(std::move(content)) {}

SpaceMouseDevice::~SpaceMouseDevice() = default;

Expected<std::unique_ptr<SpaceMouseDevice>> SpaceMouseDevice::open(const SpaceMouseOptions& options,
                                                                   const RateOptions& rate) {
  PCAVR_REQUIRE(std::isfinite(options.full_deflection) && options.full_deflection > 0.0,
                options.full_deflection);
  PCAVR_REQUIRE(options.stop_button != kLeftButton, options.stop_button);
  auto content = std::make_unique<Content>(options, rate);
  if (content->connection.was_taken()) {
    return Error{.message = "the SpaceMouse is already open", .hint = "use the open device"};
  }
  if (!content->connection.is_open()) {
    return Error{.message = "no SpaceMouse: can't connect to its daemon, spacenavd",
                 .hint =
                     "apt-get install spacenavd and start it, or set its socket in the "
                     "environment variable SPNAV_SOCKET"};
  }
  // Daemons before 1.0 (protocol 0) have no such request.
  if (spnav_protocol() >= 1) {
    const std::optional<std::string> product = product_name();
    if (!product) {
      return Error{.message = "no SpaceMouse: its daemon, spacenavd, reports no device",
                   .hint = "plug it in"};
    }
    content->name += " (" + *product + ")";
  }
  content->reader = std::thread([own = content.get()] { own->read(); });
  return std::unique_ptr<SpaceMouseDevice>(new SpaceMouseDevice(std::move(content)));
}

std::string_view SpaceMouseDevice::name() const noexcept { return content_->name; }

DeviceSample SpaceMouseDevice::exchange(double /*t*/, double dt,
                                        const DeviceFeedback& feedback) noexcept {
  DeviceSample sample = content_->tip.step(content_->newest.get(), dt, feedback.p_base_tool);
  sample.is_stop_pressed = content_->stop.take();
  return sample;
}

}  // namespace pcavr
