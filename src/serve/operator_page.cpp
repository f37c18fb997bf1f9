// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "pcavr/serve/operator_page.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "pcavr/base/core/check.hpp"

#include "live_cycle.hpp"

namespace pcavr {
namespace {

/// The bodies of the present session's world; without a session, as they last were.
class SiteBodies final : public PushedBodies {
 public:
  explicit SiteBodies(const HapticWorldModel& model) : state_(model.world.bodies.size()) {
    for (const WorldBody& body : model.world.bodies) {
      names_.push_back(body.model.name);
      poses_.push_back(body.T_base_object);
    }
  }

  void attach(LiveOperatorSite& site, const Eigen::Vector3d& p_base_tip) {
    site_ = &site;
    p_base_tip_ = p_base_tip;
  }
  void detach() {
    if (site_ == nullptr) return;
    state_ = site_->world().state();
    for (BodyState& body : state_) body.tool_force_base.setZero();
    for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = site_->world().T_base_object(i);
    site_ = nullptr;
  }
  /// [m] Offset by which the site moves the robot's tool, beside its command.
  [[nodiscard]] Eigen::Vector3d tool_offset() const {
    return site_ != nullptr ? site_->tool_offset() : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  /// [m] Tip of the robot's tool, in the session's world.
  [[nodiscard]] const Eigen::Vector3d& p_base_tip() const { return p_base_tip_; }

  [[nodiscard]] std::size_t size() const override { return names_.size(); }
  [[nodiscard]] const std::string& name(std::size_t body) const override { return names_[body]; }
  [[nodiscard]] const std::vector<BodyState>& state() const override {
    return site_ != nullptr ? site_->world().state() : state_;
  }
  [[nodiscard]] Pose T_base_object(std::size_t body) const override {
    return site_ != nullptr ? site_->world().T_base_object(body) : poses_[body];
  }
  [[nodiscard]] Pose shown(std::size_t body) const override {
    return site_ != nullptr ? site_->shown(body).T_base_object : poses_[body];
  }
  [[nodiscard]] bool can_set_state() const override { return false; }
  void set_state(const std::vector<BodyState>&) override {}

  void step(const Eigen::Vector3d&, const Eigen::Vector3d& p_base_tip, double) noexcept override {
    p_base_tip_ = p_base_tip;
    if (site_ != nullptr) site_->step(p_base_tip_);
  }
  /// The robot's tool stays where it was commanded to, not where the proxy is pushed to.
  void rest(const Eigen::Vector3d&, double) noexcept override {
    if (site_ != nullptr) site_->step(p_base_tip_);
  }

 private:
  std::vector<std::string> names_;
  std::vector<BodyState> state_;
  std::vector<Pose> poses_;
  LiveOperatorSite* site_ = nullptr;
  Eigen::Vector3d p_base_tip_ = Eigen::Vector3d::Zero();
};

Expected<void> sort_bodies(const std::vector<std::string>& objects, HapticWorldModel& model) {
  std::vector<WorldBody>& bodies = model.world.bodies;
  std::vector<WorldBody> sorted;
  for (const std::string& name : objects) {
    const auto found = std::find_if(bodies.begin(), bodies.end(),
                                    [&](const WorldBody& body) { return body.model.name == name; });
    if (found == bodies.end()) return Error{.message = name + " is not a body of the scene"};
    sorted.push_back(std::move(*found));
    bodies.erase(found);
  }
  if (!bodies.empty()) {
    return Error{.message = bodies.front().model.name + " is not an object of the site's world"};
  }
  bodies = std::move(sorted);
  return {};
}

}  // namespace

struct OperatorPage::Content {
  enum class Request { none, on, off };
  Content(HapticWorld haptic, SiteBodies& site_bodies, std::unique_ptr<Device> device,
          const LiveWorldOptions& live_options, const MotionLimits& limits,
          std::unique_ptr<LiveArm> arm)
      : bodies(site_bodies),
        options(live_options),
        cycle(std::move(haptic), std::move(device), live_options, std::move(arm)) {
    cycle.limit_motion(limits);
    cycle.link().emplace();
  }

  /// The robot's emergency stop and hold are this site's; they end when the robot's site has ended
  /// them.
  void follow_robot(const OperatorLink& link) {
    if (link.robot == nullptr) return;
    const bool is_stopped = link.robot->is_stopped;
    const bool is_on_hold = link.robot->is_on_hold;
    if (is_stopped && !is_releasing) cycle.emergency_stop();
    if (is_on_hold && !is_resuming) cycle.hold(true);
    if (!is_stopped && std::exchange(is_releasing, false)) cycle.release_emergency_stop();
    if (!is_on_hold && std::exchange(is_resuming, false)) cycle.hold(false);
  }

  void publish_link(const OperatorLink& link) {
    LinkSnapshot& shown = *cycle.link();
    shown.is_connected = link.is_connected;
    shown.silence = link.silence;
    if (link.is_connected) {
      shown.lead = link.lead;
      shown.round_trip = link.round_trip;
      shown.clock_std = link.clock_std;
    }
    if (link.robot != nullptr) shown.robot = *link.robot;
    shown.delays = link.delays;
    shown.picture = picture;
    shown.picture_width = picture_width;
    shown.picture_height = picture_height;
    shown.picture_camera = picture_camera;
    shown.picture_age = picture > 0 ? link.now - picture_t : 0.0;
  }

  /// The device's emergency stop is also the robot's, until a page releases it.
  void stop_robot() {
    const bool is_pressed = cycle.sample().is_stop_pressed;
    if (is_pressed && (!was_stop_pressed || is_releasing)) stop.store(Request::on);
    was_stop_pressed = is_pressed;
  }

  /// One cycle of the device, the tool and the bodies.
  void run(const OperatorLink& link) {
    follow_robot(link);
    publish_link(link);
    const double begin = LiveWorld::clock();
    cycle.step(begin);
    cycle.displace_shown_tool(bodies.tool_offset());
    stop_robot();
    const double end = LiveWorld::clock();
    cycle.publish(end - begin, 0, end);
  }

  [[nodiscard]] std::optional<double> device_clock() {
    if (cycle.page_device() == nullptr) return LiveWorld::clock();
    const double clock = cycle.page_device()->status().shown_clock;
    if (!cycle.sample().is_present || std::isnan(clock)) return std::nullopt;
    return clock;
  }

  SiteBodies& bodies;  ///< the haptic world's
  LiveWorldOptions options;
  LiveCycle cycle;
  std::vector<std::string> notes;
  Eigen::Vector3d p_base_start = Eigen::Vector3d::Zero();
  double last_wait = 0.0;     ///< [s]
  bool is_releasing = false;  ///< the emergency stop, until the robot's site agrees
  bool is_resuming = false;   ///< the same of a hold
  bool was_stop_pressed = false;
  RobotPicture* pictures = nullptr;
  std::uint32_t picture = 0;  ///< number of the newest
  double picture_t = 0.0;     ///< [s] CLOCK_MONOTONIC
  std::uint16_t picture_width = 0;
  std::uint16_t picture_height = 0;
  std::optional<LinkPictureCamera> picture_camera = {};
  std::atomic<Request> stop{Request::none};
  std::atomic<Request> hold{Request::none};
};

OperatorPage::OperatorPage(std::unique_ptr<Content> content) : content_(std::move(content)) {}
OperatorPage::~OperatorPage() = default;

Expected<std::unique_ptr<OperatorPage>> OperatorPage::create(
    HapticWorldModel model, const std::vector<std::string>& objects, std::unique_ptr<Device> device,
    const LiveWorldOptions& options, const MotionLimits& limits, std::unique_ptr<LiveArm> arm) {
  const Expected<void> sorted = sort_bodies(objects, model);
  if (!sorted) return sorted.error();
  auto bodies = std::make_unique<SiteBodies>(model);
  SiteBodies& site_bodies = *bodies;
  Expected<HapticWorld> haptic = HapticWorld::create(model, std::move(bodies));
  if (!haptic) return haptic.error();
  auto content = std::make_unique<Content>(std::move(*haptic), site_bodies, std::move(device),
                                           options, limits, std::move(arm));
  return std::unique_ptr<OperatorPage>(new OperatorPage(std::move(content)));
}

Eigen::Vector3d OperatorPage::p_base_start(std::size_t, const LinkState* robot) {
  content_->p_base_start = robot != nullptr ? robot->p_base_tip.cast<double>().eval()
                                            : content_->options.p_base_tool_start;
  return content_->p_base_start;
}

void OperatorPage::begin(LiveOperatorSite& site) {
  content_->bodies.attach(site, content_->p_base_start);
  content_->cycle.restart(content_->p_base_start);
  content_->cycle.open_clutch();
}

OperatorCommand OperatorPage::step(std::size_t, LiveOperatorSite&, const OperatorLink& link) {
  Content& c = *content_;
  c.run(link);
  return {c.bodies.p_base_tip(), c.cycle.sample().q_base_tool, c.cycle.state().is_engaged,
          c.device_clock()};
}

void OperatorPage::end() {
  content_->bodies.detach();
  content_->cycle.open_clutch();
}

void OperatorPage::wait(const OperatorLink& link) {
  Content& c = *content_;
  if (link.now - c.last_wait < c.options.cycle) return;
  c.last_wait = link.now;
  c.is_releasing = c.is_resuming = false;  // a release needs the robot's answer
  c.cycle.open_clutch();
  c.run(link);
}

void OperatorPage::set_pictures(RobotPicture& pictures) { content_->pictures = &pictures; }

void OperatorPage::show_picture(const LinkPicture& picture, double t) {
  if (content_->pictures == nullptr) return;
  content_->pictures->set(picture, ++content_->picture);
  content_->picture_t = t;
  content_->picture_width = picture.width;
  content_->picture_height = picture.height;
  content_->picture_camera = picture.camera;
}

OperatorRequests OperatorPage::take_requests() {
  using Request = Content::Request;
  const auto wanted = [](std::atomic<Request>& request) -> std::optional<bool> {
    const Request taken = request.exchange(Request::none, std::memory_order_relaxed);
    if (taken == Request::none) return std::nullopt;
    return taken == Request::on;
  };
  const OperatorRequests requests{wanted(content_->stop), wanted(content_->hold)};
  if (requests.is_stopped) content_->is_releasing = !*requests.is_stopped;
  if (requests.is_on_hold) content_->is_resuming = !*requests.is_on_hold;
  return requests;
}

const std::vector<std::string>& OperatorPage::notes() const { return content_->notes; }
const std::vector<std::string>& OperatorPage::names() const { return content_->cycle.names(); }
std::string_view OperatorPage::device_name() const { return content_->cycle.device().name(); }
RemoteDevice* OperatorPage::page_device() noexcept { return content_->cycle.page_device(); }

void OperatorPage::hold(bool is_on_hold) noexcept {
  // The release of a stop ends on hold: no earlier request may resume it.
  if (!is_on_hold && content_->cycle.is_stopped()) return;
  if (is_on_hold) content_->cycle.hold(true);
  content_->hold.store(is_on_hold ? Content::Request::on : Content::Request::off,
                       std::memory_order_relaxed);
}

void OperatorPage::emergency_stop() noexcept {
  content_->cycle.emergency_stop();
  content_->stop.store(Content::Request::on, std::memory_order_relaxed);
}

void OperatorPage::release_emergency_stop() noexcept {
  content_->stop.store(Content::Request::off, std::memory_order_relaxed);
}

const WorldSnapshot& OperatorPage::newest() noexcept { return content_->cycle.newest(); }

}  // namespace pcavr
