// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "sites/soak/soak_network.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "pcavr/teleoperation/link/link_message.hpp"

namespace pcavr {
namespace {

constexpr std::size_t kMaxFlying = 2000;  // messages: both ends' queues of ZeroMQ
constexpr std::size_t kMaxRecent = 5000;  // messages that can be repeated: of some seconds
constexpr double kCorruptShare = 0.2;
constexpr const char* kIntruderPeer = "intruder";
constexpr std::uint32_t kIntruderSession = 0xBADU;
constexpr std::size_t kSessionAt = 16;  // in a message's header

}  // namespace

void SoakNetwork::send(Direction direction, std::string peer, std::string key,
                       std::span<const std::uint8_t> bytes) {
  if (direction == to_operator && peer != peer_) return;  // of a connection that has ended
  Packet packet{{std::move(peer), std::move(key), {bytes.begin(), bytes.end()}}, now, true};
  remember(direction, packet);
  const LinkConditions::Arrivals arrivals = conditions_[direction].arrivals(now, bytes.size());
  if (now < drop_until_[direction] || flying_[direction].size() >= kMaxFlying) return;
  if (now < corrupt_until_ && random_.uniform() < kCorruptShare) corrupt(packet);
  if (arrivals.second) flying_[direction].push(*arrivals.second, packet);
  if (arrivals.first) flying_[direction].push(*arrivals.first, std::move(packet));
}

/// Cuts, extends or overwrites the bytes so that they are no message of the protocol.
void SoakNetwork::corrupt(Packet& packet) {
  packet.is_genuine = false;
  std::vector<std::uint8_t>& bytes = packet.content.bytes;
  switch (random_.below(4)) {
    case 0:
      bytes.resize(random_.below(bytes.size()));
      break;
    case 1:
      bytes.resize(bytes.size() + 1 + random_.below(3000), 0x5A);
      break;
    case 2:
      bytes[random_.below(4)] ^= static_cast<std::uint8_t>(1 + random_.below(255));
      break;
    default:
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_.below(256));
  }
}

void SoakNetwork::remember(Direction direction, const Packet& packet) {
  recent_[direction].push_back(packet);
  if (recent_[direction].size() > kMaxRecent) recent_[direction].pop_front();
}

void SoakNetwork::replay_one() {
  const Direction direction = kDirections[random_.below(2)];
  if (recent_[direction].empty()) return;
  Packet packet = recent_[direction][random_.below(recent_[direction].size())];
  // One that was lost before is newer than what has arrived: then it counts as a sign of life.
  if (now >= drop_until_[direction]) flying_[direction].push(now, std::move(packet));
}

std::optional<double> SoakNetwork::next_arrival() const {
  std::optional<double> next;
  for (const Direction direction : kDirections) {
    const std::optional<double> arrival = flying_[direction].next_arrival();
    if (!arrival) continue;
    const double t = std::max(*arrival, stall_until_[direction]);
    next = std::min(next.value_or(t), t);
  }
  return next;
}

void SoakNetwork::deliver() {
  for (const Direction direction : kDirections) {
    if (now < stall_until_[direction]) continue;
    while (std::optional<Packet> packet = flying_[direction].pop(now)) {
      const bool is_intruder = packet->content.peer == kIntruderPeer;
      if (!is_running_[direction] || (packet->content.peer != peer_ && !is_intruder)) continue;
      if (inbox_[direction].size() >= kMaxFlying) continue;
      if (direction == to_robot && packet->is_genuine && !is_intruder) {
        checker_.on_delivered(now, packet->sent);
      }
      inbox_[direction].push_back(std::move(packet->content));
    }
  }
}

std::optional<LinkPacket> SoakNetwork::receive(Direction direction) {
  if (inbox_[direction].empty()) return std::nullopt;
  LinkPacket packet = std::move(inbox_[direction].front());
  inbox_[direction].pop_front();
  return packet;
}

void SoakNetwork::set_authorized(const std::string& key, bool is_authorized) {
  if (is_authorized) {
    authorized_.insert(key);
    checker_.authorize(key);
  } else {
    authorized_.erase(key);
    checker_.revoke(now, key);
  }
}

void SoakNetwork::reconnect() {
  peer_ = "operator-" + std::to_string(++connections_);
  for (const Direction direction : kDirections) {
    flying_[direction] = DelayedMessages<Packet>();
    recent_[direction].clear();
  }
}

void SoakNetwork::set_running(Direction direction, bool is_running) {
  is_running_[direction] = is_running;
  inbox_[direction].clear();
  if (!is_running) reconnect();
}

void SoakNetwork::send_as_intruder() {
  LinkMessage message;
  message.header = {++intruder_sequence_, kIntruderSession, now};
  LinkCommand command;
  command.t = now;
  command.p_base_tip = {50.0F, -50.0F, 50.0F};
  command.is_engaged = true;
  switch (random_.below(4)) {
    case 0:
      message.content = LinkHello{"intruder", "intruder"};
      break;
    case 1:
      message.content = LinkStop::reset;
      break;
    default:
      message.content = command;
  }
  // The message gets the operator's session instead of its own, at random.
  if (!recent_[to_robot].empty() && random_.below(2) == 0) {
    const std::vector<std::uint8_t>& bytes = recent_[to_robot].back().content.bytes;
    std::memcpy(&message.header.session, bytes.data() + kSessionAt, sizeof message.header.session);
  }
  Packet packet{{kIntruderPeer, kIntruderKey, encode(message)}, now, false};
  flying_[to_robot].push(now, std::move(packet));
}

}  // namespace pcavr
