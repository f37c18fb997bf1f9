// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/link/delay_stages.hpp"

namespace pcavr {

/// Messages between page and server over the WebSocket: `pcavr-live/1`; docs/live-protocol.md
/// specifies each byte. Base frame, SI. Pure functions: any thread.
inline constexpr int kLiveProtocolVersion = 1;
/// Maximum length of a message of either side, its header included.
inline constexpr std::size_t kMaxLiveMessageBytes = 64 * 1024;

/// The header of a message, without its type and length.
struct LiveHeader {
  std::uint32_t sequence = 0;  ///< counts up from 1
  double clock = 0.0;          ///< [s] of the sender
};

// ---- From the page.

/// The first message. One of another protocol version is decoded too, so that it can be answered.
struct LiveHello {
  int protocol = kLiveProtocolVersion;
  std::string version = {};
};

enum class LiveInputDevice : std::uint8_t { mouse, keyboard, controller, hand };

struct LiveTool {
  Eigen::Vector3f p_base_tip = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Quaternionf q_base_tool = Eigen::Quaternionf::Identity();
  bool is_engaged = false;  ///< the clutch is closed
  LiveInputDevice device = LiveInputDevice::mouse;
};

enum class LiveCommand : std::uint32_t {
  hold = 1,
  resume,
  reset,
  take_tool,
  release_tool,
  slower,  ///< the next slower of kTimeScales
  faster,
  emergency_stop,   ///< the tool is disengaged and stays where it is
  release_stop,     ///< of the emergency stop: the world is then on hold
  undo_reset,       ///< until a body is touched
  hand_over_tool,   ///< to the first page that has asked for it
  keep_tool,        ///< refuses those that have asked for it
  start_recording,  ///< into a folder of its own, which a notice names
  stop_recording
};
/// Time scales that pages choose from.
inline constexpr double kTimeScales[] = {0.1, 0.25, 0.5, 1.0};

struct LivePing {};

struct PageMessage {
  LiveHeader header;
  std::variant<LiveHello, LiveTool, LiveCommand, LivePing> content;
};

/// An Error with the reason if the bytes are not exactly one message, or contain a number that is
/// not finite or out of range. Never throws.
[[nodiscard]] Expected<PageMessage> decode_page_message(std::span<const std::uint8_t> bytes);
[[nodiscard]] std::vector<std::uint8_t> encode(const PageMessage& message);

// ---- From the server.

struct LiveWelcome {
  int protocol = kLiveProtocolVersion;
  std::string version = {};
  bool is_replay = false;
  std::string scene = {};
  std::vector<std::string> objects = {};
  double tool_radius = 0.01;  ///< [m]
  double rate = 72.0;         ///< [Hz] at which states are sent
  std::string device = {};    ///< name of the device that moves the tool
  bool can_record = false;    ///< at a page's request
};

struct LiveObject {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< of the object in base [m]
  Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
  Eigen::Vector3f force = Eigen::Vector3f::Zero();  ///< [N] of the tool on it
  MotionPhase phase = MotionPhase::free;
  bool is_outside_model = false;
  bool is_blocked = false;    ///< see HapticBodyState
  bool is_saturated = false;  ///< see HapticBodyState
  float speed = 0.0F;         ///< [m/s]
};

/// The arm, in a state.
struct LiveArmState {
  std::vector<float> position;  ///< of its joints [rad or m]
  bool is_stopped = false;      ///< before a collision
  bool is_reached = false;      ///< the tip is at the tool
  /// The nearest two things, within the distance that the server measures.
  struct Nearest {
    float distance = 0.0F;  ///< [m]
    std::uint32_t link = 0;
    std::optional<std::uint32_t> other_link;
    std::optional<std::uint32_t> object;  ///< neither of these two: the scan
  };
  std::optional<Nearest> nearest;
};

/// The link to a robot's site, in a state of an operator's site.
struct LiveLinkState {
  bool is_connected = false;
  float silence = 0.0F;     ///< [s] since a message from the robot's site
  float lead = 0.0F;        ///< [s] by which the shown world is ahead of the robot's
  float round_trip = 0.0F;  ///< [s]
  float clock_std = 0.0F;   ///< [s]
  struct Object {
    Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< as tracked, in base [m]
    Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
    float age = 0.0F;  ///< [s] of the frame
    bool is_tracked = false;
  };
  struct Robot {
    bool is_on_hold = false;
    bool is_stopped = false;
    std::uint32_t limits = 0;                              ///< LinkLimit bits
    std::uint32_t corrections = 0;                         ///< sent so far
    Eigen::Vector3f p_base_tip = Eigen::Vector3f::Zero();  ///< as measured [m]
    Eigen::Vector3f force_base = Eigen::Vector3f::Zero();  ///< that its tool exerts [N]
    std::vector<Object> objects;  ///< as many as the state has: required for encoding
  };
  std::optional<Robot> robot;
  /// Stamps on the server's clock, except device_clock, which is on the receiving page's.
  std::optional<DelayStamps> delays;
  std::uint32_t picture = 0;  ///< number of the newest one of the robot's camera; 0: none
  float picture_age = 0.0F;   ///< [s]
};

struct LiveState {
  double t = 0.0;  ///< [s] simulation time
  /// [s] the page's clock at the newest tool sample that the world has used; NaN before the first
  double page_clock = std::numeric_limits<double>::quiet_NaN();
  bool is_engaged = false;
  bool is_on_hold = false;
  bool is_stopped = false;  ///< emergency stop
  double time_scale = 1.0;  ///< simulated over real time; whole per cents
  bool touches_scan = false;
  bool has_tool = false;    ///< the receiving page has the tool
  bool tool_taken = false;  ///< some page or device has it
  bool can_undo_reset = false;
  bool is_tool_wanted = false;  ///< the receiving page has the tool, and another one asks for it
  bool has_asked = false;       ///< the receiving page has asked for the tool
  bool is_recording = false;    ///< as a page has requested
  std::optional<std::size_t> touched_object;
  Eigen::Vector3f p_base_hip = Eigen::Vector3f::Zero();
  Eigen::Vector3f p_base_proxy = Eigen::Vector3f::Zero();
  Eigen::Vector3f force_base = Eigen::Vector3f::Zero();  ///< [N] rendered force on the hand
  float pulse = 0.0F;                                    ///< vibration amplitude, 0 to 1
  std::uint32_t pulses = 0;
  std::uint32_t cycles = 0;
  std::uint32_t late_cycles = 0;
  float cycle_median = 0.0F;   ///< [s]
  float cycle_p99 = 0.0F;      ///< [s]
  float cycle_longest = 0.0F;  ///< [s]
  float tool_age = 0.0F;       ///< [s] age of the hand motion that the tool's pose shows
  float state_age = 0.0F;      ///< [s] age of this state when it was sent
  float queue_age = 0.0F;      ///< [s] that the last message took to be sent
  std::vector<LiveObject> objects;
  std::optional<LiveArmState> arm;
  std::optional<LiveLinkState> link;
};

enum class LiveLevel { info, warning, error };
struct LiveNotice {
  LiveLevel level = LiveLevel::info;
  std::string text;
  std::string about = {};  ///< "recording": where a recording goes or went; else empty
};

struct LivePong {
  double clock = 0.0;  ///< [s] clock of the ping
};

struct ServerMessage {
  LiveHeader header;
  std::variant<LiveWelcome, LiveState, LiveNotice, LivePong> content;
};

[[nodiscard]] std::vector<std::uint8_t> encode(const ServerMessage& message);
/// Encodes a state into a buffer that is reused.
void encode_state(const LiveHeader& header, const LiveState& state,
                  std::vector<std::uint8_t>& bytes);

}  // namespace pcavr
