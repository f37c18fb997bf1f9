// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/core/expected.hpp"
#include "pcavr/prediction/predicted_world.hpp"

namespace pcavr {

/// What page and server say to each other over the WebSocket: `pcavr-live/1`, as
/// docs/live-protocol.md has it to the byte. Base frame, SI. Pure functions: any thread.
inline constexpr int kLiveProtocol = 1;
/// No message of either side may be longer, its head included.
inline constexpr std::size_t kLiveMostBytes = 64 * 1024;

/// What the head of a message says besides its type and length.
struct LiveHead {
  std::uint32_t sequence = 0;  ///< from 1, up
  double clock = 0.0;          ///< [s] the sender's
};

// ---- From the page.

/// The first message. Of another protocol it is read, so that it can be answered.
struct LiveHello {
  int protocol = kLiveProtocol;
  std::string version = {};
};

enum class LiveHand : std::uint8_t { mouse, keyboard, controller, hand };

struct LiveTool {
  Eigen::Vector3f p_base_tip = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Quaternionf q_base_tool = Eigen::Quaternionf::Identity();
  bool is_engaged = false;  ///< the clutch is held
  LiveHand hand = LiveHand::mouse;
};

enum class LiveCommand : std::uint32_t { hold = 1, go_on, reset, take_tool, give_tool_back };

struct LivePing {};

struct PageMessage {
  LiveHead head;
  std::variant<LiveHello, LiveTool, LiveCommand, LivePing> content;
};

/// Refuses, with a clear word, whatever is not such a message from its first byte to its last, or
/// holds a number that is not finite or not in its range. Never throws.
[[nodiscard]] Expected<PageMessage> decode_page_message(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> encode(const PageMessage& message);

// ---- From the server.

struct LiveWelcome {
  int protocol = kLiveProtocol;
  std::string version = {};
  bool is_replay = false;
  std::string scene = {};
  std::vector<std::string> objects = {};
  double tool_radius = 0.01;  ///< [m]
  double rate = 72.0;         ///< [Hz] of the states
  std::string device = {};    ///< what moves the tool
};

struct LiveObject {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< of the object in base [m]
  Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< [N] of the tool on it
  MotionPhase phase = MotionPhase::free;
  bool is_outside_model = false;
  float speed = 0.0F;  ///< [m/s]
};

struct LiveState {
  double t = 0.0;  ///< [s] of the world
  /// [s] that page's clock at the newest tool sample that the world has used; NaN before the first
  double page_clock = std::numeric_limits<double>::quiet_NaN();
  bool is_engaged = false;
  bool is_on_hold = false;
  bool touches_scan = false;
  bool has_tool = false;    ///< the page that it is sent to
  bool tool_taken = false;  ///< somebody has it
  int touched_object = -1;  ///< -1: none
  Eigen::Vector3f p_base_hip = Eigen::Vector3f::Zero();
  Eigen::Vector3f p_base_proxy = Eigen::Vector3f::Zero();
  Eigen::Vector3f force_base = Eigen::Vector3f::Zero();  ///< [N] on the hand
  float pulse = 0.0F;                                    ///< 0 to 1
  std::uint32_t pulses = 0;
  std::uint32_t cycles = 0;
  std::uint32_t late_cycles = 0;
  float cycle_median = 0.0F;   ///< [s]
  float cycle_p99 = 0.0F;      ///< [s]
  float cycle_longest = 0.0F;  ///< [s]
  float tool_age = 0.0F;       ///< [s] of the hand's motion that the tool shows
  float state_age = 0.0F;      ///< [s] of this state when it was sent
  float queue_age = 0.0F;      ///< [s] that the last message waited to go out
  std::vector<LiveObject> objects;
};

enum class LiveLevel { info, warning, error };
struct LiveNotice {
  LiveLevel level = LiveLevel::info;
  std::string text;
};

struct LivePong {
  double clock = 0.0;  ///< [s] that the ping came with
};

struct ServerMessage {
  LiveHead head;
  std::variant<LiveWelcome, LiveState, LiveNotice, LivePong> content;
};

/// As decode_page_message; for clients other than the page.
[[nodiscard]] Expected<ServerMessage> decode_server_message(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> encode(const ServerMessage& message);
/// The same of a state, into a buffer that is used again.
void encode_state(const LiveHead& head, const LiveState& state, std::vector<std::uint8_t>& bytes);

}  // namespace pcavr
