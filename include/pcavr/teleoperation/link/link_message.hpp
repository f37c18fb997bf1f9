// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pcavr/base/core/expected.hpp"
#include "pcavr/base/geometry/lens.hpp"
#include "pcavr/physics/prediction/predicted_world.hpp"
#include "pcavr/teleoperation/link/tip_response.hpp"

namespace pcavr {

/// Messages between the operator's and the robot's site: `pcavr-link/6`; docs/link.md specifies
/// each byte. Base frame, SI; "shared clock" is the clock of the robot's site, see LinkClock. Pure
/// functions: any thread.
inline constexpr int kLinkVersion = 6;
/// Maximum length of a message, its header included; of a picture kMaxLinkPictureBytes.
inline constexpr std::size_t kMaxLinkMessageBytes = 64 * 1024;
inline constexpr std::size_t kMaxLinkPictureBytes = 1024 * 1024;
/// Largest length of a name, a version or a notice [bytes of UTF-8].
inline constexpr std::size_t kMaxLinkTextBytes = 256;
/// Largest number of objects: a correction has one byte for the index of its object.
inline constexpr std::size_t kMaxLinkObjects = 255;
/// Largest size of one correction [bytes].
inline constexpr std::size_t kMaxLinkCorrectionBytes = 256;

/// The header of a message, without its type and length.
struct LinkHeader {
  std::uint32_t sequence = 0;  ///< counts up from 1 in each direction of a session
  std::uint32_t session = 0;   ///< chosen by the operator's site, 0 before it is known
  double clock = 0.0;          ///< [s] of the sender
};

/// The first message of the operator's site, and again after each interruption.
struct LinkHello {
  std::string version = {};  ///< of the program
  std::string name = {};     ///< of the operator's site, for the robot's log
};

struct LinkWelcome {
  double start = 0.0;            ///< [s] shared clock: time zero of the scene
  double tool_radius = 0.0;      ///< [m]
  bool follows_commands = true;  ///< false: a recording
  std::string version = {};
  std::string scene = {};
  std::vector<std::string> objects = {};
};

enum class LinkRejection : std::uint32_t { other_version = 1, other_scene, busy, revoked, ended };
/// The answer to a hello that is not accepted, or the end of a session.
struct LinkReject {
  LinkRejection reason = LinkRejection::other_version;
  std::string text = {};
};

/// A round trip for the clock: header.clock is t1 of [RFC 5905, section 8].
struct LinkPing {};
struct LinkPong {
  double sent = 0.0;      ///< [s] t1, the clock of the ping
  double received = 0.0;  ///< [s] t2; t3 is header.clock
};

/// Prediction of the operator's site for one object at the time of execution.
struct LinkPrediction {
  Eigen::Vector3f pose = Eigen::Vector3f::Zero();            ///< x [m], y [m], yaw [rad]
  Eigen::Vector3f force = Eigen::Vector3f::Zero();           ///< of the tip on it [N]
  Eigen::Vector3f rendered_force = Eigen::Vector3f::Zero();  ///< the same after blending [N]
  MotionPhase phase = MotionPhase::free;
  std::uint8_t received = 0;  ///< CorrectionMessage::sequence of its newest correction
};

/// Corrections that have arrived: all up to `up_to`, and up_to + 2 + i if bit i is set.
struct LinkAcknowledgement {
  std::uint32_t up_to = 0;
  std::uint32_t later = 0;
};

struct LinkCommand {
  double t = 0.0;  ///< [s] shared clock: time of execution
  Eigen::Vector3f p_base_tip = Eigen::Vector3f::Zero();
  Eigen::Quaternionf q_base_tool = Eigen::Quaternionf::Identity();
  bool is_engaged = false;  ///< the clutch is closed: the tool shall follow
  LinkAcknowledgement acknowledged = {};
  /// [s] from the composition of a correction to the first command that contains it; 0: unknown.
  float correction_delay = 0.0F;
  std::vector<LinkPrediction> predictions = {};  ///< by object
};

/// Limits of the robot's site, bits of LinkState::limits.
enum class LinkLimit : std::uint32_t {
  workspace = 1,
  step = 2,
  speed = 4,
  acceleration = 8,
  force = 16,
};

struct LinkTrackedObject {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< in base [m]
  Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
  float position_std = 0.0F;  ///< along one axis [m]
  float age = 0.0F;           ///< [s] of the newest frame that shows it
  MotionPhase phase = MotionPhase::free;
  bool is_tracked = false;
};

struct LinkState {
  double t = 0.0;         ///< [s] shared clock of the newest sample in it
  double executed = 0.0;  ///< [s] time of execution of the newest command applied before t
  double received = 0.0;  ///< [s] shared clock at which that command arrived
  double applied = 0.0;   ///< [s] and at which it became the setpoint
  float lead = 0.0F;      ///< [s] smallest time, of late, from a command's arrival to its execution
  std::uint32_t limits = 0;  ///< LinkLimit: which act now
  bool is_engaged = false;
  bool is_on_hold = false;
  bool is_stopped = false;               ///< emergency stop
  std::uint32_t discarded_commands = 0;  ///< too old, too far ahead, or superseded
  std::uint32_t corrections = 0;         ///< number of the newest correction
  TipResponse tool_response = {};        ///< of the robot's arm
  Eigen::Vector3f p_base_tip = Eigen::Vector3f::Zero();
  Eigen::Quaternionf q_base_tool = Eigen::Quaternionf::Identity();
  Eigen::Vector3f force_base = Eigen::Vector3f::Zero();   ///< that the tool exerts [N]
  Eigen::Vector3f torque_base = Eigen::Vector3f::Zero();  ///< [N m]
  std::vector<LinkTrackedObject> objects = {};
};

struct LinkCorrection {
  std::uint32_t number = 0;              ///< counts up from 1 in a session; the same when resent
  double t = 0.0;                        ///< [s] shared clock: the time it corrects
  double due = 0.0;                      ///< [s] shared clock: commands for later times contain it
  std::vector<std::uint8_t> bytes = {};  ///< of a CorrectionMessage, with `t` as its epoch
};

/// Sent where nothing else was for a while.
struct LinkHeartbeat {};

enum class LinkStop : std::uint32_t {
  hold = 1,            ///< ramp to rest and stay there
  resume = 2,          ///< after a hold
  emergency_stop = 3,  ///< hold at once, until reset
  reset = 4,           ///< of the emergency stop; the site stays on hold
};

/// The camera of a picture, as CameraModel has it.
struct LinkPictureCamera {
  float fx = 0.0F;  ///< [px] of the picture, > 0
  float fy = 0.0F;
  float cx = 0.0F;
  float cy = 0.0F;
  LensModel lens = LensModel::plumb_bob;
  std::array<float, 8> coefficients = {};  ///< the model's first; the rest is 0

  friend bool operator==(const LinkPictureCamera&, const LinkPictureCamera&) = default;
};

/// A picture by the robot's camera. A lost one is not sent again: the next is newer.
struct LinkPicture {
  double t = 0.0;  ///< [s] shared clock
  std::uint16_t width = 0;
  std::uint16_t height = 0;
  std::vector<std::uint8_t> jpeg = {};
  std::optional<LinkPictureCamera> camera = {};  ///< nullopt: the robot's site does not know it
};

/// A picture has arrived.
struct LinkPictureReceipt {
  std::uint32_t sequence = 0;  ///< of the picture's header
  double received = 0.0;       ///< [s] shared clock
};

struct LinkMessage {
  LinkHeader header;
  std::variant<LinkHello, LinkWelcome, LinkReject, LinkPing, LinkPong, LinkCommand, LinkState,
               LinkCorrection, LinkAcknowledgement, LinkHeartbeat, LinkStop, LinkPicture,
               LinkPictureReceipt>
      content;
};

/// An Error with the reason if the bytes are not exactly one message of this version, or contain a
/// number that is not finite or out of range. Never throws, for bytes of any length.
[[nodiscard]] Expected<LinkMessage> decode_link_message(std::span<const std::uint8_t> bytes);
/// The version that a message states, if it begins as one: for the answer to another version.
[[nodiscard]] std::optional<int> link_version_of(std::span<const std::uint8_t> bytes);

/// Replaces `bytes`, whose memory is reused. Throws ContractError beyond the limits above.
void encode_link_message(const LinkMessage& message, std::vector<std::uint8_t>& bytes);
[[nodiscard]] std::vector<std::uint8_t> encode(const LinkMessage& message);

}  // namespace pcavr
