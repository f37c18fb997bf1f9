// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "connection_faults.hpp"

#include <fmt/core.h>

namespace pcavr {
namespace {

constexpr const char* kSameVersion = "install the same version of pcavr at both sites";

}  // namespace

Error other_link_version(int version) {
  return {.message = fmt::format("the robot's site uses pcavr-link {}, this one {}", version,
                                 kLinkVersion),
          .hint = kSameVersion};
}

Error rejected_by_robot(const LinkReject& rejected) {
  const bool is_version = rejected.reason == LinkRejection::other_version;
  return {.message = "the robot's site rejects this one: " + rejected.text,
          .hint = is_version ? kSameVersion : ""};
}

std::optional<Error> unusable_robot(const LinkWelcome& welcome, const std::string& scene,
                                    bool has_same_objects, bool needs_follower) {
  if (!has_same_objects) {
    return Error{.message = "the robot's site has another scene: " + welcome.scene +
                            ", with other objects than " + scene,
                 .hint = "give both sites the same scene"};
  }
  if (needs_follower && !welcome.follows_commands) {
    return Error{.message = "the robot's site plays a recording, which follows no commands",
                 .hint = "start it with --plant, or give this site --trace"};
  }
  return std::nullopt;
}

Error key_not_accepted() {
  return {.message = "the robot's site does not accept this key",
          .hint = "put its .pub file into the folder --authorized of the robot's site"};
}

Error not_connected(OperatorTransport::State state, const std::optional<std::string>& busy) {
  if (busy) return {.message = "the robot's site is busy: " + *busy};
  if (state == OperatorTransport::State::no_handshake) {
    return {.message =
                "the robot's site ended the handshake: its key is not --robot-key, or one of the "
                "two sites has no keys",
            .hint = "give the robot's .pub file with --robot-key, and --key"};
  }
  return {.message = "no answer from the robot's site",
          .hint = "check address and port, and whether it runs"};
}

}  // namespace pcavr
