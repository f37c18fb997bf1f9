// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "live_room.hpp"

#include <utility>

#include "pcavr/core/check.hpp"

namespace pcavr {
namespace {

/// [s] docs/live-protocol.md: a page that holds the clutch and says nothing is not there any more.
constexpr double kMaxSilence = 0.5;

void copy_bodies(const WorldSnapshot& snapshot, LiveState& state) {
  state.objects.resize(snapshot.world.bodies.size());
  for (std::size_t i = 0; i < state.objects.size(); ++i) {
    const HapticBodyState& body = snapshot.world.bodies[i];
    state.objects[i] = {body.T_base_object.translation().cast<float>(),
                        body.T_base_object.rotation().cast<float>(),
                        body.tool_force_base.cast<float>(),
                        body.phase,
                        body.is_outside_model,
                        static_cast<float>(snapshot.speeds[i])};
  }
}

void copy_world(const WorldSnapshot& snapshot, LiveState& state) {
  state.t = snapshot.t;
  state.is_engaged = snapshot.world.is_engaged;
  state.is_on_hold = snapshot.is_on_hold;
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
}

}  // namespace

LiveRoom::LiveRoom(LiveWorld& world, LiveWelcome welcome, Send send)
    : world_(world), welcome_(std::move(welcome)), send_(std::move(send)) {}

LiveRoom::PageId LiveRoom::join() {
  pages_.emplace(++last_page_, Page{});
  return last_page_;
}

void LiveRoom::leave(PageId page) {
  if (holder_ == page) release_tool();
  pages_.erase(page);
}

bool LiveRoom::is_greeted(PageId page) const { return pages_.at(page).is_greeted; }

template <typename Content>
void LiveRoom::say(PageId page, Content content, double now) {
  send_(page, encode(ServerMessage{{++pages_.at(page).said, now}, std::move(content)}));
}

void LiveRoom::tell(PageId page, LiveLevel level, const std::string& text, double now) {
  say(page, LiveNotice{level, text}, now);
}

bool LiveRoom::hear(PageId id, std::span<const std::uint8_t> bytes, double now) {
  const Expected<PageMessage> message = decode_page_message(bytes);
  if (!message) {
    tell(id, LiveLevel::error, "not understood: " + message.error().message, now);
    return false;
  }
  Page& page = pages_.at(id);
  if (!page.is_greeted) return greet(id, *message, now);
  // Sent twice, or overtaken by a newer one.
  if (message->head.sequence <= page.heard) return true;
  page.heard = message->head.sequence;
  if (const auto* tool = std::get_if<LiveTool>(&message->content)) {
    move_tool(id, message->head, *tool, now);
  } else if (const auto* command = std::get_if<LiveCommand>(&message->content)) {
    obey(id, *command, now);
  } else if (std::holds_alternative<LivePing>(message->content)) {
    say(id, LivePong{message->head.clock}, now);
  }
  return true;
}

bool LiveRoom::greet(PageId id, const PageMessage& message, double now) {
  const auto* hello = std::get_if<LiveHello>(&message.content);
  if (hello == nullptr) {
    tell(id, LiveLevel::error, "the first message has to be a hello", now);
    return false;
  }
  if (hello->protocol != kLiveProtocol) {
    tell(id, LiveLevel::error,
         "this page speaks protocol " + std::to_string(hello->protocol) + ", the server " +
             std::to_string(kLiveProtocol) + " (pcavr " + welcome_.version + "): load it again",
         now);
    return false;
  }
  Page& page = pages_.at(id);
  page.is_greeted = true;
  page.heard = message.head.sequence;
  say(id, welcome_, now);
  return true;
}

void LiveRoom::move_tool(PageId id, const LiveHead& head, const LiveTool& tool, double now) {
  if (holder_ != id) return;
  Page& page = pages_.at(id);
  page.last_tool = now;
  page.is_engaged = tool.is_engaged;
  // What the device leaves out (too early, too far) it counts itself.
  (void)world_.page_device()->push({tool.p_base_tip.cast<double>(),
                                    tool.q_base_tool.cast<double>().normalized(), tool.is_engaged,
                                    head.clock, now, id});
}

void LiveRoom::obey(PageId id, LiveCommand command, double now) {
  const bool may_move = !holder_ || holder_ == id;
  switch (command) {
    case LiveCommand::hold:
      // Whoever sees that something goes wrong may stop it.
      world_.hold(true);
      return;
    case LiveCommand::go_on:
      if (may_move) return world_.hold(false);
      break;
    case LiveCommand::reset:
      if (may_move) return world_.reset();
      break;
    case LiveCommand::take_tool:
      return take_tool(id, now);
    case LiveCommand::give_tool_back:
      if (holder_ == id) release_tool();
      return;
  }
  tell(id, LiveLevel::warning, "another page has the tool", now);
}

void LiveRoom::take_tool(PageId id, double now) {
  if (world_.page_device() == nullptr) {
    tell(id, LiveLevel::warning,
         "the tool is moved by the " + std::string(world_.device_name()) + " at the server", now);
    return;
  }
  if (holder_ && holder_ != id) {
    tell(id, LiveLevel::warning, "another page has the tool", now);
    return;
  }
  if (holder_ == id) return;
  holder_ = id;
  Page& page = pages_.at(id);
  page.last_tool = now;
  page.is_engaged = false;
}

void LiveRoom::release_tool() {
  holder_.reset();
  if (RemoteDevice* device = world_.page_device()) device->let_go();
}

void LiveRoom::look_around(double now) {
  if (!holder_) return;
  const PageId id = *holder_;
  const Page& page = pages_.at(id);
  if (!page.is_engaged || now - page.last_tool <= kMaxSilence) return;
  release_tool();
  tell(id, LiveLevel::warning, "nothing was heard of the tool for 0.5 s: it was let go", now);
}

void LiveRoom::write_state(PageId id, double now, double queue_age,
                           std::vector<std::uint8_t>& bytes) {
  const WorldSnapshot& snapshot = world_.newest();
  copy_world(snapshot, state_);
  const bool is_its_own = snapshot.page.sender == id;
  state_.page_clock =
      is_its_own ? snapshot.page.sender_clock : std::numeric_limits<double>::quiet_NaN();
  state_.has_tool = holder_ == id;
  state_.tool_taken = holder_.has_value() || world_.page_device() == nullptr;
  state_.tool_age = is_its_own ? static_cast<float>(snapshot.page.age + snapshot.page.delay) : 0.0F;
  state_.state_age = static_cast<float>(now - snapshot.published);
  state_.queue_age = static_cast<float>(queue_age);
  encode_state({++pages_.at(id).said, now}, state_, bytes);
}

}  // namespace pcavr
