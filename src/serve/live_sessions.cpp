// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "live_sessions.hpp"

#include <limits>
#include <utility>

#include <fmt/format.h>

#include "pcavr/base/core/check.hpp"
#include "pcavr/serve/page_recorder.hpp"

namespace pcavr {
namespace {

constexpr double kMinReset = 0.5e-3;  // [m] less is not seen

void copy_bodies(const WorldSnapshot& snapshot, LiveState& state) {
  state.objects.resize(snapshot.world.bodies.size());
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const HapticBodyState& body = snapshot.world.bodies[i];
    state.objects[i] = {body.T_base_object.translation().cast<float>(),
                        body.T_base_object.rotation().cast<float>(),
                        body.tool_force_base.cast<float>(),
                        body.phase,
                        body.is_outside_model,
                        body.is_blocked,
                        body.is_saturated,
                        static_cast<float>(snapshot.speeds[i])};
  }
}

void copy_arm(const WorldSnapshot& snapshot, bool has_scan, LiveState& state) {
  if (!snapshot.arm) return;
  if (!state.arm) state.arm.emplace();
  const ArmState& arm = *snapshot.arm;
  state.arm->position.resize(static_cast<std::size_t>(arm.q.size()));
  for (std::size_t i = 0; i < state.arm->position.size(); ++i) {
    state.arm->position[i] = static_cast<float>(arm.q[static_cast<Eigen::Index>(i)]);
  }
  state.arm->is_stopped = arm.is_stopped;
  state.arm->is_reached = arm.is_reached;
  state.arm->nearest.reset();
  if (!arm.nearest) return;
  state.arm->nearest = LiveArmState::Nearest{static_cast<float>(arm.nearest->distance),
                                             static_cast<std::uint32_t>(arm.nearest->link),
                                             {},
                                             {}};
  if (arm.nearest->other_link) {
    state.arm->nearest->other_link = static_cast<std::uint32_t>(*arm.nearest->other_link);
  }
  const std::size_t first_body = has_scan ? 1 : 0;
  if (arm.nearest->surface && *arm.nearest->surface >= first_body) {
    state.arm->nearest->object = static_cast<std::uint32_t>(*arm.nearest->surface - first_body);
  }
}

LiveLinkState::Robot robot_of(const LinkState& robot) {
  LiveLinkState::Robot result;
  result.is_on_hold = robot.is_on_hold;
  result.is_stopped = robot.is_stopped;
  result.limits = robot.limits;
  result.corrections = robot.corrections;
  result.p_base_tip = robot.p_base_tip;
  result.force_base = robot.force_base;
  for (const LinkTrackedObject& object : robot.objects) {
    result.objects.push_back({object.position, object.orientation, object.age, object.is_tracked});
  }
  return result;
}

void copy_link(const WorldSnapshot& snapshot, bool is_from_page, LiveState& state) {
  state.link.reset();
  if (!snapshot.link) return;
  const LinkSnapshot& link = *snapshot.link;
  LiveLinkState& shown = state.link.emplace();
  shown.is_connected = link.is_connected;
  shown.silence = static_cast<float>(link.silence);
  shown.lead = static_cast<float>(link.lead);
  shown.round_trip = static_cast<float>(link.round_trip);
  shown.clock_std = static_cast<float>(link.clock_std);
  if (link.robot && link.robot->objects.size() == snapshot.world.bodies.size()) {
    shown.robot = robot_of(*link.robot);
  }
  shown.picture = link.picture;
  shown.picture_age = static_cast<float>(link.picture_age);
  shown.delays = link.delays;
  // The hand's clock is that of the page that moves it.
  if (shown.delays && !is_from_page) shown.delays->device_clock.reset();
}

void copy_world(const WorldSnapshot& snapshot, LiveState& state) {
  state.t = snapshot.t;
  state.is_engaged = snapshot.world.is_engaged;
  state.can_undo_reset = snapshot.world.can_undo_reset;
  state.is_on_hold = snapshot.is_on_hold;
  state.is_stopped = snapshot.is_stopped;
  state.time_scale = snapshot.time_scale;
  state.touches_scan = snapshot.world.touches_scan;
  state.touched_object = snapshot.world.touched_body;
  state.p_base_hip = snapshot.world.p_base_hip.cast<float>();
  state.p_base_proxy = snapshot.world.p_base_proxy.cast<float>();
  state.force_base = snapshot.world.force_base.cast<float>();
  state.pulse = static_cast<float>(snapshot.pulse);
  state.pulses = snapshot.pulses;
  state.cycles = snapshot.cycles;
  state.late_cycles = snapshot.late_cycles;
  state.cycle_median = static_cast<float>(snapshot.times.median);
  state.cycle_p99 = static_cast<float>(snapshot.times.p99);
  state.cycle_longest = static_cast<float>(snapshot.times.longest);
  copy_bodies(snapshot, state);
  copy_arm(snapshot, snapshot.arm_meets_scan, state);
}

}  // namespace

LiveSessions::LiveSessions(PageWorld& world, LiveWelcome welcome, Send send, double tool_timeout,
                           double tool_idle_time)
    : world_(world),
      welcome_(std::move(welcome)),
      send_(std::move(send)),
      tool_timeout_(tool_timeout),
      tool_(tool_timeout, tool_idle_time) {
  welcome_.can_record = world_.recorder() != nullptr;
  for (const HapticBodyState& body : world_.newest().world.bodies) {
    starts_.push_back(body.T_base_object.translation());
  }
}

LiveSessions::PageId LiveSessions::join() {
  pages_.emplace(++last_page_, Page{});
  return last_page_;
}

void LiveSessions::leave(PageId page) {
  if (tool_.leave(page)) release_device();
  pages_.erase(page);
}

bool LiveSessions::has_sent_hello(PageId page) const { return pages_.at(page).has_sent_hello; }

template <typename Content>
void LiveSessions::send(PageId page, Content content, double now) {
  send_(page, encode(ServerMessage{{++pages_.at(page).last_sent, now}, std::move(content)}));
}

void LiveSessions::send_notice(PageId page, LiveLevel level, const std::string& text, double now) {
  send(page, LiveNotice{level, text}, now);
}

bool LiveSessions::on_message(PageId id, std::span<const std::uint8_t> bytes, double now) {
  const Expected<PageMessage> message = decode_page_message(bytes);
  if (!message) {
    send_notice(id, LiveLevel::error, "invalid message: " + message.error().message, now);
    return false;
  }
  Page& page = pages_.at(id);
  if (!page.has_sent_hello) return on_hello(id, *message, now);
  // A duplicate, or older than one already received.
  if (message->header.sequence <= page.last_received) return true;
  page.last_received = message->header.sequence;
  if (const auto* tool = std::get_if<LiveTool>(&message->content)) {
    move_tool(id, message->header, *tool, now);
  } else if (const auto* command = std::get_if<LiveCommand>(&message->content)) {
    handle_command(id, *command, now);
  } else if (std::holds_alternative<LivePing>(message->content)) {
    send(id, LivePong{message->header.clock}, now);
  }
  return true;
}

bool LiveSessions::on_hello(PageId id, const PageMessage& message, double now) {
  const auto* hello = std::get_if<LiveHello>(&message.content);
  if (hello == nullptr) {
    send_notice(id, LiveLevel::error, "the first message must be a hello", now);
    return false;
  }
  if (hello->protocol != kLiveProtocolVersion) {
    send_notice(id, LiveLevel::error,
                "this page uses protocol " + std::to_string(hello->protocol) + ", the server " +
                    std::to_string(kLiveProtocolVersion) + " (pcavr " + welcome_.version +
                    "): reload the page",
                now);
    return false;
  }
  Page& page = pages_.at(id);
  page.has_sent_hello = true;
  page.last_received = message.header.sequence;
  send(id, welcome_, now);
  for (const std::string& note : world_.notes()) send_notice(id, LiveLevel::info, note, now);
  return true;
}

void LiveSessions::move_tool(PageId id, const LiveHeader& header, const LiveTool& tool,
                             double now) {
  if (!tool_.is_held_by(id)) return;
  tool_.use(tool.is_engaged, now);
  // The device counts the samples that it rejects (too early, too far away).
  (void)world_.page_device()->push({tool.p_base_tip.cast<double>(),
                                    tool.q_base_tool.cast<double>().normalized(), tool.is_engaged,
                                    header.clock, now, id});
}

void LiveSessions::handle_command(PageId id, LiveCommand command, double now) {
  const bool has_control = !tool_.holder() || tool_.is_held_by(id);
  switch (command) {
    case LiveCommand::hold:
      // Every page may stop the tool, for safety.
      world_.hold(true);
      return;
    case LiveCommand::resume:
      if (has_control) return world_.hold(false);
      break;
    case LiveCommand::reset:
      if (has_control) return reset(id, now);
      break;
    case LiveCommand::emergency_stop:
      // Any page, whether it has the tool or not.
      if (!world_.newest().is_stopped) {
        send_notice_to_all(LiveLevel::error, "emergency stop: the tool stays where it is", now);
      }
      world_.emergency_stop();
      return;
    case LiveCommand::release_stop:
      if (has_control) return world_.release_emergency_stop();
      break;
    case LiveCommand::undo_reset:
      if (has_control) return undo_reset(now);
      break;
    case LiveCommand::take_tool:
      return take_tool(id, now);
    case LiveCommand::release_tool:
      if (tool_.release(id)) release_device();
      return;
    case LiveCommand::hand_over_tool:
      if (const auto change = tool_.hand_over(id, now)) notify_change(*change, now);
      return;
    case LiveCommand::keep_tool:
      return keep_tool(id, now);
    case LiveCommand::start_recording:
    case LiveCommand::stop_recording:
      if (has_control) return record(id, command == LiveCommand::start_recording, now);
      break;
    case LiveCommand::slower:
    case LiveCommand::faster:
      if (has_control) return change_time_scale(command == LiveCommand::faster);
      break;
  }
  send_notice(id, LiveLevel::warning, "another page has the tool", now);
}

/// Resets the world, and states what that moved.
void LiveSessions::reset(PageId id, double now) {
  if (world_.is_remote()) {
    return send_notice(id, LiveLevel::warning, "the objects at the robot's site can't be put back",
                       now);
  }
  const WorldSnapshot& before = world_.newest();
  std::string moved;
  for (std::size_t i = 0; i < before.world.bodies.size(); ++i) {
    const double distance =
        (before.world.bodies[i].T_base_object.translation() - starts_[i]).norm();
    if (distance < kMinReset) continue;
    moved += fmt::format("{}{} ({:.0f} mm)", moved.empty() ? "" : ", ", welcome_.objects.at(i),
                         1e3 * distance);
  }
  world_.reset();
  send_notice_to_all(LiveLevel::info,
                     moved.empty() ? "reset: nothing had moved" : "back at the start: " + moved,
                     now);
}

void LiveSessions::undo_reset(double now) {
  if (!world_.newest().world.can_undo_reset) return;
  world_.undo_reset();
  send_notice_to_all(LiveLevel::info, "reset undone: the objects are where they were", now);
}

void LiveSessions::record(PageId id, bool is_wanted, double now) {
  PageRecorder* const recorder = world_.recorder();
  if (recorder == nullptr) {
    return send_notice(id, LiveLevel::warning, "this server records no sessions for a page", now);
  }
  is_wanted ? recorder->start() : recorder->stop();
}

void LiveSessions::send_notice_to_all(LiveLevel level, const std::string& text, double now,
                                      const std::string& about) {
  for (const auto& [page, state] : pages_) {
    if (state.has_sent_hello) send(page, LiveNotice{level, text, about}, now);
  }
}

/// Changes to the next of kTimeScales; a scale that the command line gave may lie between two.
void LiveSessions::change_time_scale(bool is_faster) {
  constexpr double kSame = 1e-6;
  const double now = world_.time_scale();
  double next = now;
  for (const double scale : kTimeScales) {
    if (is_faster && scale > now + kSame) return world_.set_time_scale(scale);
    if (!is_faster && scale < now - kSame) next = scale;
  }
  world_.set_time_scale(next);
}

void LiveSessions::take_tool(PageId id, double now) {
  if (world_.page_device() == nullptr) {
    send_notice(id, LiveLevel::warning,
                "the tool is moved by the " + std::string(world_.device_name()) + " at the server",
                now);
    return;
  }
  const std::optional<PageId> previous = tool_.holder();
  switch (tool_.request(id, now)) {
    case ToolAssignment::Answer::given:
      if (previous != id) on_change({ToolAssignment::Change::Reason::idle, previous, id}, now);
      return;
    case ToolAssignment::Answer::asked:
      send_notice(
          id, LiveLevel::info,
          fmt::format("asked for the tool: another page has it, and hands it over, or loses "
                      "it after {} s with its clutch open",
                      tool_.idle_time()),
          now);
      return;
    case ToolAssignment::Answer::refused_before:
      send_notice(id, LiveLevel::warning,
                  fmt::format("another page has refused to hand over the tool: ask again in {} s",
                              tool_.idle_time()),
                  now);
      return;
    case ToolAssignment::Answer::already_asked:
      return;
  }
}

void LiveSessions::keep_tool(PageId id, double now) {
  for (const PageId page : tool_.refuse(id, now)) {
    send_notice(page, LiveLevel::warning, "the page that has the tool keeps it", now);
  }
}

void LiveSessions::on_change(const ToolAssignment::Change& change, double now) {
  using Reason = ToolAssignment::Change::Reason;
  release_device();
  if (change.from && change.reason == Reason::idle) {
    send_notice(*change.from, LiveLevel::info,
                fmt::format("not used for {} s, the tool went to another page that requested it",
                            tool_.idle_time()),
                now);
  }
  if (change.from && change.reason == Reason::silent) {
    send_notice(
        *change.from, LiveLevel::warning,
        fmt::format("no tool motion received for {} s: the tool was released", tool_timeout_), now);
  }
}

void LiveSessions::notify_change(const ToolAssignment::Change& change, double now) {
  on_change(change, now);
  if (change.to) send_notice(*change.to, LiveLevel::info, "this page now has the tool", now);
}

void LiveSessions::release_device() {
  if (RemoteDevice* device = world_.page_device()) device->release();
}

void LiveSessions::check_timeouts(double now) {
  while (const auto change = tool_.update(now)) notify_change(*change, now);
  PageRecorder* const recorder = world_.recorder();
  if (recorder == nullptr) return;
  while (const auto message = recorder->take_message()) {
    const LiveLevel level = message->is_error ? LiveLevel::error : LiveLevel::info;
    send_notice_to_all(level, message->text, now, "recording");
  }
}

void LiveSessions::write_state(PageId id, double now, double queue_age,
                               std::vector<std::uint8_t>& bytes) {
  const WorldSnapshot& snapshot = world_.newest();
  copy_world(snapshot, state_);
  const bool is_from_page = snapshot.page.sender == id;
  copy_link(snapshot, is_from_page, state_);
  state_.page_clock =
      is_from_page ? snapshot.page.sender_clock : std::numeric_limits<double>::quiet_NaN();
  state_.has_tool = tool_.is_held_by(id);
  state_.tool_taken =
      state_.has_tool || tool_.is_used_by_another(id, now) || world_.page_device() == nullptr;
  state_.is_tool_wanted = state_.has_tool && tool_.is_asked_for();
  state_.has_asked = tool_.has_asked(id);
  state_.is_recording = world_.recorder() != nullptr && world_.recorder()->is_recording();
  state_.tool_age =
      is_from_page ? static_cast<float>(snapshot.page.age + snapshot.page.delay) : 0.0F;
  state_.state_age = static_cast<float>(now - snapshot.published);
  state_.queue_age = static_cast<float>(queue_age);
  encode_state({++pages_.at(id).last_sent, now}, state_, bytes);
}

}  // namespace pcavr
